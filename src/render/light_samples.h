// Which lights are looked at in which of a pixel's samples. Internal to the render layer.
#pragma once

#include "lights/scene_light.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ibl {

/// A light in a sample, and by what its strength is multiplied there.
struct SampledLight {
    std::size_t light = 0;
    double weight = 1;
};

/// Spreads directional lights over `samples` samples a pixel: each light is in as many, evenly
/// spaced, as it takes for none of these to make more than `step` of all lights' strength in any
/// channel of the pixel, and in all of them at the most. The mean over the samples of what the
/// lights of a sample, weighted, give is what all lights give, but that a weak light's shadow edges
/// have fewer steps within a pixel, each no larger than `step` or, if that is less, the light's
/// own share. Point and spot lights, whose irradiance depends on the place, are in every sample.
/// One list a sample, lights in ascending order.
std::vector<std::vector<SampledLight>> spreadLights(std::span<const SceneLight> lights, int samples,
                                                    double step);

} // namespace ibl
