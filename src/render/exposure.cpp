#include "render/exposure.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ibl {
namespace {

struct RowSums {
    PictureCensus census;
    double logs = 0;
    double weight = 0;
};

double luminance(double r, double g, double b) {
    const double value = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    const double largest = std::numeric_limits<float>::max();
    return value > 0 ? std::min(value, largest) : 0; // NaN: 0
}

// The sum of logarithms is the logarithm of a product. Seven factors from 1e-30 to 3.5e38 stay
// within double's range, at an error of 1e-15 for them all.
constexpr int kFactors = 7;

void addRow(RowSums& part, const float* p, int width, int channels, double delta) {
    double product = 1;
    int factors = 0;
    for (int x = 0; x < width; ++x, p += channels) {
        // A difference of a value with itself is 0, unless it is no number or infinite.
        const float same = (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
        if (!(same == 0)) {
            const bool nan = std::isnan(p[0]) || std::isnan(p[1]) || std::isnan(p[2]);
            ++(nan ? part.census.nan : part.census.infinite);
        } else {
            part.census.negative += p[0] < 0 || p[1] < 0 || p[2] < 0;
        }
        const double value = luminance(p[0], p[1], p[2]);
        if (channels == 4) {
            double alpha = p[3] > 0 ? std::min(p[3], 1.0F) : 0;
            if (value == 0 && alpha < 1) alpha = 0; // a shadow on what is not in the picture
            if (alpha > 0) part.logs += alpha * std::log(delta + value / alpha);
            part.weight += alpha;
            continue;
        }
        product *= delta + value;
        if (++factors == kFactors) {
            part.logs += std::log(product);
            product = 1;
            factors = 0;
        }
    }
    if (channels == 3) {
        part.logs += std::log(product);
        part.weight += width;
    }
}

} // namespace

PictureCensus takePictureCensus(const Image& image, double delta, int threads) {
    constexpr std::size_t kRows = 16;
    const auto rows = static_cast<std::size_t>(image.height);
    std::vector<RowSums> parts((rows + kRows - 1) / kRows);
    parallelForRuns(rows, kRows, threads, [&](std::size_t begin, std::size_t end) {
        RowSums part;
        for (std::size_t y = begin; y < end; ++y) {
            addRow(part, image.row(static_cast<int>(y)), image.width, image.channels, delta);
        }
        parts[begin / kRows] = part;
    });
    RowSums total;
    for (const RowSums& part : parts) {
        total.census.nan += part.census.nan;
        total.census.infinite += part.census.infinite;
        total.census.negative += part.census.negative;
        total.logs += part.logs;
        total.weight += part.weight;
    }
    total.census.log_average = total.weight > 0 ? std::exp(total.logs / total.weight) : delta;
    return total.census;
}

double adapted(double before, double now, double half_life) {
    const double kept = half_life > 0 ? std::exp2(-1 / half_life) : 0;
    return now * std::pow(before / now, kept);
}

} // namespace ibl
