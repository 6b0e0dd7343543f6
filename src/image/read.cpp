#include "image/read.h"

#include "core/error.h"
#include "image/exr.h"
#include "image/oiio.h"
#include "image/png.h"
#include "image/radiance.h"
#include "image/source.h"

#include <algorithm>
#include <new>
#include <string_view>
#include <utility>

namespace ibl {
namespace {

bool startsWith(const Source& source, std::string_view magic) {
    return source.bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), source.bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// Cube maps as this program writes them: KTX, and DDS with the header of Direct3D 10.
void refuseCubeContainer(const Source& source) {
    constexpr std::size_t kFourCc = 84;
    const bool dds = startsWith(source, "DDS ") && source.bytes.size() >= kFourCc + 4 &&
                     std::equal(&source.bytes[kFourCc], &source.bytes[kFourCc + 4], "DX10");
    if (!dds && !startsWith(source, "\xABKTX ")) return;
    throw inputError(source.name, std::string("is a ") + (dds ? "DDS" : "KTX") +
                                      " container, which is written but not read; give the "
                                      "probe that it was made from, or faces as EXR files");
}

/// A format can only have the layer that it is.
void refuseLayer(const Source& source, const ReadOptions& options) {
    if (!options.layer.empty()) {
        throw inputError(source.name,
                         "has no layer '" + options.layer + "'; only OpenEXR files have layers");
    }
}

ImageFile readSource(Source& source, const ReadOptions& options) {
    if (startsWith(source, "\x76\x2f\x31\x01")) return readExr(source, options);
    refuseLayer(source, options);
    if (startsWith(source, "#?")) {
        readWhole(source);
        return readRadiance(source.bytes, source.name, options.threads);
    }
    if (startsWith(source, "\x89PNG\r\n\x1a\n")) {
        readWhole(source);
        return readPng(source.bytes, source.name, options);
    }
    refuseCubeContainer(source);
    return readOiio(source, options);
}

void requireFinite(const std::string& name, const Image& image) {
    const auto bad = std::ranges::find_if(image.pixels, [](float v) { return !std::isfinite(v); });
    if (bad == image.pixels.end()) return;
    const auto pixel = (bad - image.pixels.begin()) / image.channels;
    throw inputError(name, "holds NaN or infinite values, the first at (" +
                               std::to_string(pixel % image.width) + ", " +
                               std::to_string(pixel / image.width) + "); mend it first");
}

ImageFile readOpened(Source source, const ReadOptions& options) {
    try {
        ImageFile file = readSource(source, options);
        if (options.finite) requireFinite(source.name, file.image);
        return file;
    } catch (const std::bad_alloc&) {
        throw inputError(source.name, "does not fit into memory; shrink it first");
    }
}

} // namespace

ImageFile readImage(const std::string& path, const ReadOptions& options) {
    return readOpened(openSource(path), options);
}

ImageFile readImage(std::vector<std::uint8_t> bytes, const std::string& name,
                    const ReadOptions& options) {
    if (bytes.empty()) throw inputError(name, "is empty; export it again");
    return readOpened({name, "", std::move(bytes), true}, options);
}

} // namespace ibl
