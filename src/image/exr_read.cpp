#include "image/exr.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/exr_chunks.h"
#include "image/exr_headers.h"
#include "image/exr_layers.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <memory>
#include <sstream>

namespace ibl {
namespace {

using Imath::Box2i;

const char* compressionName(Imf::Compression compression) {
    switch (compression) {
    case Imf::NO_COMPRESSION:
        return "none";
    case Imf::RLE_COMPRESSION:
        return "rle";
    case Imf::ZIPS_COMPRESSION:
        return "zips";
    case Imf::ZIP_COMPRESSION:
        return "zip";
    case Imf::PIZ_COMPRESSION:
        return "piz";
    case Imf::PXR24_COMPRESSION:
        return "pxr24";
    case Imf::B44_COMPRESSION:
        return "b44";
    case Imf::B44A_COMPRESSION:
        return "b44a";
    case Imf::DWAA_COMPRESSION:
        return "dwaa";
    case Imf::DWAB_COMPRESSION:
        return "dwab";
    default:
        return "unknown";
    }
}

const char* typeName(Imf::PixelType type) {
    return type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
}

std::string windowText(const Box2i& w) {
    std::ostringstream text;
    text << '(' << w.min.x << ", " << w.min.y << ") to (" << w.max.x << ", " << w.max.y << ')';
    return text.str();
}

void noteChromaticities(const Imf::Header& header, std::vector<std::string>& notes) {
    if (!Imf::hasChromaticities(header)) return;
    const Imf::Chromaticities here = Imf::chromaticities(header), rec709;
    const auto differ = [](const Imath::V2f& a, const Imath::V2f& b) {
        return (a - b).length() > 0.002F;
    };
    if (differ(here.red, rec709.red) || differ(here.green, rec709.green) ||
        differ(here.blue, rec709.blue) || differ(here.white, rec709.white)) {
        notes.push_back("its chromaticities are not Rec. 709's; colours are read as they are");
    }
}

struct Channels {
    std::vector<std::string> names; ///< those of colour, then alpha
    Imf::PixelType type = Imf::FLOAT;
    bool alpha = false;

    /// Among a pixel's floats: a single colour goes to the first, alpha always to the fourth.
    std::size_t place(std::size_t channel) const {
        return alpha && channel + 1 == names.size() ? 3 : channel;
    }
};

Channels channelsOf(const Imf::Header& header, const ExrChoice& choice, bool alpha,
                    const std::string& name) {
    Channels channels{choice.channels, header.channels()[choice.channels[0]].type};
    channels.alpha = alpha;
    if (alpha) channels.names.push_back(choice.prefix + "A");
    for (const std::string& c : channels.names) {
        const Imf::Channel& channel = header.channels()[c];
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            throw inputError(name, "its channel " + c + " is subsampled; resample it first");
        }
    }
    return channels;
}

/// The display window's image and where the file's pixels go in it.
struct Target {
    Box2i display, data, shared; ///< shared: the part of both (perhaps empty)
    Image image;

