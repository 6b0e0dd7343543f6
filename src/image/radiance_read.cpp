#include "image/radiance.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/source.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <vector>

namespace ibl {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// How the stored scanlines lie in the picture: scanline k runs along an edge, pixel i of it is at
/// origin + k * line_step + i * pixel_step, counted in pixels.
struct Orientation {
    int width = 0;
    int height = 0;
    int lines = 0;
    int line_length = 0;
    std::ptrdiff_t origin = 0;
    std::ptrdiff_t line_step = 0;
    std::ptrdiff_t pixel_step = 0;
};

struct Header {
    double exposure = 1;
    Imath::V3d colour_correction{1, 1, 1};
    Orientation orientation;
    std::vector<std::string> notes;
    std::size_t size = 0; ///< bytes up to the first scanline
};

std::string_view nextToken(std::string_view& text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    const std::size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    const std::string_view token = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return token;
}

/// A number that uses up the whole token, in any locale; NaN if there is none.
double number(std::string_view token) {
    double value = 0;
    if (token.starts_with('+')) token.remove_prefix(1);
    const auto parsed = std::from_chars(token.data(), token.data() + token.size(), value);
    return parsed.ec == std::errc() && parsed.ptr == token.data() + token.size() ? value : NAN;
}

/// A factor that pixels can be divided by.
double factor(std::string_view token, std::string_view variable, const std::string& name) {
    const double value = number(token);
    if (!(value > 0) || !std::isfinite(value)) {
        throw inputError(name, std::string(variable) + " in its header is not a positive number; "
                                                       "mend the header");
    }
    return value;
}

void readVariable(std::string_view line, const std::string& name, Header& header) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) return; // a command line that made the picture
    const std::string_view variable = line.substr(0, equals);
    std::string_view value = line.substr(equals + 1);
    if (variable == "FORMAT") {
        const std::string_view format = nextToken(value);
        if (format == "32-bit_rle_xyze") {
            throw inputError(name, "holds XYZ colours (32-bit_rle_xyze); convert it to RGB with "
                                   "Radiance's ra_xyze -r first");
        }
        if (format != "32-bit_rle_rgbe") {
            throw inputError(name, "is in the unknown Radiance format '" + std::string(format) +
                                       "'; give 32-bit_rle_rgbe");
        }
    } else if (variable == "EXPOSURE") {
        header.exposure *= factor(nextToken(value), variable, name);
    } else if (variable == "COLORCORR") {
        for (int c = 0; c < 3; ++c) {
            header.colour_correction[c] *= factor(nextToken(value), variable, name);
        }
    } else if (variable == "PRIMARIES") {
        constexpr std::array<double, 8> kRec709 = {.64, .33, .30, .60, .15, .06, .3127, .3290};
        double farthest = 0;
        for (const double expected : kRec709) {
            farthest = std::fmax(farthest, std::abs(number(nextToken(value)) - expected));
        }
        if (farthest > 0.002) {
            header.notes.push_back(
                "its PRIMARIES are not Rec. 709's; colours are read as they are");
        }
    }
}

