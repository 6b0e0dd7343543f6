#include "image/png.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/source.h"
#include "image/srgb.h"

#include <png.h>

#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <vector>

namespace ibl {
namespace {

/// What libpng's callbacks see. libpng reports errors by a jump, which runs no destructors: every
/// function between setjmp and libpng below holds plain data only.
struct Reader {
    std::span<const std::uint8_t> bytes;
    std::size_t position = 0;
    std::array<char, 128> error{};
    png_structp png = nullptr;
    png_infop info = nullptr;

    Reader() = default;
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void onError(png_structp png, png_const_charp message) {
    auto* reader = static_cast<Reader*>(png_get_error_ptr(png));
    std::strncpy(reader->error.data(), message, reader->error.size() - 1);
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void onRead(png_structp png, png_bytep out, std::size_t count) {
    auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
    if (count > reader->bytes.size() - reader->position) png_error(png, "it ends too early");
    std::memcpy(out, reader->bytes.data() + reader->position, count);
    reader->position += count;
}

struct Shape {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    int depth = 0;    ///< 8 or 16, after expansion
    int channels = 0; ///< 3 or 4, after expansion
    std::size_t row_bytes = 0;
    double gamma = 0; ///< of a gAMA chunk that overrules sRGB; 0: sRGB
};

/// Reads up to the pixels and asks for RGB or RGBA in the machine's byte order. False on an error.
bool readInfo(Reader& reader, Shape& shape) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
    png_set_read_fn(reader.png, &reader, onRead);
    png_set_user_limits(reader.png, kMaxImageEdge, kMaxImageEdge);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);
    png_set_gray_to_rgb(reader.png);
    if constexpr (std::endian::native == std::endian::little) png_set_swap(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    shape.width = png_get_image_width(reader.png, reader.info);
    shape.height = png_get_image_height(reader.png, reader.info);
    shape.depth = png_get_bit_depth(reader.png, reader.info);
    shape.channels = png_get_channels(reader.png, reader.info);
    shape.row_bytes = png_get_rowbytes(reader.png, reader.info);
    if (png_get_valid(reader.png, reader.info, PNG_INFO_sRGB | PNG_INFO_iCCP) == 0) {
        png_get_gAMA(reader.png, reader.info, &shape.gamma);
    }
    return true;
}

bool readRows(Reader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

/// Linear light of every code of 8 or 16 bits, or the code itself, as a part of the largest.
std::vector<float> decodingTable(const Shape& shape, bool undecoded) {
    std::vector<float> table(std::size_t{1} << shape.depth);
    const double last = static_cast<double>(table.size() - 1);
    for (std::size_t code = 0; code < table.size(); ++code) {
        const double v = static_cast<double>(code) / last;
        table[code] = undecoded         ? static_cast<float>(v)
                      : shape.gamma > 0 ? static_cast<float>(std::pow(v, 1 / shape.gamma))
                                        : srgbToLinear(static_cast<float>(v));
    }
    return table;
}

template <class Code>
void decodeRow(const std::uint8_t* row, int stored_channels, const std::vector<float>& table,
               bool premultiply, Image& image, int y) {
    const auto* codes = reinterpret_cast<const Code*>(row);
    const float alpha_scale = 1.0F / static_cast<float>(table.size() - 1);
    float* out = image.row(y);
    for (int x = 0; x < image.width; ++x, codes += stored_channels, out += image.channels) {
        const float alpha = image.channels == 4 ? static_cast<float>(codes[3]) * alpha_scale : 1.0F;
        for (int c = 0; c < 3; ++c)
            out[c] = table[codes[c]] * (premultiply ? alpha : 1);
        if (image.channels == 4) out[3] = alpha;
    }
}

} // namespace

ImageFile readPng(std::span<const std::uint8_t> bytes, const std::string& name,
                  const ReadOptions& options) {
    Reader reader;
    reader.bytes = bytes;
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, onError, onWarning);
    if (reader.png) reader.info = png_create_info_struct(reader.png);
    if (!reader.info) throw inputError(name, "does not fit into memory");
    const auto damaged = [&] {
        return inputError(name, std::string("is a damaged or truncated PNG file (") +
                                    reader.error.data() + "); write it again");
    };
    Shape shape;
    if (!readInfo(reader, shape)) throw damaged();
    checkSize(name, shape.width, shape.height);
    // Deflate packs at most 1032 to one; palettes and bits less than a byte are expanded by 32.
    const std::size_t size = shape.row_bytes * shape.height;
    if (size / (1032 * 32) > bytes.size()) throw damaged();

    std::vector<std::uint8_t, UninitialisedAllocator<std::uint8_t>> pixels(size);
    std::vector<png_bytep> rows(shape.height);
    for (std::size_t y = 0; y < rows.size(); ++y)
        rows[y] = pixels.data() + y * shape.row_bytes;
    if (!readRows(reader, rows.data())) throw damaged();

    ImageFile file;
    const bool has_alpha = shape.channels == 4;
    file.image = Image(static_cast<int>(shape.width), static_cast<int>(shape.height),
                       has_alpha && options.keep_alpha ? 4 : 3);
    const std::vector<float> table = decodingTable(shape, options.undecoded);
    parallelForRuns(rows.size(), 32, options.threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y) {
            if (shape.depth == 16) {
                decodeRow<std::uint16_t>(rows[y], shape.channels, table, !options.undecoded,
                                         file.image, int(y));
            } else {
                decodeRow<std::uint8_t>(rows[y], shape.channels, table, !options.undecoded,
                                        file.image, int(y));
            }
        }
    });
    file.format = "png";
    file.compression = "deflate";
    file.pixel_type = shape.depth == 16 ? "uint16" : "uint8";
    if (!options.undecoded)
        file.notes.push_back(shape.gamma > 0
                                 ? "is display-referred, of low dynamic range; decoded by "
                                   "its gAMA chunk"
                                 : "is display-referred, of low dynamic range; decoded "
                                   "from sRGB");
    if (has_alpha && !options.keep_alpha) file.notes.push_back("its alpha channel is ignored");
    return file;
}

} // namespace ibl
