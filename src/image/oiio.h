// Every format that has no reader of its own: by OpenImageIO, in a module of its own.
//
// A program that links OpenImageIO loads 260 shared libraries, a quarter of a second of CPU before
// main; so the module is loaded when the first file needs it.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/read.h"
#include "image/source.h"
#include "image/write.h"

#include <string>

namespace ibl {

/// Throws inputError, or Error(ExitCode::missing) if the module cannot be loaded.
ImageFile readOiio(const Source& source, const ReadOptions& options);

/// Throws Error (usage), of the file `path`, for a format that OpenImageIO cannot write, or
/// Error(ExitCode::missing).
void requireOiioWriter(const std::string& path, const std::string& format);

/// Writes in the format that OpenImageIO knows under the extension `format`, with linear floats or
/// halves where it takes them, otherwise 8 bits sRGB. Throws outputError, or as
/// requireOiioWriter().
WriteLosses writeOiio(OutputFile& file, const Image& image, const std::string& format,
                      const WriteOptions& options);

/// The module's boundary: C names, no exception across. Reading and writing return whether they
/// succeeded; if not, `error` says why.
struct OiioModule {
    using Read = bool (*)(const std::string& path, const ReadOptions& options, ImageFile& file,
                          std::string& error) noexcept;
    using Write = bool (*)(const std::string& path, const Image& image, const std::string& format,
                           const WriteOptions& options, WriteLosses& losses,
                           std::string& error) noexcept;
    using HasWriter = bool (*)(const std::string& format) noexcept;
    Read read = nullptr;
    Write write = nullptr;
    HasWriter hasWriter = nullptr;
};
constexpr const char* kOiioReadName = "ibltoolOiioRead";
constexpr const char* kOiioWriteName = "ibltoolOiioWrite";
constexpr const char* kOiioHasWriterName = "ibltoolOiioHasWriter";

} // namespace ibl