    Target(const Imf::Header& header, int channels)
        : display(header.displayWindow()),
          data(header.dataWindow()),
          shared({std::max(display.min.x, data.min.x), std::max(display.min.y, data.min.y)},
                 {std::min(display.max.x, data.max.x), std::min(display.max.y, data.max.y)}),
          image(static_cast<int>(windowExtent(display.min.x, display.max.x)),
                static_cast<int>(windowExtent(display.min.y, display.max.y)), channels) {}
    float* at(int x, int y) { return image.at(x - display.min.x, y - display.min.y); }
    std::size_t dataWidth() const { return static_cast<std::size_t>(data.max.x - data.min.x) + 1; }
    bool empty() const { return shared.isEmpty(); }
};

/// Address of the pixel (0, 0) that OpenEXR's slices want, given that of (x, y). It need not lie in
/// the buffer, so it is reckoned as a number.
template <class T>
char* sliceBase(T* pixel, int x, int y, std::size_t x_stride, std::size_t y_stride) {
    const auto address = reinterpret_cast<std::uintptr_t>(pixel);
    const auto offset = std::int64_t{x} * static_cast<std::int64_t>(x_stride) +
                        std::int64_t{y} * static_cast<std::int64_t>(y_stride);
    return reinterpret_cast<char*>(address - static_cast<std::uintptr_t>(offset));
}

/// Zero where the data window has no pixels. Done last, so that a header that lies about the
/// windows has failed before the memory is touched.
void clearOutside(Target& target) {
    const std::size_t channels = static_cast<std::size_t>(target.image.channels);
    const auto left = target.empty() ? 0 : std::int64_t{target.shared.min.x} - target.display.min.x;
    const auto right =
        target.empty() ? 0 : std::int64_t{target.display.max.x} - target.shared.max.x;
    for (int row = 0; row < target.image.height; ++row) {
        const std::int64_t y = std::int64_t{target.display.min.y} + row;
        float* begin = target.image.row(row);
        float* end = begin + target.image.rowFloats();
        if (target.empty() || y < target.shared.min.y || y > target.shared.max.y) {
            std::fill(begin, end, 0.0F);
        } else {
            std::fill_n(begin, static_cast<std::size_t>(left) * channels, 0.0F);
            std::fill_n(end - static_cast<std::size_t>(right) * channels,
                        static_cast<std::size_t>(right) * channels, 0.0F);
        }
    }
}

void setFloats(Imf::InputPart& part, const Channels& channels, float* pixel, int x, int y,
               std::size_t row_pixels, std::size_t pixel_floats) {
    Imf::FrameBuffer buffer;
    const std::size_t x_stride = pixel_floats * sizeof(float);
    const std::size_t y_stride = row_pixels * x_stride;
    for (std::size_t c = 0; c < channels.names.size(); ++c) {
        char* base = sliceBase(pixel + channels.place(c), x, y, x_stride, y_stride);
        buffer.insert(channels.names[c], Imf::Slice(Imf::FLOAT, base, x_stride, y_stride));
    }
    part.setFrameBuffer(buffer);
}

/// Calls `readRows(y_first, y_last)` for blocks of rows that fit a scratch of a few MB.
template <class ReadRows>
void forRowBlocks(const Target& target, std::size_t pixel_bytes, const ReadRows& readRows) {
    constexpr std::size_t kScratchBytes = 32 << 20;
    const std::size_t rows = kScratchBytes / (target.dataWidth() * pixel_bytes);
    // A multiple of the chunk height, so that few chunks are decoded twice.
    const int step = rows >= 256 ? 256 : rows >= 32 ? 32 : 16;
    for (int y = target.shared.min.y; y <= target.shared.max.y;) {
        const int last = std::min<std::int64_t>(target.shared.max.y, std::int64_t{y} + step - 1);
        readRows(y, last);
        if (last == target.shared.max.y) break;
        y = last + 1;
    }
}

/// By chunks, if all of the data window is wanted.
bool readAllChunks(const Source& source, const Imf::Header& header, const ExrChoice& choice,
                   const Channels& channels, int threads, Target& target) {
    if (target.shared != target.data) return false;
    ExrPixels pixels{channels.names,
                     {},
                     target.at(target.data.min.x, target.data.min.y),
                     static_cast<std::size_t>(target.image.channels),
                     target.image.rowFloats()};
    for (std::size_t c = 0; c < channels.names.size(); ++c)
        pixels.place.push_back(channels.place(c));
    return readExrChunks(source, header, choice.part, pixels, threads);
}

void readChannels(Imf::MultiPartInputFile& file, const ExrChoice& choice, const Channels& channels,
                  Target& target) {
    if (target.empty()) return;
    Imf::InputPart part(file, choice.part);
    const std::size_t floats = static_cast<std::size_t>(target.image.channels);
    if (target.shared == target.data) {
        setFloats(part, channels, target.at(target.data.min.x, target.data.min.y),
                  target.data.min.x, target.data.min.y,
                  static_cast<std::size_t>(target.image.width), floats);
        part.readPixels(target.data.min.y, target.data.max.y);
        return;
    }
    const std::size_t row = target.dataWidth() * floats;
    const std::size_t kept =
        static_cast<std::size_t>(target.shared.max.x - target.shared.min.x + 1);
    const std::size_t skipped = static_cast<std::size_t>(target.shared.min.x - target.data.min.x);
    std::vector<float> scratch;
    forRowBlocks(target, floats * sizeof(float), [&](int first, int last) {
        scratch.assign(row * static_cast<std::size_t>(last - first + 1), 0.0F);
        setFloats(part, channels, scratch.data(), target.data.min.x, first, target.dataWidth(),
                  floats);
        part.readPixels(first, last);
        for (int y = first; y <= last; ++y) {
            const float* from =
                scratch.data() + row * static_cast<std::size_t>(y - first) + skipped * floats;
            std::copy_n(from, kept * floats, target.at(target.shared.min.x, y));
        }
    });
}

/// Luminance and chroma by OpenEXR's own reconstruction, which works in half precision and undoes
/// the file's chromaticities' luminance weights.
void readLuminanceChroma(Imf::IStream& stream, const ExrChoice& choice, int threads,
                         Target& target) {
    stream.seekg(0);
    const std::string layer =
        choice.prefix.empty() ? "" : choice.prefix.substr(0, choice.prefix.size() - 1);
    Imf::RgbaInputFile file(stream, layer, threads);
    if (target.empty()) return;
    std::vector<Imf::Rgba> scratch;
    const std::size_t width = target.dataWidth();
    forRowBlocks(target, sizeof(Imf::Rgba), [&](int first, int last) {
        scratch.resize(width * static_cast<std::size_t>(last - first + 1));
        const std::size_t y_stride = width * sizeof(Imf::Rgba);
        file.setFrameBuffer(
            reinterpret_cast<Imf::Rgba*>(
                sliceBase(scratch.data(), target.data.min.x, first, sizeof(Imf::Rgba), y_stride)),
            1, width);
        file.readPixels(first, last);
        for (int y = first; y <= last; ++y) {
            const Imf::Rgba* from = scratch.data() + width * static_cast<std::size_t>(y - first);
            for (int x = target.shared.min.x; x <= target.shared.max.x; ++x) {
                const Imf::Rgba& p = from[x - target.data.min.x];
                float* to = target.at(x, y);
                to[0] = p.r;
                to[1] = p.g;
                to[2] = p.b;
                if (target.image.channels == 4) to[3] = p.a;
            }
        }
    });
}

void spreadGrey(Image& image, int threads) {
    parallelForRuns(image.height, 64, threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y) {
            float* p = image.row(static_cast<int>(y));
            for (int x = 0; x < image.width; ++x, p += image.channels)
                p[1] = p[2] = p[0];
        }
    });
}

