// Blurs of a picture by pyramids. Internal to the render layer.
//
// Levels halve the size, rounded up; the formulas stand in shaders/resize.glsl. Blurs keep flat
// pictures flat and lose no energy. Steps down and up weigh by 1 3 3 1 / 8, of variance 3/4 in
// pixels of the finer level, and a level is smoothed by 1 4 6 4 1 / 16, of variance 1 in its own,
// ahead of its way up: level l enlarged again is the picture blurred by very nearly a Gaussian, of
// the variance
//     2 * 3/4 (1 + 4 + ... + 4^(l-1)) + 4^l = 3/2 4^l - 1/2.
// The coarsest level is smoothed by a Gaussian of that variance in place of 1 4 6 4 1 / 16, which
// ends at the edges of a square: within a factor of 1e9, from a sun to what is black, they would be
// seen.
#pragma once

#include "render/frame_tiles.h"
#include "render/passes.h"

#include <optional>
#include <span>

namespace ibl {

/// The l (not a whole number) whose variance 3/2 4^l - 1/2 is that of `deviation`, in pixels of the
/// picture; 1 at least.
double levelOfDeviation(double deviation);

/// Level 1 of the picture times `exposure`: all of it, or its part above the threshold (see
/// shaders/exposure.glsl). A picture of more than twice the device's largest texture is reduced by
/// more than two.
Target reduceFrame(Passes& passes, FrameTiles& tiles, double exposure,
                   std::optional<double> threshold);

/// Adds sum over l of weights[l - 1] (level l smoothed and enlarged to level 1) to `sum`, of the
/// size of `base`, which is level 1; where there is no sum yet, it is that.
void addLevels(Passes& passes, Target base, std::span<const double> weights, Target& sum);

/// Level 1 blurred, in some smaller size that holds it, such that it is the picture, of `frame`
/// pixels, blurred by a Gaussian of that deviation once it is enlarged to level 1 and to the
/// picture.
Target blurred(Passes& passes, const Target& base, const V2i& frame, double deviation);

} // namespace ibl
