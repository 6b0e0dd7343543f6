#include "image/png.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/srgb.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

// libpng compresses on one thread and filters row by row; a PNG is a zlib stream in chunks, which
// is little enough to write that strips of rows can be compressed at once. Strips end on byte
// boundaries (Z_SYNC_FLUSH) and start with an empty window, so that they simply follow each other
// (as in pigz, Mark Adler); their checksums combine.

namespace ibl {
namespace {

/// Fixed, so that the bytes do not depend on the number of threads.
constexpr std::size_t kStripBytes = 512 * 1024;

void appendBigEndian(std::string& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
        out.push_back(static_cast<char>(value >> shift));
}

void writeChunk(OutputFile& file, std::string_view type, std::string_view data) {
    std::string chunk;
    chunk.reserve(data.size() + 12);
    appendBigEndian(chunk, static_cast<std::uint32_t>(data.size()));
    chunk += type;
    chunk += data;
    const auto* checked = reinterpret_cast<const Bytef*>(chunk.data()) + 4;
    appendBigEndian(chunk, static_cast<std::uint32_t>(
                               crc32_z(crc32_z(0, nullptr, 0), checked, chunk.size() - 4)));
    file.write(chunk);
}

/// Filter 1, "sub": differences from the pixel to the left.
void filterSub(const std::uint8_t* __restrict row, std::size_t count, std::size_t channels,
               std::uint8_t* __restrict out) {
    *out++ = 1;
    std::copy_n(row, channels, out);
    for (std::size_t i = channels; i < count; ++i) {
        out[i] = static_cast<std::uint8_t>(row[i] - row[i - channels]);
    }
}

struct Strip {
    std::string deflated;
    uLong checksum = 0; ///< Adler-32 of the filtered bytes
    std::size_t size = 0;
};

Strip deflateStrip(const std::vector<std::uint8_t>& filtered, bool last) {
    Strip strip;
    strip.size = filtered.size();
    strip.checksum = adler32_z(adler32_z(0, nullptr, 0), filtered.data(), filtered.size());
    z_stream z = {};
    // Measured with each filter and strategy on a tone-mapped probe and a rendered sphere (2 and
    // 0.9 megapixels): sub and level 1 take 54 and 11 ms of CPU for 1.58 and 0.23 MB; Paeth with
    // runs alone 82 and 16 ms for 1.22 and 0.25 MB; choosing the filter row by row 176 and 66 ms
    // for no less; level 6 gains a fifth for eight times the time.
    if (deflateInit2(&z, 1, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
        throw std::bad_alloc();
    }
    strip.deflated.resize(deflateBound(&z, static_cast<uLong>(filtered.size())) + 16);
    z.next_in = const_cast<Bytef*>(filtered.data());
    z.avail_in = static_cast<uInt>(filtered.size());
    z.next_out = reinterpret_cast<Bytef*>(strip.deflated.data());
    z.avail_out = static_cast<uInt>(strip.deflated.size());
    deflate(&z, last ? Z_FINISH : Z_SYNC_FLUSH);
    strip.deflated.resize(strip.deflated.size() - z.avail_out);
    deflateEnd(&z);
    return strip;
}

/// Writes the file, getting the bytes of row y from `encodeRow(y, buffer)`.
template <class EncodeRow>
void writeRows(OutputFile& file, int width, int height, int channels, bool is_srgb, int bits,
               int threads, const EncodeRow& encodeRow) {
    const std::size_t pixel_bytes = static_cast<std::size_t>(channels * bits / 8);
    const std::size_t row_bytes = static_cast<std::size_t>(width) * pixel_bytes;
    const std::size_t rows_a_strip = std::max<std::size_t>(1, kStripBytes / (row_bytes + 1));
    const std::size_t rows = static_cast<std::size_t>(height);
    std::vector<Strip> strips((rows + rows_a_strip - 1) / rows_a_strip);
    parallelForRuns(rows, rows_a_strip, threads, [&](std::size_t first, std::size_t last) {
        std::vector<std::uint8_t> filtered((last - first) * (row_bytes + 1));
        std::vector<std::uint8_t> buffer(row_bytes);
        for (std::size_t y = first; y < last; ++y) {
            encodeRow(y, buffer.data());
            filterSub(buffer.data(), row_bytes, pixel_bytes,
                      filtered.data() + (y - first) * (row_bytes + 1));
        }
        strips[first / rows_a_strip] = deflateStrip(filtered, last == rows);
    });

    file.write("\x89PNG\r\n\x1a\n");
    std::string header;
    appendBigEndian(header, static_cast<std::uint32_t>(width));
    appendBigEndian(header, static_cast<std::uint32_t>(height));
    header += {static_cast<char>(bits), channels == 4 ? '\x06' : '\x02', '\0', '\0', '\0'};
    writeChunk(file, "IHDR", header);
    if (is_srgb) writeChunk(file, "sRGB", std::string_view("\0", 1)); // perceptual intent
    uLong checksum = adler32_z(0, nullptr, 0);
    for (std::size_t s = 0; s < strips.size(); ++s) {
        Strip& strip = strips[s];
        checksum = adler32_combine(checksum, strip.checksum, static_cast<z_off_t>(strip.size));
        // zlib's two bytes (32 KiB window, fastest), the deflate blocks, the checksum.
        if (s == 0) strip.deflated.insert(0, "\x78\x01");
        if (s + 1 == strips.size()) {
            appendBigEndian(strip.deflated, static_cast<std::uint32_t>(checksum));
        }
        writeChunk(file, "IDAT", strip.deflated);
    }
    writeChunk(file, "IEND", {});
}

/// The threshold of Bayer's 16x16 pattern at a pixel, above 0 and below 1: the bits of x ^ y and y,
/// interleaved from the lowest, are those of the threshold from the highest.
double ditherThreshold(int x, int y) {
    int rank = 0;
    for (int bit = 0; bit < 4; ++bit) {
        rank = 4 * rank + 2 * (((x ^ y) >> bit) & 1) + ((y >> bit) & 1);
    }
    return (rank + 0.5) / 256;
}

/// The code of a value with the pattern, or of more bits than eight.
std::uint32_t codeOf(float value, const PngOptions& options, double threshold) {
    const double linear = value > 0 ? std::min(value, 1.0F) : 0; // NaN: 0
    const double encoded = options.encoded ? linear : linearToSrgb(linear);
    return static_cast<std::uint32_t>(encoded * ((1 << options.bits) - 1) + threshold);
}

void count(WriteLosses& losses, float value) {
    losses.above += value > 1;
    losses.below += value < 0;
    losses.not_number += std::isnan(value);
}

/// One row of straight colours of 8 bits without a pattern, which needs no powers.
WriteLosses encodeRowByTable(const float* row, std::size_t values, std::uint8_t* out) {
    linearToSrgb8(row, values, out);
    std::uint32_t above = 0, below = 0, numbers = 0; // as wide as floats, to be counted in lanes
    for (std::size_t i = 0; i < values; ++i) {
        above += row[i] > 1;
        below += row[i] < 0;
        numbers += row[i] == row[i];
    }
    WriteLosses losses;
    losses.above = above;
    losses.below = below;
    losses.not_number = values - numbers;
    for (std::size_t i = 0; losses.above > 0 && i < values; i += 3)
        losses.bright_pixels += row[i] > 1 || row[i + 1] > 1 || row[i + 2] > 1;
    return losses;
}

/// One row of floats to bytes. Values outside [0, 1] are counted.
WriteLosses encodeRow(const Image& image, int y, const PngOptions& options, std::uint8_t* out) {
    const bool plain = options.bits == 8 && !options.dither && !options.encoded;
    if (plain && image.channels == 3) {
        return encodeRowByTable(image.row(y), image.rowFloats(), out);
    }
    WriteLosses losses;
    const auto put = [&](std::uint32_t code) {
        if (options.bits == 16) *out++ = static_cast<std::uint8_t>(code >> 8);
        *out++ = static_cast<std::uint8_t>(code);
    };
    const float* p = image.row(y);
    for (int x = 0; x < image.width; ++x, p += image.channels) {
        float unpremultiply = 1, alpha = 1;
        if (image.channels == 4) {
            alpha = std::clamp(std::isnan(p[3]) ? 0.0F : p[3], 0.0F, 1.0F);
            unpremultiply = alpha > 0 ? 1 / alpha : 0;
        }
        const std::size_t above = losses.above;
        for (int c = 0; c < 3; ++c) {
            const float v = p[c] * unpremultiply;
            const double threshold = options.dither ? ditherThreshold(x, y) : 0.5;
            put(plain ? linearToSrgb8(v) : codeOf(v, options, threshold));
            count(losses, v);
        }
        losses.bright_pixels += losses.above > above;
        if (image.channels == 4) {
            put(static_cast<std::uint32_t>(alpha * static_cast<float>((1 << options.bits) - 1) +
                                           0.5F));
        }
    }
    return losses;
}

} // namespace

WriteLosses writePng(OutputFile& file, const Image& image, const PngOptions& options, int threads) {
    if (image.width < 1 || image.height < 1 || (image.channels != 3 && image.channels != 4) ||
        (options.bits != 8 && options.bits != 16)) {
        throw std::logic_error("writePng takes RGB or RGBA pixels and 8 or 16 bits");
    }
    std::vector<WriteLosses> losses(static_cast<std::size_t>(image.height));
    writeRows(file, image.width, image.height, image.channels, !options.encoded, options.bits,
              threads, [&](std::size_t y, std::uint8_t* out) {
                  losses[y] = encodeRow(image, static_cast<int>(y), options, out);
              });
    WriteLosses total;
    for (const WriteLosses& row : losses)
        total += row;
    return total;
}

} // namespace ibl
