// Lights placed by importance sampling, to compare the cuts with.
#pragma once

#include "image/image.h"
#include "lights/light.h"
#include "lights/summed_area.h"

#include <vector>

namespace ibl {

/// `count` lights of equal luminance at the points of Hammersley's set, warped so that they are
/// distributed as luminance times solid angle (rows by their energy, then columns within the row).
/// A light has its pixel's colour; each channel is scaled so that the lights add up to the probe.
/// `solid_angle` is what the light stands for, its luminous irradiance over the pixel's luminance.
/// No randomness: the same probe and count give the same lights. None for a black probe.
std::vector<Light> importanceLights(const Image& latlong, const SummedAreaTable& table, int count,
                                    int threads);

} // namespace ibl
