#include "lights/summed_area.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "panorama/conventions.h"

#include <cmath>

namespace ibl {
namespace {

IBL_MULTIVERSION
LuminousEnergy luminanceOfRow(const float* rgb, int width) {
    Lanes lit{}, absolute{};
    const auto add = [&](const PixelLanes& p) __attribute__((always_inline)) {
        lit += litLuminance(p);
        absolute += absoluteLuminance(p);
    };
    int i = 0;
    for (; i + kLanes <= width; i += kLanes)
        add(pixelLanes(rgb + 3 * i));
    if (i < width) add(lastPixelLanes(rgb + 3 * i, width - i));
    return {sumOf(lit), sumOf(absolute)};
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
        fetchAhead(rgb + 3 * i);
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

LuminousEnergy luminousEnergyOfRow(const Image& latlong, int row) {
    const LuminousEnergy sums = luminanceOfRow(latlong.row(row), latlong.width);
    const double solid_angle = latlongPixelSolidAngle(latlong.width, latlong.height, row);
    return {sums.lit * solid_angle, sums.absolute * solid_angle};
}

LuminousEnergy luminousEnergy(const std::vector<LuminousEnergy>& rows) {
    LuminousEnergy total;
    for (const LuminousEnergy& row : rows) {
        total.lit += row.lit;
        total.absolute += row.absolute;
    }
    return total;
}

LuminousEnergy luminousEnergy(const Image& latlong, int threads) {
    std::vector<LuminousEnergy> rows(static_cast<std::size_t>(latlong.height));
    parallelFor(rows.size(), threads, [&](std::size_t j) {
        rows[j] = luminousEnergyOfRow(latlong, static_cast<int>(j));
    });
    return luminousEnergy(rows);
}

SummedAreaTable::SummedAreaTable(const Image& latlong, double lit_energy, int threads)
    : table_(latlong.width, latlong.height),
      scale_(lit_energy > 0 ? std::ldexp(1.0, 62) / lit_energy : 0.0) {
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(
            static_cast<int>(band), [&](int j, const std::int64_t* above, std::int64_t* below) {
                addEnergyRow(latlong.row(j), latlong.width,
                             scale_ * latlongPixelSolidAngle(latlong.width, latlong.height, j),
                             above, below);
            });
    });
    table_.addUpBands();
}

} // namespace ibl
