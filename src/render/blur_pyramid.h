// Blurs of a picture by pyramids. Internal to the render layer.
//
// Levels halve the size, rounded up; reducing and enlarging are each other's transpose (the formulas
// stand in shaders/resize.glsl), so that blurs keep flat pictures flat and lose no energy. A level l
// enlarged again is the picture blurred by very nearly a Gaussian: the weights 1 3 3 1 / 8 have the
// variance 3/4, in pixels of the level they are taken from, both ways, so that its variance is
// 2 * 3/4 (1 + 4 + ... + 4^(l-1)) = (4^l - 1) / 2.
#pragma once

#include "render/frame_tiles.h"
#include "render/passes.h"

#include <optional>
#include <span>

namespace ibl {

/// The least l >= 1 (not a whole number) whose variance (4^l - 1) / 2 is that of `deviation`, in
/// pixels of the picture.
double levelOfDeviation(double deviation);

/// Level 1 of the picture times `exposure`: all of it, or its part above the threshold (see
/// shaders/exposure.glsl). A picture of more than twice the device's largest texture is reduced by
/// more than two.
Target reduceFrame(Passes& passes, FrameTiles& tiles, double exposure,
                   std::optional<double> threshold);

/// Adds sum over l of weights[l - 1] (level l enlarged to level 1) to `sum`, of the size of `base`,
/// which is level 1.
void addLevels(Passes& passes, const Target& base, std::span<const double> weights,
               const Target& sum);

/// `base` blurred by a Gaussian of that deviation, in its pixels, in some smaller size that holds it.
Target blurred(Passes& passes, const Target& base, double deviation);

} // namespace ibl
