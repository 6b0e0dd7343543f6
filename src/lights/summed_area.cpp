#include "lights/summed_area.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ibl {
namespace {

/// The row's luminances, negative ones as 0, times `weight`. Returns their sum.
IBL_MULTIVERSION
double writeEnergies(const float* rgb, int width, double weight, double* to) {
    Lanes sum{};
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        fetchAhead(rgb + 3 * i);
        const Lanes energy = weight * litLuminance(pixelLanes(rgb + 3 * i));
        __builtin_memcpy(to + i, &energy, sizeof energy);
        sum += energy;
    }
    if (i < width) {
        const Lanes energy = weight * litLuminance(lastPixelLanes(rgb + 3 * i, width - i));
        __builtin_memcpy(to + i, &energy, static_cast<std::size_t>(width - i) * sizeof(double));
        sum += energy;
    }
    return sumOf(sum);
}

/// Two rows of pixels with a weight each.
struct RowPair {
    const float* rows[2];
    double weights[2];

    IBL_INLINE Lanes energies(int i) const {
        return weights[0] * litLuminance(pixelLanes(rows[0] + 3 * i)) +
               weights[1] * litLuminance(pixelLanes(rows[1] + 3 * i));
    }
    IBL_INLINE Lanes lastEnergies(int i, int count) const {
        return weights[0] * litLuminance(lastPixelLanes(rows[0] + 3 * i, count)) +
               weights[1] * litLuminance(lastPixelLanes(rows[1] + 3 * i, count));
    }
};

/// The same of blocks of 2 x 2 pixels.
IBL_MULTIVERSION
double writePairs(const RowPair& pair, int width, double* to) {
    Lanes sum{};
    int i = 0;
    for (; i + 2 * kLanes <= width; i += 2 * kLanes) {
        fetchAhead(pair.rows[0] + 3 * i);
        fetchAhead(pair.rows[1] + 3 * i);
        const Lanes a = pair.energies(i), b = pair.energies(i + kLanes);
        const Lanes blocks =
            __builtin_shufflevector(a, b, 0, 2, 4, 6) + __builtin_shufflevector(a, b, 1, 3, 5, 7);
        __builtin_memcpy(to + i / 2, &blocks, sizeof blocks);
        sum += blocks;
    }
    double last = 0;
    for (; i < width; i += kLanes) {
        const Lanes a = pair.lastEnergies(i, std::min(kLanes, width - i));
        for (int k = 0; k < kLanes && i + k < width; k += 2) {
            to[(i + k) / 2] = a[k] + a[k + 1];
            last += a[k] + a[k + 1];
        }
    }
    return sumOf(sum) + last;
}

/// Sums up to each of four values: shifted by one and added, then by two.
IBL_INLINE LongLanes runningSums(LongLanes v) {
    const LongLanes zero{};
    v += __builtin_shufflevector(zero, v, 0, 4, 5, 6);
    return v + __builtin_shufflevector(zero, v, 0, 0, 4, 5);
}

/// Makes the row's energies, which stand where its sums will, those sums.
IBL_MULTIVERSION
void addEnergyRow(int width, double scale, const std::int64_t* above, std::int64_t* below) {
    LongLanes before{};
    below[0] = 0;
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        Lanes energy;
        __builtin_memcpy(&energy, below + i + 1, sizeof energy);
        LongLanes sums = runningSums(rounded(scale * energy));
        sums += before;
        before = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
        LongLanes up;
        __builtin_memcpy(&up, above + i + 1, sizeof up);
        up += sums;
        __builtin_memcpy(below + i + 1, &up, sizeof up);
    }
    if (i == width) return;
    Lanes energy{};
    __builtin_memcpy(&energy, below + i + 1, static_cast<std::size_t>(width - i) * sizeof(double));
    const LongLanes last = before + runningSums(rounded(scale * energy));
    for (int k = 0; i < width; ++i, ++k)
        below[i + 1] = above[i + 1] + last[k];
}

} // namespace

SummedAreaTable::SummedAreaTable(const Image& latlong, int shift, int threads)
    : blocks_{latlong.width, latlong.height, shift}, table_(blocks_.width(), blocks_.height()) {
    static_assert(sizeof(double) == sizeof(std::int64_t));
    const auto solidAngle = [&](int j) {
        return latlongPixelSolidAngle(latlong.width, latlong.height, j);
    };
    std::vector<double> energies(static_cast<std::size_t>(height()));
    parallelForRuns(energies.size(), 32, threads, [&](std::size_t begin, std::size_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            double* place = reinterpret_cast<double*>(table_.place(y));
            double& energy = energies[static_cast<std::size_t>(y)];
            if (shift == 0) {
                energy = writeEnergies(latlong.row(y), latlong.width, solidAngle(y), place);
                continue;
            }
            const bool alone = 2 * y + 1 == latlong.height;
            const int lower = alone ? 2 * y : 2 * y + 1;
            energy = writePairs({{latlong.row(2 * y), latlong.row(lower)},
                                 {solidAngle(2 * y), alone ? 0 : solidAngle(lower)}},
                                latlong.width, place);
        }
    });
    const double energy = std::accumulate(energies.begin(), energies.end(), 0.0);
    scale_ = energy > 0 ? std::ldexp(1.0, 62) / energy : 0.0;
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(static_cast<int>(band),
                        [&](int, const std::int64_t* above, std::int64_t* below) {
                            addEnergyRow(width(), scale_, above, below);
                        });
    });
    table_.addUpBands();
}

} // namespace ibl
