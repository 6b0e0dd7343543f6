#include "image/exr.h"

#include "core/error.h"
#include "core/parallel.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <array>
#include <utility>

namespace ibl {
namespace {

/// Measured on a 1024x512 probe of floats (6.2 MB raw), milliseconds of CPU and MB: zip at level 1
/// 84, 2.47; 2 (same cost on smaller ones) 104, 2.40; 4, OpenEXR's default, 116, 2.25; 6 365, 2.17;
/// zips at 1 122, 3.06; piz 44, 2.27; none 8, 6.15. On faces of 256 texels zip at 2 and piz take 9
/// and 9 ms for 268 and 300 KB, on flat studio light zip is half as large as piz: hence zip.
constexpr int kZipLevel = 2;
constexpr float kLargestHalf = 65504;
constexpr std::array<const char*, 4> kChannels = {"R", "G", "B", "A"};

class OutputStream : public Imf::OStream {
public:
    explicit OutputStream(OutputFile& file) : OStream(file.path().c_str()), file_(file) {}
    void write(const char bytes[], int count) override {
        file_.write(bytes, static_cast<std::size_t>(count));
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { file_.seek(position); }

private:
    OutputFile& file_;
};

Imf::Compression compressionNamed(const std::string& name, const std::string& path) {
    constexpr std::pair<const char*, Imf::Compression> kNames[] = {
        {"", Imf::ZIP_COMPRESSION},        {"none", Imf::NO_COMPRESSION},
        {"rle", Imf::RLE_COMPRESSION},     {"zips", Imf::ZIPS_COMPRESSION},
        {"zip", Imf::ZIP_COMPRESSION},     {"piz", Imf::PIZ_COMPRESSION},
        {"pxr24", Imf::PXR24_COMPRESSION}, {"b44", Imf::B44_COMPRESSION},
        {"b44a", Imf::B44A_COMPRESSION},   {"dwaa", Imf::DWAA_COMPRESSION},
        {"dwab", Imf::DWAB_COMPRESSION},
    };
    for (const auto& [known, compression] : kNames) {
        if (name == known) return compression;
    }
    throw outputError(path, "OpenEXR has no compression '" + name +
                                "'; there are none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, "
                                "dwab");
}

void addLabel(Imf::Header& header, const MapLabel& label) {
    if (!label.kernel.empty()) header.insert("ibl.kernel", Imf::StringAttribute(label.kernel));
    if (label.roughness) header.insert("ibl.roughness", Imf::FloatAttribute(*label.roughness));
    if (label.exponent) header.insert("ibl.exponent", Imf::FloatAttribute(*label.exponent));
    if (label.levels > 0) {
        header.insert("ibl.level", Imf::IntAttribute(label.level));
        header.insert("ibl.levels", Imf::IntAttribute(label.levels));
    }
}

Imf::Header makeHeader(const Image& image, const WriteOptions& options, const std::string& path) {
    Imf::Header header(image.width, image.height);
    const bool plain = options.smooth && options.type == PixelType::float32;
    header.compression() = options.compression.empty() && plain
                               ? Imf::NO_COMPRESSION
                               : compressionNamed(options.compression, path);
    header.zipCompressionLevel() = kZipLevel;
    const Imf::PixelType type = options.type == PixelType::half ? Imf::HALF : Imf::FLOAT;
    for (int c = 0; c < image.channels; ++c)
        header.channels().insert(kChannels[c], Imf::Channel(type));
    for (const ExtraChannel& extra : options.extra)
        header.channels().insert(extra.name, Imf::Channel(Imf::FLOAT));
    if (!options.layout.empty()) header.insert("ibl.layout", Imf::StringAttribute(options.layout));
    addLabel(header, options.label);
    if (options.envmap == "latlong") {
        Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
    } else if (options.envmap == "cube") {
        Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
    } else if (!options.envmap.empty()) {
        throw outputError(path, "OpenEXR has no envmap '" + options.envmap +
                                    "'; there are latlong and cube");
    }
    return header;
}

/// Hands `rows` rows that begin at `first_pixel` to the file as its rows from `y` on.
template <class T>
void writeRows(Imf::OutputFile& file, Imf::PixelType type, const T* first_pixel, int y, int rows,
               const Image& image, const WriteOptions& options) {
    const std::size_t x_stride = static_cast<std::size_t>(image.channels) * sizeof(T);
    const std::size_t y_stride = static_cast<std::size_t>(image.width) * x_stride;
    const auto base =
        reinterpret_cast<std::uintptr_t>(first_pixel) - static_cast<std::uintptr_t>(y) * y_stride;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < static_cast<std::size_t>(image.channels); ++c) {
        buffer.insert(kChannels[c], Imf::Slice(type, reinterpret_cast<char*>(base + c * sizeof(T)),
                                               x_stride, y_stride));
    }
    for (const ExtraChannel& extra : options.extra) {
        auto* values = const_cast<float*>(extra.values.data()); // Imf reads through char*
        buffer.insert(extra.name,
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values), sizeof(float),
                                 static_cast<std::size_t>(image.width) * sizeof(float)));
    }
    file.setFrameBuffer(buffer);
    file.writePixels(rows);
}

