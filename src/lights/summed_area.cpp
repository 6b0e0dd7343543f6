#include "lights/summed_area.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "panorama/conventions.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace ibl {
namespace {

/// The row's luminances, negative ones as 0. Returns their sum.
IBL_MULTIVERSION
double writeLuminances(const float* rgb, int width, double* to) {
    Lanes sum{};
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        fetchAhead(rgb + 3 * i);
        const Lanes luminance = litLuminance(pixelLanes(rgb + 3 * i));
        __builtin_memcpy(to + i, &luminance, sizeof luminance);
        sum += luminance;
    }
    if (i < width) {
        const Lanes luminance = litLuminance(lastPixelLanes(rgb + 3 * i, width - i));
        __builtin_memcpy(to + i, &luminance, static_cast<std::size_t>(width - i) * sizeof(double));
        sum += luminance;
    }
    return sumOf(sum);
}

/// Sums up to each of four values: shifted by one and added, then by two.
IBL_INLINE LongLanes runningSums(LongLanes v) {
    const LongLanes zero{};
    v += __builtin_shufflevector(zero, v, 0, 4, 5, 6);
    return v + __builtin_shufflevector(zero, v, 0, 0, 4, 5);
}

/// Makes the row's luminances, which stand where its sums will, those sums.
IBL_MULTIVERSION
void addEnergyRow(int width, double weight, const std::int64_t* above, std::int64_t* below) {
    LongLanes before{};
    below[0] = 0;
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        Lanes luminance;
        __builtin_memcpy(&luminance, below + i + 1, sizeof luminance);
        LongLanes sums = runningSums(rounded(weight * luminance));
        sums += before;
        before = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
        LongLanes up;
        __builtin_memcpy(&up, above + i + 1, sizeof up);
        up += sums;
        __builtin_memcpy(below + i + 1, &up, sizeof up);
    }
    if (i == width) return;
    Lanes luminance{};
    __builtin_memcpy(&luminance, below + i + 1,
                     static_cast<std::size_t>(width - i) * sizeof(double));
    const LongLanes last = before + runningSums(rounded(weight * luminance));
    for (int k = 0; i < width; ++i, ++k)
        below[i + 1] = above[i + 1] + last[k];
}

} // namespace

SummedAreaTable::SummedAreaTable(const Image& latlong, int threads)
    : table_(latlong.width, latlong.height) {
    static_assert(sizeof(double) == sizeof(std::int64_t));
    const auto solidAngle = [&](int j) {
        return latlongPixelSolidAngle(latlong.width, latlong.height, j);
    };
    std::vector<double> energies(static_cast<std::size_t>(latlong.height));
    parallelForRuns(energies.size(), 32, threads, [&](std::size_t begin, std::size_t end) {
        for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
            double* place = reinterpret_cast<double*>(table_.place(j));
            energies[static_cast<std::size_t>(j)] =
                solidAngle(j) * writeLuminances(latlong.row(j), latlong.width, place);
        }
    });
    const double energy = std::accumulate(energies.begin(), energies.end(), 0.0);
    scale_ = energy > 0 ? std::ldexp(1.0, 62) / energy : 0.0;
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(static_cast<int>(band),
                        [&](int j, const std::int64_t* above, std::int64_t* below) {
                            addEnergyRow(latlong.width, scale_ * solidAngle(j), above, below);
                        });
    });
    table_.addUpBands();
}

} // namespace ibl
