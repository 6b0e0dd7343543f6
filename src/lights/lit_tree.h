// A probe's cuts together with what their regions hold.
#pragma once

#include "lights/cut_lights.h"
#include "lights/cut_tree.h"
#include "lights/light_harmonics.h"

#include <cstddef>
#include <vector>

namespace ibl {

/// The cuts, and which of their nodes have energy.
struct LitTree {
    CutTree tree;
    std::vector<bool> is_lit;
};

/// The regions with energy after all cuts.
int litCount(const LitTree& cuts);

/// Cuts until `count` regions have energy, or pixels give no more. Not with
/// LightMethod::importance.
LitTree cutProbe(const Image& latlong, LightMethod method, int count, int threads);

/// Sums of every node: the leaves' from the pixels, the others' from their parts'.
std::vector<RegionSums> allSums(const Image& latlong, const CutTree& tree, int threads);

/// The lights after the first `count` cuts, `sums` being allSums().
std::vector<Light> lightsAfter(const LitTree& cuts, const std::vector<RegionSums>& sums,
                               std::size_t count, const Image& latlong, LightPlacement placement);

/// The irradiance error of lights against a probe's harmonics.
double errorOf(const std::vector<Light>& lights, const LightHarmonics& probe, int threads);

} // namespace ibl