/// "-Y 128 +X 256" and its seven relatives: the first axis is the one from scanline to scanline, a
/// minus means against the axis; +Y is up, +X to the right.
Orientation readOrientation(std::string_view line, const std::string& name) {
    const Error malformed = inputError(
        name, "its size line ('-Y height +X width') is missing or malformed; the file is damaged");
    std::array<std::string_view, 2> axes;
    std::array<std::int64_t, 2> sizes{};
    for (int k = 0; k < 2; ++k) {
        axes[k] = nextToken(line);
        const double size = number(nextToken(line));
        if (!(std::abs(size) <= 1e9) || size != std::floor(size)) throw malformed;
        sizes[k] = static_cast<std::int64_t>(size);
    }
    const auto valid = [&](int k, char axis) {
        return axes[k].size() == 2 && (axes[k][0] == '+' || axes[k][0] == '-') &&
               axes[k][1] == axis;
    };
    const bool rows = valid(0, 'Y') && valid(1, 'X');
    if (!(rows || (valid(0, 'X') && valid(1, 'Y'))) || !nextToken(line).empty()) throw malformed;
    const int x = rows ? 1 : 0, y = rows ? 0 : 1;
    checkSize(name, sizes[x], sizes[y]);

    Orientation o;
    o.width = static_cast<int>(sizes[x]);
    o.height = static_cast<int>(sizes[y]);
    o.lines = static_cast<int>(sizes[0]);
    o.line_length = static_cast<int>(sizes[1]);
    const bool right = axes[x][0] == '+', down = axes[y][0] == '-';
    const std::ptrdiff_t x_step = right ? 1 : -1, y_step = down ? o.width : -o.width;
    o.origin = (right ? 0 : o.width - 1) + (down ? 0 : std::ptrdiff_t{o.height - 1} * o.width);
    o.line_step = rows ? y_step : x_step;
    o.pixel_step = rows ? x_step : y_step;
    return o;
}

Header readHeader(Bytes bytes, const std::string& name) {
    Header header;
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::size_t at = 0;
    const auto nextLine = [&] {
        const std::size_t end = text.find('\n', at);
        if (end == std::string_view::npos) {
            throw inputError(name, "ends within its header; the file is truncated");
        }
        std::string_view line = text.substr(at, end - at);
        at = end + 1;
        if (line.ends_with('\r')) line.remove_suffix(1);
        return line;
    };
    nextLine(); // "#?RADIANCE"
    for (std::string_view line = nextLine(); !line.empty(); line = nextLine()) {
        if (!line.starts_with('#')) readVariable(line, name, header);
    }
    header.orientation = readOrientation(nextLine(), name);
    header.size = at;
    return header;
}

/// Whether a scanline is run-length coded component by component.
bool isNewRunLength(Bytes in, int length) {
    return length >= 8 && length <= 32767 && in.size() >= 4 && in[0] == 2 && in[1] == 2 &&
           in[2] < 128;
}

/// Walks one scanline and returns how many bytes it takes, 0 if it is damaged or cut off. With
/// `out` (4 * length bytes: all R, all G, all B, all exponents) decodes it as well.
std::size_t newRunLength(Bytes in, int length, std::uint8_t* out) {
    if (in[2] * 256 + in[3] != length) return 0;
    std::size_t at = 4;
    for (int component = 0; component < 4; ++component) {
        int done = 0;
        while (done < length) {
            if (at + 2 > in.size()) return 0;
            const int code = in[at];
            const int count = code > 128 ? code - 128 : code;
            if (count == 0 || count > length - done) return 0;
            if (code > 128) {
                if (out) std::fill_n(out + done, count, in[at + 1]);
                at += 2;
            } else {
                if (at + 1 + count > in.size()) return 0;
                if (out) std::copy_n(in.data() + at + 1, count, out + done);
                at += 1 + static_cast<std::size_t>(count);
            }
            done += count;
        }
        if (out) out += length;
    }
    return at;
}

/// The same for a flat scanline or one with the old runs: a pixel 1 1 1 n repeats the one before n
/// times, further such pixels directly after it count as its higher digits to the base 256.
std::size_t oldRunLength(Bytes in, int length, std::uint8_t* out) {
    std::size_t at = 0;
    int done = 0, shift = 0;
    while (done < length) {
        if (at + 4 > in.size()) return 0;
        const std::uint8_t* p = in.data() + at;
        at += 4;
        if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
            const std::int64_t count = shift < 24 ? std::int64_t{p[3]} << shift : 0;
            // Zeros would let a run's marks go on for ever without a pixel.
            if (done == 0 || count == 0 || count > length - done) return 0;
            if (out) {
                for (int c = 0; c < 4; ++c) {
                    std::uint8_t* plane = out + std::ptrdiff_t{c} * length;
                    std::fill_n(plane + done, count, plane[done - 1]);
                }
            }
            done += static_cast<int>(count);
            shift += 8;
        } else {
            if (out) {
                for (int c = 0; c < 4; ++c)
                    out[std::ptrdiff_t{c} * length + done] = p[c];
            }
            ++done;
            shift = 0;
        }
    }
    return at;
}

