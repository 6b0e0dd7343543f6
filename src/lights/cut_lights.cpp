#include "lights/cut_lights.h"

#include "lights/fewest_lights.h"
#include "lights/frame_identity.h"
#include "lights/importance.h"
#include "lights/irradiance_error.h"
#include "lights/lit_tree.h"
#include "lights/matched_places.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ibl {
namespace {

struct MethodRow {
    LightMethod method;
    std::string_view name;
};
constexpr std::array<MethodRow, 3> kMethods{{{LightMethod::median, "median"},
                                             {LightMethod::variance, "variance"},
                                             {LightMethod::importance, "importance"}}};

/// None for a probe without light.
std::vector<Light> lightsFor(const Image& latlong, const LightRequest& request, int threads) {
    if (request.method == LightMethod::importance) {
        const SummedAreaTable table(latlong, 0, threads);
        if (table.energy({0, 0, table.width(), table.height()}) <= 0) return {};
        return importanceLights(latlong, table, request.count, threads);
    }
    const LitTree cuts = cutProbe(latlong, request.method, request.count, threads);
    const std::vector<RegionSums> sums = allSums(latlong, cuts.tree, threads);
    if (sums[0].energy <= 0) return {};
    return lightsAfter(cuts, sums, cuts.tree.cut.size(), latlong, request.placement);
}

/// The lights that the regions of the frame before have now, or none when they leave a part of the
/// probe's light out.
std::optional<std::vector<Light>> inPreviousRegions(const Image& latlong,
                                                    const LightRequest& request, int threads) {
    std::vector<PixelRegion> regions;
    for (const Light& light : request.previous->lights) {
        if (!light.region) return std::nullopt;
        regions.push_back(pixelRegion(*light.region, latlong.width, latlong.height));
    }
    const std::vector<RegionSums> sums = regionSums(latlong, regions, threads);
    double solid_angle = 0;
    std::vector<bool> is_lit;
    for (const RegionSums& s : sums) {
        solid_angle += s.solid_angle;
        is_lit.push_back(s.energy > 0 || s.irradiance != V3d(0));
    }
    if (std::abs(solid_angle - 4 * kPi) > 1e-9) return std::nullopt;
    return lightsOf(sums, regions, is_lit, latlong.width, latlong.height, request.placement);
}

} // namespace

std::string_view methodName(LightMethod method) {
    return std::find_if(kMethods.begin(), kMethods.end(),
                        [&](const MethodRow& row) { return row.method == method; })
        ->name;
}

std::optional<LightMethod> methodFromName(std::string_view name) {
    const auto* row = std::find_if(kMethods.begin(), kMethods.end(),
                                   [&](const MethodRow& r) { return r.name == name; });
    return row == kMethods.end() ? std::nullopt : std::optional(row->method);
}

LightSet cutLights(const Image& latlong, const LightRequest& request, int threads) {
    LightSet set;
    if (request.max_error) {
        set = fewestLights(latlong, request, threads);
    } else {
        const LightHarmonics probe =
            probeHarmonics(latlong, harmonicDegree(request.count), threads);
        const bool matched = request.placement == LightPlacement::matched;
        set.lights = lightsFor(latlong, request, threads);
        if (matched) matchPlaces(set.lights, probe, threads);
        set.irradiance_error = errorOf(set.lights, probe, threads);
        const bool same_count =
            request.previous && request.previous->lights.size() == set.lights.size();
        auto kept = same_count ? inPreviousRegions(latlong, request, threads) : std::nullopt;
        if (kept) {
            if (matched) matchPlaces(*kept, probe, threads);
            const double error = errorOf(*kept, probe, threads);
            if (error <= 1.25 * set.irradiance_error) {
                set.lights = *kept;
                set.irradiance_error = error;
            }
        }
    }
    set.method = methodName(request.method);
    if (request.previous) set.change = keepIdentity(set.lights, request.previous->lights);
    return set;
}

double lampError(const Image& probe, const Image& residual, const Light& lamp, int threads) {
    const int degree = harmonicDegree(1);
    const LightHarmonics whole = probeHarmonics(probe, degree, threads);
    LightHarmonics difference = whole;
    difference -= probeHarmonics(residual, degree, threads);
    difference -= lightHarmonics({lamp}, degree, threads);
    return irradianceError(whole, difference, {&lamp, 1});
}

} // namespace ibl
