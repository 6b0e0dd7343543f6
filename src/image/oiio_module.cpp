// The module ibltool_oiio.so: the only code that sees OpenImageIO.
#include "image/oiio.h"

#include "core/error.h"
#include "image/srgb.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

namespace ibl {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// The first line of OpenImageIO's complaint.
std::string firstLine(const std::string& text) {
    const std::string line = text.substr(0, text.find('\n'));
    return line.empty() ? "no reason given" : line;
}

/// Which of the file's channels are red, green, blue and alpha; grey names one channel thrice.
struct Channels {
    int red = 0, green = 0, blue = 0;
    int alpha = -1;
};

Channels channelsOf(const ImageSpec& spec) {
    Channels channels;
    channels.alpha = spec.alpha_channel;
    const int colours = spec.nchannels - (channels.alpha >= 0 ? 1 : 0);
    if (colours >= 3) {
        channels.red = spec.channelindex("R");
        channels.green = spec.channelindex("G");
        channels.blue = spec.channelindex("B");
        if (channels.red < 0 || channels.green < 0 || channels.blue < 0) {
            throw std::runtime_error("has " + std::to_string(colours) +
                                     " channels that are not R, G and B; give an RGB image");
        }
    } else if (colours != 1 || channels.alpha == 0) {
        throw std::runtime_error("has neither one nor three colour channels; give an RGB image");
    }
    return channels;
}

/// Integer pixels are display-referred unless the file says otherwise.
bool isEncoded(const ImageSpec& spec) {
    if (spec.format.is_floating_point()) return false;
    return !OIIO::Strutil::iequals(spec.get_string_attribute("oiio:ColorSpace"), "linear");
}

/// Linear light, premultiplied. Of 8-bit files only 256 values can come, which saves the powers.
void toLinear(Image& image, const ImageSpec& spec) {
    const bool encoded = isEncoded(spec), bytes = spec.format == TypeDesc::UINT8;
    const bool premultiply =
        image.channels == 4 && spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < 256; ++i)
        table[i] = srgbToLinear(static_cast<float>(i) / 255);
    const std::size_t pixels = static_cast<std::size_t>(image.width) * image.height;
    float* p = image.pixels.data();
    for (std::size_t i = 0; i < pixels; ++i, p += image.channels) {
        for (int c = 0; c < 3; ++c) {
            if (encoded) {
                p[c] = bytes ? table[static_cast<std::size_t>(p[c] * 255 + 0.5F) & 255]
                             : srgbToLinear(p[c]);
            }
            if (premultiply) p[c] *= p[3];
        }
    }
}

Image readPixels(ImageInput& in, const ImageSpec& spec, const Channels& channels, bool alpha) {
    Image image(spec.width, spec.height, alpha ? 4 : 3);
    const OIIO::stride_t stride = image.channels * static_cast<OIIO::stride_t>(sizeof(float));
    const bool in_order = channels.green == channels.red + 1 && channels.blue == channels.red + 2;
    const auto read = [&](int first, int count, int to) {
        if (!in.read_image(0, 0, first, first + count, TypeDesc::FLOAT, image.pixels.data() + to,
                           stride)) {
            throw std::runtime_error("is damaged or truncated (" + firstLine(in.geterror()) +
                                     "); write it again");
        }
    };
    if (in_order) {
        read(channels.red, 3, 0);
    } else {
        read(channels.red, 1, 0);
        read(channels.green, 1, 1);
        read(channels.blue, 1, 2);
    }
    if (alpha) read(channels.alpha, 1, 3);
    if (in.has_error()) {
        throw std::runtime_error("is damaged or truncated (" + firstLine(in.geterror()) +
                                 "); write it again");
    }
    return image;
}

ImageFile read(const std::string& path, const ReadOptions& options) {
    OIIO::attribute("threads", options.threads);
    ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1); // premultiplied here, once linear
    const auto in = ImageInput::open(path, &config);
    if (!in) {
        OIIO::geterror(); // a list of what each reader disliked
        throw std::runtime_error("is damaged or in no format that can be read; give OpenEXR, "
                                 "Radiance, PNG, TIFF or another image that OpenImageIO reads");
    }
    const ImageSpec spec = in->spec();
    if (spec.deep) throw std::runtime_error("is a deep image; flatten it first");
    if (spec.depth > 1) throw std::runtime_error("is a volume; give an image");
    checkSize("image", spec.width, spec.height);
    const Channels channels = channelsOf(spec);
    const bool alpha = options.keep_alpha && channels.alpha >= 0;
    const bool encoded = isEncoded(spec) && !options.undecoded;

    ImageFile file;
    file.image = readPixels(*in, spec, channels, alpha);
    if (!options.undecoded) toLinear(file.image, spec);
    file.format = in->format_name();
    file.compression = spec.get_string_attribute("compression");
    file.pixel_type = spec.format.c_str();
    if (encoded) {
        file.notes.push_back("is display-referred, of low dynamic range; decoded from sRGB");
    }
    if (channels.alpha >= 0 && !alpha) file.notes.push_back("its alpha channel is ignored");
    return file;
}

