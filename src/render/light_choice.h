// Which lights change the picture. Internal to the render layer.
#pragma once

#include "render/scene.h"

#include <vector>

namespace ibl {

/// The scene's lights in the world: directional ones turn with the probe.
std::vector<SceneLight> turnedLights(const std::vector<SceneLight>& lights, const Turn& turn);

/// Of `lights` those that may change a pixel seen from `eye`, in their order. Not drawn
/// are black ones and, of directional lights, those that neither shine on the ground (where there
/// is one) nor, where the material is lit, face a facet that faces the eye. `counts` says how many.
std::vector<SceneLight> lightsThatShow(const Scene& scene, const std::vector<SceneLight>& lights,
                                       const Similarity& similarity, const V3d& eye,
                                       LightCounts& counts);

} // namespace ibl
