#include "lights/summed_area.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "panorama/conventions.h"

#include <cmath>
#include <vector>

namespace ibl {
namespace {

IBL_MULTIVERSION
double litRow(const float* rgb, int width) {
    Lanes sum{};
    int i = 0;
    for (; i + kLanes <= width; i += kLanes)
        sum += litLuminance(pixelLanes(rgb + 3 * i));
    if (i < width) sum += litLuminance(lastPixelLanes(rgb + 3 * i, width - i));
    return sumOf(sum);
}

/// Sums up to each of four values: shifted by one and added, then by two.
IBL_INLINE LongLanes runningSums(LongLanes v) {
    const LongLanes zero{};
    v += __builtin_shufflevector(zero, v, 0, 4, 5, 6);
    return v + __builtin_shufflevector(zero, v, 0, 0, 4, 5);
}

IBL_MULTIVERSION
void addEnergyRow(const float* rgb, int width, double weight, const std::int64_t* above,
                  std::int64_t* below) {
    LongLanes before{};
    below[0] = 0;
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        LongLanes sums = runningSums(rounded(weight * litLuminance(pixelLanes(rgb + 3 * i))));
        sums += before;
        before = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
        LongLanes up;
        __builtin_memcpy(&up, above + i + 1, sizeof up);
        up += sums;
        __builtin_memcpy(below + i + 1, &up, sizeof up);
    }
    if (i == width) return;
    const LongLanes last =
        before +
        runningSums(rounded(weight * litLuminance(lastPixelLanes(rgb + 3 * i, width - i))));
    for (int k = 0; i < width; ++i, ++k)
        below[i + 1] = above[i + 1] + last[k];
}

} // namespace

double litEnergy(const Image& latlong, int threads) {
    std::vector<double> rows(static_cast<std::size_t>(latlong.height));
    parallelForRuns(rows.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) {
            const int row = static_cast<int>(j);
            rows[j] = litRow(latlong.row(row), latlong.width) *
                      latlongPixelSolidAngle(latlong.width, latlong.height, row);
        }
    });
    double total = 0;
    for (const double row : rows)
        total += row;
    return total;
}

SummedAreaTable::SummedAreaTable(const Image& latlong, int threads)
    : table_(latlong.width, latlong.height) {
    const double total = litEnergy(latlong, threads);
    if (total > 0) scale_ = std::ldexp(1.0, 62) / total;
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(static_cast<int>(band), [&](int j, const std::int64_t* above,
                                                    std::int64_t* below) {
            addEnergyRow(latlong.row(j), latlong.width,
                         scale_ * latlongPixelSolidAngle(latlong.width, latlong.height, j), above,
                         below);
        });
    });
    table_.addUpBands();
}

} // namespace ibl