template <class T>
std::optional<T> attribute(const Imf::Header& header, const char* name) {
    const auto* found = header.findTypedAttribute<Imf::TypedAttribute<T>>(name);
    return found ? std::optional<T>(found->value()) : std::nullopt;
}

MapLabel labelOf(const Imf::Header& header) {
    MapLabel label;
    label.kernel = attribute<std::string>(header, "ibl.kernel").value_or("");
    label.roughness = attribute<float>(header, "ibl.roughness");
    label.exponent = attribute<float>(header, "ibl.exponent");
    label.level = attribute<int>(header, "ibl.level").value_or(0);
    label.levels = attribute<int>(header, "ibl.levels").value_or(0);
    return label;
}

void describe(const std::vector<Imf::Header>& parts, const ExrChoice& choice,
              const ReadOptions& options, const Target& target, ImageFile& file) {
    const Imf::Header& header = parts[static_cast<std::size_t>(choice.part)];
    file.format = "exr";
    file.compression = compressionName(header.compression());
    file.layers = exrLayers(parts);
    file.layout = attribute<std::string>(header, "ibl.layout").value_or("");
    file.label = labelOf(header);
    if (Imf::hasEnvmap(header)) {
        file.envmap = Imf::envmap(header) == Imf::ENVMAP_CUBE ? "cube" : "latlong";
    }
    if (choice.alpha && !options.keep_alpha) file.notes.push_back("its alpha channel is ignored");
    if (choice.colour == ExrColour::luminance) {
        file.notes.push_back("is luminance only; read as grey");
    } else if (choice.colour == ExrColour::grey) {
        file.notes.push_back("its channel " + choice.channels[0] + " is read as grey");
    } else if (choice.colour == ExrColour::luminanceChroma) {
        file.notes.push_back("is luminance and subsampled chroma; colours are reconstructed");
    }
    if (target.data != target.display) {
        file.notes.push_back("its data window " + windowText(target.data) +
                             " is not its display window " + windowText(target.display) +
                             "; the image is the display window, 0 where there is no data");
    }
    noteChromaticities(header, file.notes);
    if (parts.size() > 1) {
        file.notes.push_back("has " + std::to_string(parts.size()) + " parts; part " +
                             std::to_string(choice.part + 1) +
                             (header.hasName() ? " (" + header.name() + ")" : "") + " is read");
    }
}