std::size_t scanline(Bytes in, int length, std::uint8_t* out) {
    return isNewRunLength(in, length) ? newRunLength(in, length, out)
                                      : oldRunLength(in, length, out);
}

/// Where each scanline begins, and the end. Walking them all first proves the file whole before
/// memory for its pixels is taken, and lets the decoding go in parallel.
std::vector<std::size_t> findScanlines(Bytes bytes, const Header& header, const std::string& name) {
    const Orientation& o = header.orientation;
    std::vector<std::size_t> begins;
    std::size_t at = header.size;
    for (int k = 0; k < o.lines; ++k) {
        begins.push_back(at);
        const Bytes rest = bytes.subspan(at);
        const std::size_t size = scanline(rest, o.line_length, nullptr);
        if (size == 0) {
            throw inputError(name, "scanline " + std::to_string(k) + " of " +
                                       std::to_string(o.lines) +
                                       " is damaged or cut off; copy or export the file again");
        }
        at += size;
    }
    begins.push_back(at);
    return begins;
}

} // namespace

ImageFile readRadiance(std::span<const std::uint8_t> bytes, const std::string& name, int threads) {
    Header header = readHeader(bytes, name);
    const Orientation& o = header.orientation;
    const std::vector<std::size_t> begins = findScanlines(bytes, header, name);

    // 2^(e - 136) over the exposure, for each exponent and channel. Powers of two times eight bits
    // are exact in float, denormals included.
    std::vector<std::array<float, 3>> scale(256);
    for (int e = 1; e < 256; ++e) {
        for (int c = 0; c < 3; ++c) {
            scale[e][c] = static_cast<float>(std::ldexp(1.0, e - 136) / header.exposure /
                                             header.colour_correction[c]);
        }
    }

    ImageFile file;
    file.image = Image(o.width, o.height, 3);
    parallelForRuns(o.lines, 32, threads, [&](std::size_t first, std::size_t last) {
        std::vector<std::uint8_t> planes(std::size_t{4} * o.line_length);
        const std::uint8_t* r = planes.data();
        const std::uint8_t* g = r + o.line_length;
        const std::uint8_t* b = g + o.line_length;
        const std::uint8_t* e = b + o.line_length;
        for (std::size_t k = first; k < last; ++k) {
            scanline(bytes.subspan(begins[k], begins[k + 1] - begins[k]), o.line_length,
                     planes.data());
            float* pixels = file.image.pixels.data();
            std::ptrdiff_t at = 3 * (o.origin + static_cast<std::ptrdiff_t>(k) * o.line_step);
            for (int i = 0; i < o.line_length; ++i, at += 3 * o.pixel_step) {
                const std::array<float, 3>& s = scale[e[i]];
                pixels[at] = static_cast<float>(r[i]) * s[0];
                pixels[at + 1] = static_cast<float>(g[i]) * s[1];
                pixels[at + 2] = static_cast<float>(b[i]) * s[2];
            }
        }
    });

    file.format = "radiance";
    file.pixel_type = "rgbe";
    const bool runs = begins.back() - header.size !=
                      std::size_t{4} * static_cast<std::size_t>(o.width) * o.height;
    file.compression = runs ? "rle" : "none";
    file.exposure = header.exposure;
    file.colour_correction = header.colour_correction;
    file.notes = std::move(header.notes);
    if (file.exposure != 1 || file.colour_correction != Imath::V3d(1)) {
        char text[128];
        std::snprintf(text, sizeof text, "EXPOSURE %g and COLORCORR %g %g %g are divided out",
                      file.exposure, file.colour_correction.x, file.colour_correction.y,
                      file.colour_correction.z);
        file.notes.emplace_back(text);
    }
    return file;
}

} // namespace ibl
