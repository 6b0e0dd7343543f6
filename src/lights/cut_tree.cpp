#include "lights/cut_tree.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

V3d middleOf(const AngularRegion& r) {
    const double phi = 0.5 * (r.longitude[0] + r.longitude[1]) * kPi / 180;
    const double lat = 0.5 * (r.latitude[0] + r.latitude[1]) * kPi / 180;
    return {std::cos(lat) * std::sin(phi), std::sin(lat), std::cos(lat) * std::cos(phi)};
}

} // namespace

std::vector<int> leavesOf(const CutTree& tree, std::size_t cuts) {
    std::vector<bool> is_cut(1 + 2 * cuts, false);
    for (std::size_t k = 0; k < cuts; ++k)
        is_cut[static_cast<std::size_t>(tree.cut[k])] = true;
    std::vector<int> leaves;
    for (std::size_t node = 0; node < is_cut.size(); ++node) {
        if (!is_cut[node]) leaves.push_back(static_cast<int>(node));
    }
    return leaves;
}

AngularRegion angularRegion(const PixelRegion& r, int width, int height) {
    AngularRegion region;
    // Columns run against longitude: the region's left edge is its greatest longitude.
    region.longitude[1] = 180 - 360.0 * r.x / width;
    region.longitude[0] = region.longitude[1] - 360.0 * r.width / width;
    if (region.longitude[0] < -180) {
        region.longitude[0] += 360;
        region.longitude[1] += 360;
    }
    region.latitude[0] = 90 - 180.0 * (r.y + r.height) / height;
    region.latitude[1] = 90 - 180.0 * r.y / height;
    return region;
}

PixelRegion pixelRegion(const AngularRegion& region, int width, int height) {
    // A pixel belongs to the rectangle that its centre lies in, so rectangles that tile the sphere
    // give pixels that do.
    const auto column = [&](double longitude) {
        return static_cast<int>(std::lround((180 - longitude) / 360 * width));
    };
    const auto row = [&](double latitude) {
        return static_cast<int>(std::lround((90 - latitude) / 180 * height));
    };
    PixelRegion r;
    const int left = column(region.longitude[1]), right = column(region.longitude[0]);
    r.x = ((left % width) + width) % width;
    r.width = std::clamp(right - left, 0, width);
    r.y = std::clamp(row(region.latitude[1]), 0, height);
    r.height = std::clamp(row(region.latitude[0]), r.y, height) - r.y;
    return r;
}

Light lightOf(const RegionSums& sums, const PixelRegion& region, int width, int height,
              LightPlacement placement) {
    Light light;
    light.irradiance = sums.irradiance;
    light.solid_angle = sums.solid_angle;
    light.region = angularRegion(region, width, height);
    const V3d centroid = sums.energy > 0 ? sums.moment / sums.energy : V3d(0);
    light.radius = std::sqrt(std::max(0.0, 1 - centroid.length2()));
    // A centroid near the sphere's centre points nowhere: take the middle of the region.
    const double length = centroid.length();
    light.direction = placement != LightPlacement::centre && length > 1e-9
                          ? centroid / length
                          : middleOf(*light.region);
    return light;
}

std::vector<Light> lightsOf(const std::vector<RegionSums>& sums,
                            const std::vector<PixelRegion>& regions,
                            const std::vector<bool>& is_lit, int width, int height,
                            LightPlacement placement) {
    std::vector<Light> lights;
    std::vector<Light> dark;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Light light = lightOf(sums[i], regions[i], width, height, placement);
        if (is_lit[i])
            lights.push_back(light);
        else if (light.irradiance != V3d(0))
            dark.push_back(light);
    }
    if (lights.empty()) return lights;
    for (const Light& lost : dark) {
        const auto nearest =
            std::max_element(lights.begin(), lights.end(), [&](const Light& a, const Light& b) {
                return a.direction.dot(lost.direction) < b.direction.dot(lost.direction);
            });
        nearest->irradiance += lost.irradiance;
    }
    std::stable_sort(lights.begin(), lights.end(), [](const Light& a, const Light& b) {
        return luminanceOf(a.irradiance) > luminanceOf(b.irradiance);
    });
    for (std::size_t i = 0; i < lights.size(); ++i)
        lights[i].id = static_cast<int>(i);
    return lights;
}

} // namespace ibl
