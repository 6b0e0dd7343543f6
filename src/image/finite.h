// Whether pixels are numbers.
#pragma once

#include <span>

namespace ibl {

/// Whether none of the values is NaN or infinite.
bool allFinite(std::span<const float> values);

} // namespace ibl
