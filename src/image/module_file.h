// Parts of the program that are loaded when first needed, since the libraries behind them take
// long.
#pragma once

#include <string>

namespace ibl {

/// A module of the program, which lies beside it (in a build folder) or in the library folder of an
/// installation. Returns what dlopen() does; null with `problem` said when that fails. It is never
/// closed: the libraries behind it keep threads and caches of their own.
void* openModule(const std::string& file, std::string& problem);

} // namespace ibl