/// Clamps to what `largest` allows, or to [0, 1] with sRGB encoding if that is 1.
void encode(std::vector<float>& row, int channels, float largest, WriteLosses& losses) {
    const bool encoded = largest == 1;
    for (std::size_t i = 0; i < row.size(); ++i) {
        float& v = row[i];
        if (v > largest) {
            ++losses.above;
            v = largest;
        } else if (v < (encoded ? 0.0F : -largest)) {
            ++losses.below;
            v = encoded ? 0 : -largest;
        } else if (encoded && std::isnan(v)) {
            ++losses.not_number;
            v = 0;
        }
        const bool is_alpha = channels == 4 && i % 4 == 3;
        if (encoded && !is_alpha) v = static_cast<float>(linearToSrgb(v));
    }
}

std::unique_ptr<ImageOutput> writerOf(const std::string& format) {
    // They write, but no file.
    if (format == "term" || format == "null") return nullptr;
    auto out = ImageOutput::create(format);
    if (!out) OIIO::geterror();
    return out;
}

WriteLosses write(const std::string& path, const Image& image, const std::string& format,
                  const WriteOptions& options) {
    OIIO::attribute("threads", options.threads);
    const auto out = writerOf(format);
    if (!out) throw std::runtime_error("no writer for '" + format + "'");
    const bool tiff = out->format_name() == std::string("tiff");
    const bool as_half = tiff && options.type == PixelType::half;
    const TypeDesc type = as_half ? TypeDesc::HALF : tiff ? TypeDesc::FLOAT : TypeDesc::UINT8;
    const float largest = as_half ? 65504.0F : tiff ? INFINITY : 1.0F;
    // Formats without alpha take the colours alone.
    const int channels = out->supports("alpha") ? image.channels : 3;
    ImageSpec spec(image.width, image.height, channels, type);
    spec.attribute("oiio:ColorSpace", tiff ? "Linear" : "sRGB");
    if (tiff) spec.attribute("compression", "zip");
    if (as_half) spec.attribute("tiff:half", 1); // otherwise it would be widened to float
    spec.attribute("DateTime", "");              // or it would be now
    if (!out->open(path, spec)) {
        throw std::runtime_error("cannot be written (" + firstLine(out->geterror()) + ")");
    }
    WriteLosses losses;
    std::vector<float> row(static_cast<std::size_t>(image.width) * channels);
    bool ok = true;
    for (int y = 0; ok && y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            std::copy_n(image.at(x, y), channels,
                        row.data() + static_cast<std::size_t>(x) * channels);
        }
        encode(row, channels, largest, losses);
        ok = out->write_scanline(y, 0, TypeDesc::FLOAT, row.data());
    }
    if (!ok || !out->close()) {
        throw std::runtime_error("cannot be written (" + firstLine(out->geterror()) + ")");
    }
    return losses;
}

/// Runs `body` and turns whatever it throws into words.
template <class Body>
bool withoutExceptions(std::string& error, const Body& body) noexcept {
    try {
        body();
        return true;
    } catch (const std::bad_alloc&) {
        error = "does not fit into memory";
    } catch (const std::exception& e) {
        error = e.what();
    } catch (...) {
        error = "OpenImageIO failed";
    }
    return false;
}

} // namespace
} // namespace ibl

extern "C" __attribute__((visibility("default"))) bool
ibltoolOiioRead(const std::string& path, const ibl::ReadOptions& options, ibl::ImageFile& file,
                std::string& error) noexcept {
    return ibl::withoutExceptions(error, [&] { file = ibl::read(path, options); });
}

extern "C" __attribute__((visibility("default"))) bool
ibltoolOiioWrite(const std::string& path, const ibl::Image& image, const std::string& format,
                 const ibl::WriteOptions& options, ibl::WriteLosses& losses,
                 std::string& error) noexcept {
    return ibl::withoutExceptions(error,
                                  [&] { losses = ibl::write(path, image, format, options); });
}

extern "C" __attribute__((visibility("default"))) bool
ibltoolOiioHasWriter(const std::string& format) noexcept {
    std::string error;
    bool has = false;
    return ibl::withoutExceptions(error, [&] { has = ibl::writerOf(format) != nullptr; }) && has;
}
