// Procedural probes, so that everything runs with no file at hand.
#pragma once

#include "panorama/panorama.h"

#include <string_view>

namespace ibl {

/// Whether `name` means a built-in probe (begins with "builtin:"); it need not be one that exists.
bool isBuiltin(std::string_view name);

/// The built-in probe of that name, a lat-long of 2 height x height, height >= 1:
///   builtin:sky      a clear sky with a sun of about 1e5 times its radiance, over dull ground
///   builtin:compass  each of the six directions with its name, a colour of its own and a grid
///   builtin:furnace  radiance 1 from everywhere
/// `threads` 0: as many as the machine has; the result does not depend on it.
/// Throws Error (input) for another name.
Panorama builtinProbe(std::string_view name, int height = 512, int threads = 0);

} // namespace ibl
