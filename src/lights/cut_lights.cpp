#include "lights/cut_lights.h"

#include "core/error.h"
#include "lights/frame_identity.h"
#include "lights/importance.h"
#include "lights/irradiance_error.h"
#include "lights/matched_places.h"

#include <algorithm>
#include <array>
#include <cstdio>
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

/// The cuts, and which of their nodes have energy.
struct LitTree {
    CutTree tree;
    std::vector<bool> is_lit;
};

template <class Table>
LitTree withLit(CutTree&& tree, const Table& table) {
    LitTree result{std::move(tree), {}};
    for (const PixelRegion& r : result.tree.nodes)
        result.is_lit.push_back(table.energy(r) > 0);
    return result;
}

int litCount(const LitTree& cuts) {
    const std::vector<int> leaves = leavesOf(cuts.tree, cuts.tree.cut.size());
    return static_cast<int>(std::count_if(leaves.begin(), leaves.end(), [&](int node) {
        return cuts.is_lit[static_cast<std::size_t>(node)];
    }));
}

/// Blocks of pixels for the variance cut, as a shift: no more of them than half a million or 32 a
/// light, so that the table does not take longer to fill than a large probe to read.
int blockShift(const Image& latlong, int count) {
    const long most = std::max(1L << 19, 32L * count);
    int shift = 0;
    while ((long{latlong.width} >> shift) * (latlong.height >> shift) > most)
        ++shift;
    return shift;
}

LitTree varianceCuts(const Image& latlong, int count, int threads) {
    for (int shift = blockShift(latlong, count);; shift = 0) {
        const MomentTable table(latlong, shift, threads);
        LitTree cuts = withLit(varianceCut(table, count), table);
        // Few lit blocks may be many lit pixels.
        if (shift > 0 && litCount(cuts) < count) continue;
        for (PixelRegion& node : cuts.tree.nodes)
            node = table.pixels(node);
        return cuts;
    }
}

LitTree cutProbe(const Image& latlong, LightMethod method, int count, int threads) {
    if (method == LightMethod::variance) return varianceCuts(latlong, count, threads);
    const SummedAreaTable table(latlong, threads);
    return withLit(medianCut(table, count, threads), table);
}

std::vector<Light> lightsAfter(const LitTree& cuts, const std::vector<RegionSums>& sums,
                               std::size_t count, const Image& latlong, LightPlacement placement) {
    std::vector<RegionSums> leaf_sums;
    std::vector<PixelRegion> regions;
    std::vector<bool> is_lit;
    for (const int node : leavesOf(cuts.tree, count)) {
        const auto n = static_cast<std::size_t>(node);
        leaf_sums.push_back(sums[n]);
        regions.push_back(cuts.tree.nodes[n]);
        is_lit.push_back(cuts.is_lit[n]);
    }
    return lightsOf(leaf_sums, regions, is_lit, latlong.width, latlong.height, placement);
}

/// Sums of every node: the leaves' from the pixels, the others' from their parts'.
std::vector<RegionSums> allSums(const Image& latlong, const CutTree& tree, int threads) {
    const std::vector<int> leaves = leavesOf(tree, tree.cut.size());
    std::vector<PixelRegion> regions;
    for (const int node : leaves)
        regions.push_back(tree.nodes[static_cast<std::size_t>(node)]);
    const std::vector<RegionSums> found = regionSums(latlong, regions, threads);
    std::vector<RegionSums> sums(tree.nodes.size());
    for (std::size_t i = 0; i < leaves.size(); ++i)
        sums[static_cast<std::size_t>(leaves[i])] = found[i];
    for (std::size_t k = tree.cut.size(); k-- > 0;) {
        RegionSums& whole = sums[static_cast<std::size_t>(tree.cut[k])];
        whole += sums[2 * k + 1];
        whole += sums[2 * k + 2];
    }
    return sums;
}

double errorOf(const std::vector<Light>& lights, const LightHarmonics& probe, int threads) {
    LightHarmonics difference = probe;
    difference -= lightHarmonics(lights, probe.degree, threads);
    return irradianceError(probe, difference);
}

/// The first number of cuts whose lights keep the error: a cut changes three lights, so the
/// difference's harmonics follow from those before it at the same cost for every number.
struct Search {
    const Image& latlong;
    const LightRequest& request;
    const LitTree& cuts;
    const std::vector<RegionSums>& sums;
    const LightHarmonics& probe;
    int threads;
};

std::optional<LightSet> firstWithin(const Search& s) {
    LightHarmonics difference = s.probe;
    const auto add = [&](std::size_t node, double sign, std::vector<Light>& changed) {
        if (!s.cuts.is_lit[node]) return;
        changed.push_back(lightOf(s.sums[node], s.cuts.tree.nodes[node], s.latlong.width,
                                  s.latlong.height, s.request.placement));
        changed.back().irradiance *= sign;
    };
    std::vector<Light> changed;
    add(0, 1, changed);
    for (std::size_t cuts = 0;; ++cuts) {
        difference -= lightHarmonics(changed, s.probe.degree, 1);
        if (irradianceError(s.probe, difference) <= *s.request.max_error) {
            // What dark regions hold goes to lights as well; that is in the error that counts.
            LightSet set;
            set.lights = lightsAfter(s.cuts, s.sums, cuts, s.latlong, s.request.placement);
            set.irradiance_error = errorOf(set.lights, s.probe, s.threads);
            if (set.irradiance_error <= *s.request.max_error) return set;
        }
        if (cuts == s.cuts.tree.cut.size()) return std::nullopt;
        changed.clear();
        add(static_cast<std::size_t>(s.cuts.tree.cut[cuts]), -1, changed);
        add(2 * cuts + 1, 1, changed);
        add(2 * cuts + 2, 1, changed);
    }
}

LightSet fewestLights(const Image& latlong, const LightRequest& request, int threads) {
    for (int most = 64;; most = std::min(kMostLights, 8 * most)) {
        const LightHarmonics probe = probeHarmonics(latlong, harmonicDegree(most), threads);
        const LitTree cuts = cutProbe(latlong, request.method, most, threads);
        const std::vector<RegionSums> sums = allSums(latlong, cuts.tree, threads);
        if (sums[0].energy <= 0) return {};
        if (auto set = firstWithin({latlong, request, cuts, sums, probe, threads})) return *set;
        if (most == kMostLights || litCount(cuts) < most) {
            const double best =
                errorOf(lightsAfter(cuts, sums, cuts.tree.cut.size(), latlong, request.placement),
                        probe, threads);
            char text[160];
            std::snprintf(text, sizeof text,
                          "--max-error %g cannot be met: %d lights have %.2g; allow a larger error",
                          *request.max_error, litCount(cuts), best);
            throw Error(ExitCode::accuracy, text);
        }
    }
}

/// None for a probe without light.
std::vector<Light> lightsFor(const Image& latlong, const LightRequest& request, int threads) {
    if (request.method == LightMethod::importance) {
        const SummedAreaTable table(latlong, threads);
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
    return irradianceError(whole, difference);
}

} // namespace ibl
