// Spherical-harmonic coefficients as JSON, for diffuse and bake.
#pragma once

#include "convolve/sh_coefficients.h"

#include <string>

namespace ibl {

/// One JSON object, indented, ending in a newline: `axes`, `units`, `basis`, `source`,
/// `convention`, `order`, `window` (`none`, or `lambda` of convolve/sh_window.h) and
/// `coefficients`, an array of [r, g, b]. Numbers are the shortest that read back as the same
/// double.
std::string shJson(const ShCoefficients& coefficients, const std::string& source, bool windowed,
                   double lambda);

} // namespace ibl
