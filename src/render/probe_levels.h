// A probe at every resolution, for samples that each stand for a solid angle.
#pragma once

#include "panorama/panorama.h"

#include <vector>

namespace ibl {

/// The power of two that is at least the number of a probe's pixels along a quarter of the horizon,
/// twice over.
int cubeEdge(const Panorama& probe);

/// The probe as cube faces of twice cubeEdge(), at most 1024 texels, and down to a single one, each
/// level half of the one before. Texels of a level are the mean over a tent of two texels, so that
/// a point of light keeps its place as well as its energy when it is interpolated again. (Boxes
/// would move it to the middle of its texel.) `threads` as everywhere.
std::vector<Panorama> probeLevels(const Panorama& probe, int threads);

} // namespace ibl
