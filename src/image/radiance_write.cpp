#include "image/radiance.h"

#include "core/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

constexpr float kLargest = 0x1.fep126F; // 255 * 2^119
constexpr int kShortestRun = 4;

/// The exponent byte e for which v >= 2^-128 has its mantissa v * 2^(136 - e) in [128, 256). A
/// normal float 1.f * 2^E holds E + 127, and e = E + 129.
int exponentByte(float v) {
    const int stored = static_cast<int>(std::bit_cast<std::uint32_t>(v) >> 23);
    return stored > 0 ? stored + 2 : v >= 0x1p-127F ? 2 : 1;
}

/// 2^n, n within double's normal range.
double powerOfTwo(int n) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52);
}

/// One pixel to mantissas and exponent. Rounding the largest channel up to 256 carries into the
/// exponent.
void encodePixel(const float* rgb, WriteLosses& losses, std::uint8_t out[4]) {
    float c[3];
    for (int k = 0; k < 3; ++k) {
        c[k] = rgb[k];
        if (std::isnan(c[k])) {
            ++losses.not_number;
            c[k] = 0;
        } else if (c[k] < 0) {
            ++losses.below;
            c[k] = 0;
        } else if (c[k] > kLargest) {
            ++losses.above;
            c[k] = kLargest;
        }
    }
    const float largest = std::max({c[0], c[1], c[2]});
    out[0] = out[1] = out[2] = out[3] = 0;
    // Below this even the least exponent leaves a mantissa under 128, and a pixel 1 1 1 n or
    // 2 2 n n would be taken for a run's mark.
    if (largest < 0x1p-128F) return;
    int e = exponentByte(largest);
    // Exact as a double for every e, and so is each product.
    double scale = powerOfTwo(136 - e);
    if (largest * scale + 0.5 >= 256) {
        ++e;
        scale /= 2;
    }
    for (int k = 0; k < 3; ++k)
        out[k] = static_cast<std::uint8_t>(c[k] * scale + 0.5);
    out[3] = static_cast<std::uint8_t>(e);
}

/// Runs of one component: 128 + n, value repeats a value n times; n <= 128 precedes n values.
void encodeRuns(const std::uint8_t* values, int length, std::vector<std::uint8_t>& out) {
    int done = 0;
    while (done < length) {
        // The next run worth its two bytes, and what lies before it.
        int run_begin = done, run_length = 0;
        while (run_begin < length) {
            run_length = 1;
            while (run_length < 127 && run_begin + run_length < length &&
                   values[run_begin + run_length] == values[run_begin]) {
                ++run_length;
            }
            if (run_length >= kShortestRun) break;
            run_begin += run_length;
            run_length = 0;
        }
        while (done < run_begin) {
            const int count = std::min(128, run_begin - done);
            out.push_back(static_cast<std::uint8_t>(count));
            out.insert(out.end(), values + done, values + done + count);
            done += count;
        }
        if (run_length > 0) {
            out.push_back(static_cast<std::uint8_t>(128 + run_length));
            out.push_back(values[done]);
            done += run_length;
        }
    }
}

/// Appends one scanline. `planes` is room for 4 * width bytes.
void encodeScanline(const Image& image, int y, std::vector<std::uint8_t>& planes,
                    WriteLosses& losses, std::vector<std::uint8_t>& out) {
    const int width = image.width;
    std::uint8_t pixel[4];
    if (width < 8 || width > 32767) {
        for (int x = 0; x < width; ++x) {
            encodePixel(image.at(x, y), losses, pixel);
            out.insert(out.end(), pixel, pixel + 4);
        }
        return;
    }
    for (int x = 0; x < width; ++x) {
        encodePixel(image.at(x, y), losses, pixel);
        for (int k = 0; k < 4; ++k)
            planes[static_cast<std::size_t>(k) * width + x] = pixel[k];
    }
    for (const int byte : {2, 2, width >> 8, width & 255}) {
        out.push_back(static_cast<std::uint8_t>(byte));
    }
    for (int k = 0; k < 4; ++k) {
        encodeRuns(planes.data() + static_cast<std::size_t>(k) * width, width, out);
    }
}

} // namespace

WriteLosses writeRadiance(OutputFile& file, const Image& image, int threads) {
    file.write("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) + " +X " +
               std::to_string(image.width) + "\n");
    constexpr std::size_t kRows = 32;
    const std::size_t strips = (static_cast<std::size_t>(image.height) + kRows - 1) / kRows;
    std::vector<std::vector<std::uint8_t>> encoded(strips);
    std::vector<WriteLosses> losses(strips);
    parallelForRuns(image.height, kRows, threads, [&](std::size_t first, std::size_t last) {
        const std::size_t strip = first / kRows;
        std::vector<std::uint8_t> planes(std::size_t{4} * image.width);
        for (std::size_t y = first; y < last; ++y) {
            encodeScanline(image, static_cast<int>(y), planes, losses[strip], encoded[strip]);
        }
    });
    WriteLosses total;
    for (std::size_t strip = 0; strip < strips; ++strip) {
        file.write(encoded[strip].data(), encoded[strip].size());
        total += losses[strip];
    }
    return total;
}

} // namespace ibl
