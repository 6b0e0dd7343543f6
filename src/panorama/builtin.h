// Procedural probes, so that everything runs with no file at hand.
#pragma once

#include "panorama/panorama.h"

#include <string_view>

namespace ibl {

/// Whether `name` names a built-in probe (begins with "builtin:"); it need not be one that exists.
bool isBuiltin(std::string_view name);

/// The built-in probe of that name, a lat-long of 2 height x height:
///   builtin:sky      a clear sky with a sun of about 1e5 times its radiance, over a dull ground
///   builtin:compass  a letter with its sign, a colour and a grid for each of the six directions
///   builtin:furnace  radiance 1 from everywhere
/// Throws Error (input) for another name.
Panorama builtinProbe(std::string_view name, int height = 512);

} // namespace ibl
