#include "image/write.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/cube_container.h"
#include "image/exr.h"
#include "image/oiio.h"
#include "image/png.h"
#include "image/radiance.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

namespace ibl {
namespace {

/// The format asked for, in lower case without a dot.
std::string formatOf(const std::string& path, const WriteOptions& options) {
    std::string format = options.format;
    if (format.empty() && path != "-") format = std::filesystem::path(path).extension().string();
    if (format.starts_with('.')) format.erase(0, 1);
    std::transform(format.begin(), format.end(), format.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::error_code ignored;
    if (format.empty() && std::filesystem::is_directory(path, ignored)) {
        throw Error(ExitCode::usage, path + ": is a folder; name a file in it");
    }
    if (path.empty()) throw Error(ExitCode::usage, "-o: the name is empty; name a file");
    if (format.empty()) {
        throw Error(ExitCode::usage,
                    (path == "-" ? "standard output" : path) +
                        ": its name does not say its format; say which, or use a name that ends in "
                        ".exr, .hdr or .png");
    }
    return format;
}

bool isRadiance(const std::string& format) {
    return format == "hdr" || format == "pic" || format == "rgbe";
}

bool isTiff(const std::string& format) {
    return format == "tif" || format == "tiff";
}

void requireNoCompression(const std::string& path, const WriteOptions& options) {
    if (options.compression.empty()) return;
    throw Error(ExitCode::usage, path + ": only OpenEXR files have a compression to choose; leave "
                                        "out --compression, or write .exr");
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
    return std::to_string(count) + (count == 1 ? one : many);
}

} // namespace

void requireFormat(const std::string& path, const WriteOptions& options) {
    const std::string format = formatOf(path, options);
    const bool own = format == "exr" || format == "png" || format == "ktx2" || format == "dds" ||
                     isRadiance(format);
    if (!own) requireOiioWriter(path, format);
    if (format != "exr") requireNoCompression(path, options);
}

WriteLosses& WriteLosses::operator+=(const WriteLosses& other) {
    above += other.above;
    below += other.below;
    not_number += other.not_number;
    bright_pixels += other.bright_pixels;
    return *this;
}

bool isCubeContainer(const std::string& path, const WriteOptions& options) {
    if (path == "-" && options.format.empty()) return false;
    if (options.format.empty() && !std::filesystem::path(path).has_extension()) return false;
    const std::string format = formatOf(path, options);
    return format == "ktx2" || format == "dds";
}

WriteLosses writeCubeMap(OutputSet& outputs, const std::string& path,
                         std::span<const Image* const> levels, const WriteOptions& options) {
    requireNoCompression(path, options);
    OutputFile& file = outputs.add(path);
    return formatOf(path, options) == "dds" ? writeDds(file, levels, options.type)
                                            : writeKtx2(file, levels, options.type);
}

namespace {

/// Throws where the file's format cannot take the options.
void requireFittingOptions(const std::string& path, const std::string& format,
                           const WriteOptions& options) {
    if (isCubeContainer(path, options)) {
        throw Error(ExitCode::usage, path + ": " + format +
                                         " files hold cube maps, not this image; write another "
                                         "format");
    }
    if (format != "exr") requireNoCompression(path, options);
    if (format != "exr" && !options.envmap.empty()) {
        throw Error(ExitCode::usage, path +
                                         ": only OpenEXR files have an envmap to choose (as the "
                                         "layouts exr-latlong and exr-cube do); leave it out, or "
                                         "write .exr");
    }
    if (format != "exr" && !options.extra.empty()) {
        throw Error(ExitCode::usage, path + ": only OpenEXR files have further channels; write "
                                            ".exr");
    }
}

WriteLosses writeTo(OutputFile& file, const std::string& format, const Image& image,
                    const WriteOptions& options) {
    if (image.width < 1 || image.height < 1 || (image.channels != 3 && image.channels != 4)) {
        throw std::logic_error("writeImage takes RGB or RGBA pixels");
    }
    if (format == "exr") return writeExr(file, image, options);
    if (isRadiance(format)) return writeRadiance(file, image, options.threads);
    if (format == "png") return writePng(file, image, {}, options.threads);
    return writeOiio(file, image, format, options);
}

} // namespace

WriteLosses writeImage(OutputSet& outputs, const std::string& path, const Image& image,
                       const WriteOptions& options) {
    const std::string format = formatOf(path, options);
    requireFittingOptions(path, format, options);
    return writeTo(outputs.add(path), format, image, options);
}

WriteLosses writeImages(OutputSet& outputs, std::span<const std::string> paths,
                        const std::function<Image(std::size_t)>& imageOf,
                        const WriteOptions& options) {
    std::vector<OutputFile*> files;
    for (const std::string& path : paths) {
        requireFittingOptions(path, formatOf(path, options), options);
        files.push_back(&outputs.add(path));
    }
    std::vector<WriteLosses> losses(paths.size());
    const auto write = [&](std::size_t k) {
        losses[k] = writeTo(*files[k], formatOf(paths[k], options), imageOf(k), options);
    };
    // The first one alone: libraries are loaded and set up with it.
    if (!files.empty()) write(0);
    if (files.size() > 1)
        parallelFor(files.size() - 1, options.threads, [&](std::size_t k) { write(k + 1); });
    WriteLosses total;
    for (const WriteLosses& l : losses)
        total += l;
    return total;
}

std::vector<std::string> describeLosses(const WriteLosses& losses, const std::string& path,
                                        const WriteOptions& options) {
    const std::string format = formatOf(path, options);
    const bool wide = format == "exr" || format == "ktx2" || format == "dds" ||
                      isTiff(format); // half, or nothing is lost
    const std::string largest = wide ? "65504" : isRadiance(format) ? "1.7e38" : "1";
    std::vector<std::string> lines;
    const auto add = [&](std::size_t count, const std::string& what, const std::string& as) {
        if (count == 0) return;
        lines.push_back(counted(count, " value " + what + " was written as " + as,
                                " values " + what + " were written as " + as));
    };
    add(losses.above, "above " + largest, largest);
    add(losses.below, wide ? "below -65504" : "below 0", wide ? "-65504" : "0");
    add(losses.not_number, "that is no number", "0");
    return lines;
}

} // namespace ibl