ImageFile readParts(Imf::IStream& stream, const Source& source, const ReadOptions& options) {
    const std::string& name = source.name;
    const std::vector<Imf::Header> parts = readExrHeaders(stream, name);
    const ExrChoice choice = chooseExrLayer(parts, options.layer, name);
    const Imf::Header& header = parts[static_cast<std::size_t>(choice.part)];
    const bool alpha = options.keep_alpha && choice.alpha;
    const bool chroma = choice.colour == ExrColour::luminanceChroma;
    if (chroma && choice.part != 0) {
        throw inputError(name, "has luminance and chroma in a part that is not the first; convert "
                               "it to RGB first");
    }

    ImageFile file;
    const Channels channels = channelsOf(header, choice, alpha, name);
    file.pixel_type = typeName(channels.type);
    const int threads = exrThreads(options.threads);
    stream.seekg(0);
    // An incomplete table of chunks means that the writer was interrupted: no guessing at it.
    Imf::MultiPartInputFile input(stream, threads, false);
    if (!input.partComplete(choice.part)) {
        throw inputError(name, "is incomplete, its writer was interrupted; write it again");
    }
    Target target(header, alpha ? 4 : 3);
    if (chroma) {
        readLuminanceChroma(stream, choice, threads, target);
    } else {
        if (!readAllChunks(source, header, choice, channels, options.threads, target))
            readChannels(input, choice, channels, target);
        if (choice.channels.size() == 1) spreadGrey(target.image, threads);
    }
    clearOutside(target);
    describe(parts, choice, options, target, file);
    file.image = std::move(target.image);
    return file;
}

/// What OpenEXR found wrong, without the file's name and what it was about when it did, which it
/// puts ahead ('Error reading pixel data from image file "NAME". '), and without the full stop.
std::string plainProblem(const std::string& said) {
    constexpr std::string_view kAhead = "\". ";
    const std::size_t ahead = said.rfind(kAhead);
    std::string problem = ahead == said.npos ? said : said.substr(ahead + kAhead.size());
    if (problem.ends_with('.')) problem.pop_back();
    return problem;
}

} // namespace

int exrThreads(int threads) {
    const int count = threadCount(threads);
    if (count == 1) return 0; // the calling thread does the work itself
    if (Imf::globalThreadCount() < count) Imf::setGlobalThreadCount(count);
    return count;
}

ImageFile readExr(const Source& source, const ReadOptions& options) {
    try {
        const std::unique_ptr<Imf::IStream> stream = openExrStream(source);
        return readParts(*stream, source, options);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw inputError(source.name, "does not fit into memory; shrink it first");
    } catch (const std::exception& e) {
        throw inputError(source.name, std::string("is a damaged or truncated OpenEXR file (") +
                                          plainProblem(e.what()) + "); write it again");
    }
}

} // namespace ibl
