#include "lights/importance.h"

#include "lights/cut_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ibl {
namespace {

/// Van der Corput's sequence: the bits of i mirrored at the binary point.
double radicalInverse(std::uint32_t i) {
    double value = 0, digit = 0.5;
    for (; i > 0; i >>= 1, digit /= 2) {
        if (i & 1) value += digit;
    }
    return value;
}

struct Place {
    int index;
    double fraction; ///< within that index, [0, 1)
};

/// Where the running sum `before(k)` (energy of the indices below k) passes a share of its end.
template <class Sum>
Place inverse(int size, double share, Sum before) {
    const double target = share * static_cast<double>(before(size));
    int low = 0, high = size - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (static_cast<double>(before(middle + 1)) > target)
            high = middle;
        else
            low = middle + 1;
    }
    const double begin = static_cast<double>(before(low));
    const double width = static_cast<double>(before(low + 1)) - begin;
    return {low, width > 0 ? std::clamp((target - begin) / width, 0.0, 1.0) : 0.5};
}

/// Scales (or, where the lights have nothing of a channel, shifts) each channel to the total.
void matchTotal(std::vector<Light>& lights, const V3d& total) {
    const V3d sum = totalIrradiance(lights);
    for (int c = 0; c < 3; ++c) {
        const double factor = total[c] / sum[c];
        const bool scales = factor > 0 && std::isfinite(factor);
        const double shift = (total[c] - sum[c]) / static_cast<double>(lights.size());
        for (Light& light : lights)
            light.irradiance[c] =
                scales ? light.irradiance[c] * factor : light.irradiance[c] + shift;
    }
}

} // namespace

std::vector<Light> importanceLights(const Image& latlong, const SummedAreaTable& table, int count,
                                    int threads) {
    const int width = latlong.width, height = latlong.height;
    if (table.energy({0, 0, width, height}) <= 0) return {};
    std::vector<PixelRegion> rows;
    for (int j = 0; j < height; ++j)
        rows.push_back({0, j, width, 1});
    RegionSums whole;
    for (const RegionSums& row : regionSums(latlong, rows, threads))
        whole += row;

    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        const Place row = inverse(height, (i + 0.5) / count, [&](int k) {
            return table.energy({0, 0, width, k});
        });
        const Place column =
            inverse(width, radicalInverse(static_cast<std::uint32_t>(i)), [&](int k) {
                return table.energy({0, row.index, k, 1});
            });
        const float* rgb = latlong.at(column.index, row.index);
        const double luminance = litLuminance(rgb);
        // Within the pixel evenly in area: in cos theta.
        const double top = std::cos(kPi * row.index / height),
                     bottom = std::cos(kPi * (row.index + 1) / height);
        const double theta = std::acos(top + row.fraction * (bottom - top));
        Light light;
        light.direction =
            latlongDirection((column.index + column.fraction) / width, theta / kPi).normalized();
        light.solid_angle = whole.energy / (count * luminance);
        light.irradiance = V3d(rgb[0], rgb[1], rgb[2]) * light.solid_angle;
        light.id = i;
        lights.push_back(light);
    }
    matchTotal(lights, whole.irradiance);
    return lights;
}

} // namespace ibl
