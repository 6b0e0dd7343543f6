// The power of two that brings a probe's values into the range of the sums.
#pragma once

#include "core/error.h"
#include "image/image.h"

namespace ibl {

/// A power of two that brings the probe's largest value near 1, so that neither suns nor denormals
/// leave the range of the sums; 1 for a black probe. Throws Error (input) on values that are not
/// finite.
double probeScale(const Image& probe, int threads);

/// The same from the largest magnitude of the probe's values.
double scaleFor(float most);

/// The error for values that are not finite.
Error notFinite();

} // namespace ibl
