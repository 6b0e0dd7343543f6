#include "lights/frame_identity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace ibl {
namespace {

constexpr int kNone = -1;

double angleBetween(const V3d& a, const V3d& b) {
    return 2 * std::asin(std::min(1.0, 0.5 * (a - b).length()));
}

std::array<double, 4> keyOf(const AngularRegion& r) {
    return {r.longitude[0], r.longitude[1], r.latitude[0], r.latitude[1]};
}

/// For each light the index of the same light before, or kNone.
std::vector<int> sameRegions(const std::vector<Light>& lights, const std::vector<Light>& previous) {
    std::map<std::array<double, 4>, int> regions;
    for (std::size_t i = 0; i < previous.size(); ++i) {
        if (previous[i].region) regions[keyOf(*previous[i].region)] = static_cast<int>(i);
    }
    std::vector<int> before(lights.size(), kNone);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!lights[i].region) continue;
        const auto found = regions.find(keyOf(*lights[i].region));
        if (found != regions.end()) before[i] = found->second;
    }
    return before;
}

/// Matches what is left by distance. Lights are looked for among those sorted by height, since two
/// directions differ by no less than their heights do.
void nearestLeft(const std::vector<Light>& lights, const std::vector<Light>& previous,
                 std::vector<int>& before) {
    std::vector<bool> taken(previous.size(), false);
    for (const int i : before) {
        if (i != kNone) taken[static_cast<std::size_t>(i)] = true;
    }
    std::vector<std::size_t> by_height(lights.size()), by_light(previous.size());
    std::iota(by_height.begin(), by_height.end(), 0);
    std::iota(by_light.begin(), by_light.end(), 0);
    std::stable_sort(by_height.begin(), by_height.end(), [&](std::size_t a, std::size_t b) {
        return lights[a].direction.y < lights[b].direction.y;
    });
    std::stable_sort(by_light.begin(), by_light.end(), [&](std::size_t a, std::size_t b) {
        return luminanceOf(previous[a].irradiance) > luminanceOf(previous[b].irradiance);
    });
    for (const std::size_t old : by_light) {
        if (taken[old]) continue;
        const V3d& from = previous[old].direction;
        double nearest = std::sqrt(std::max(0.0, previous[old].solid_angle) / kPi);
        std::size_t found = lights.size();
        const auto first = std::lower_bound(
            by_height.begin(), by_height.end(), from.y - nearest,
            [&](std::size_t i, double height) { return lights[i].direction.y < height; });
        for (auto it = first; it != by_height.end(); ++it) {
            if (lights[*it].direction.y > from.y + nearest) break;
            if (before[*it] != kNone) continue;
            const double angle = angleBetween(lights[*it].direction, from);
            if (angle <= nearest) {
                nearest = angle;
                found = *it;
            }
        }
        if (found < lights.size()) before[found] = static_cast<int>(old);
    }
}

FrameChange changeOf(const std::vector<Light>& lights, const std::vector<Light>& previous,
                     const std::vector<int>& before) {
    FrameChange change;
    double all = 0, differences = 0, moved = 0, weights = 0;
    for (const Light& light : previous)
        differences += std::abs(luminanceOf(light.irradiance));
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double luminance = std::abs(luminanceOf(lights[i].irradiance));
        all += luminance;
        if (before[i] == kNone) {
            differences += luminance;
            continue;
        }
        const Light& old = previous[static_cast<std::size_t>(before[i])];
        ++change.kept;
        differences += std::abs(luminanceOf(lights[i].irradiance) - luminanceOf(old.irradiance)) -
                       std::abs(luminanceOf(old.irradiance));
        moved += luminance * angleBetween(lights[i].direction, old.direction);
        weights += luminance;
    }
    if (all > 0) change.light_change = std::max(0.0, differences / all);
    if (weights > 0) change.movement = moved / weights;
    return change;
}

} // namespace

FrameChange keepIdentity(std::vector<Light>& lights, const std::vector<Light>& previous) {
    std::vector<int> before = sameRegions(lights, previous);
    const bool same = std::count(before.begin(), before.end(), kNone) == 0;
    if (!same) nearestLeft(lights, previous, before);
    FrameChange change = changeOf(lights, previous, before);
    change.same_regions = same;
    int next = 0;
    for (const Light& light : previous)
        next = std::max(next, light.id + 1);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].id =
            before[i] == kNone ? next++ : previous[static_cast<std::size_t>(before[i])].id;
    }
    std::stable_sort(lights.begin(), lights.end(),
                     [](const Light& a, const Light& b) { return a.id < b.id; });
    return change;
}

} // namespace ibl