/// Rows to half, clamped. Inf is clamped like any value too large; NaN stays NaN.
WriteLosses toHalf(const float* from, std::size_t count, half* to) {
    WriteLosses losses;
    for (std::size_t i = 0; i < count; ++i) {
        float v = from[i];
        if (v > kLargestHalf) {
            v = kLargestHalf;
            ++losses.above;
        } else if (v < -kLargestHalf) {
            v = -kLargestHalf;
            ++losses.below;
        }
        to[i] = half(v);
    }
    return losses;
}

WriteLosses writeHalf(Imf::OutputFile& file, const Image& image, const WriteOptions& options) {
    constexpr int kRows = 256; // a multiple of every compression's chunk height
    const std::size_t row = image.rowFloats();
    std::vector<half> scratch(row * static_cast<std::size_t>(std::min(kRows, image.height)));
    WriteLosses total;
    for (int y = 0; y < image.height; y += kRows) {
        const int rows = std::min(kRows, image.height - y);
        std::vector<WriteLosses> losses(static_cast<std::size_t>(rows));
        parallelForRuns(
            losses.size(), 32, options.threads, [&](std::size_t first, std::size_t last) {
                for (std::size_t r = first; r < last; ++r) {
                    losses[r] =
                        toHalf(image.row(y + static_cast<int>(r)), row, scratch.data() + r * row);
                }
            });
        for (const WriteLosses& l : losses)
            total += l;
        writeRows(file, Imf::HALF, scratch.data(), y, rows, image, options);
    }
    return total;
}

} // namespace

WriteLosses writeExr(OutputFile& file, const Image& image, const WriteOptions& options) {
    WriteLosses losses;
    try {
        OutputStream stream(file);
        const Imf::Header header = makeHeader(image, options, file.path());
        // Handing rows to other threads costs more than copying them, and OpenEXR hands them to its
        // pool, which reading may have made, whatever number a file is given.
        const bool plain = header.compression() == Imf::NO_COMPRESSION;
        if (plain && Imf::globalThreadCount() > 0) Imf::setGlobalThreadCount(0);
        Imf::OutputFile out(stream, header, plain ? 0 : exrThreads(options.threads));
        if (options.type == PixelType::half) {
            losses = writeHalf(out, image, options);
        } else {
            writeRows(out, Imf::FLOAT, image.pixels.data(), 0, image.height, image, options);
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        file.flush(); // a failed write has its own, better words
        throw outputError(file.path(), std::string("OpenEXR cannot write it (") + e.what() + ")");
    }
    file.flush();
    return losses;
}

} // namespace ibl
