#include "convolve/peaks.h"

#include "convolve/gauss.h"
#include "convolve/probe_scale.h"
#include "core/parallel.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

/// Pixels whose greatest magnitude is kept.
constexpr int kBlock = 16;

/// Sums over a row's values.
struct RowSums {
    double absolute[3] = {0, 0, 0};
    double squares = 0;
    bool negative = false;
};

/// Twelve values side by side, so that the compiler can use vectors. Doubles hold the squares of
/// all floats, the least and the largest.
RowSums sumRow(const float* values, int count) {
    constexpr int kValues = 12;
    std::array<double, kValues> absolute{}, squares{};
    std::array<float, kValues> least{};
    const auto take = [&](const float* part, int size) {
        for (int k = 0; k < size; ++k) {
            const double v = part[k];
            absolute[k] += std::abs(v);
            squares[k] += v * v;
            least[k] = part[k] < least[k] ? part[k] : least[k];
        }
    };
    int i = 0;
    for (; i + kValues <= count; i += kValues)
        take(values + i, kValues);
    take(values + i, count - i);
    RowSums sums;
    for (int k = 0; k < kValues; ++k) {
        sums.absolute[k % 3] += absolute[k];
        sums.squares += squares[k];
        sums.negative = sums.negative || least[k] < 0;
    }
    return sums;
}

/// The greatest magnitude of a run of values, unscaled.
float greatest(const float* values, std::size_t count) {
    float most = 0;
    for (std::size_t i = 0; i < count; ++i)
        most = std::max(most, std::abs(values[i]));
    return most;
}

/// The kMostPeaks + 1 brightest pixels, or all, from the greatest magnitude of every kBlock pixels
/// of every row. No more blocks than that hold a pixel above the least of as many greatest blocks,
/// so that few pixels are looked at; of those equal to it the first ones are taken.
std::vector<Candidate> brightestPixels(const Image& probe, double scale,
                                       const std::vector<float>& blocks) {
    constexpr std::size_t kMost = kMostPeaks + 1;
    float threshold = -1;
    if (blocks.size() > kMost) {
        std::vector<float> sorted = blocks;
        std::ranges::nth_element(sorted, sorted.begin() + kMost - 1, std::greater<>());
        threshold = sorted[kMost - 1];
    }
    const std::size_t blocks_a_row = blocks.size() / static_cast<std::size_t>(probe.height);
    std::vector<Candidate> brightest;
    std::size_t equal = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (blocks[b] < threshold || (blocks[b] == threshold && equal >= kMost)) continue;
        const int j = static_cast<int>(b / blocks_a_row);
        const int first = static_cast<int>(b % blocks_a_row) * kBlock;
        for (int i = first; i < std::min(first + kBlock, probe.width); ++i) {
            const float* p = probe.at(i, j);
            const float most = greatest(p, 3);
            if (most < threshold || (most == threshold && equal >= kMost)) continue;
            equal += most == threshold;
            brightest.push_back({i,
                                 j,
                                 scale * most,
                                 latlongPixelSolidAngle(probe.width, probe.height, j),
                                 {scale * p[0], scale * p[1], scale * p[2]}});
        }
    }
    std::ranges::stable_sort(brightest, std::greater<>(), &Candidate::magnitude);
    if (brightest.size() > kMost) brightest.resize(kMost);
    return brightest;
}

} // namespace

ProbeStatistics measureProbe(const Image& probe, int threads) {
    const auto rows = static_cast<std::size_t>(probe.height);
    const std::size_t blocks_a_row = (static_cast<std::size_t>(probe.width) + kBlock - 1) / kBlock;
    std::vector<RowSums> sums(rows);
    std::vector<float> blocks(rows * blocks_a_row);
    parallelFor(rows, threads, [&](std::size_t j) {
        const float* row = probe.row(static_cast<int>(j));
        sums[j] = sumRow(row, 3 * probe.width);
        for (std::size_t b = 0; b < blocks_a_row; ++b) {
            const std::size_t first = 3 * kBlock * b;
            const std::size_t count = std::min<std::size_t>(3 * kBlock, probe.rowFloats() - first);
            blocks[j * blocks_a_row + b] = greatest(row + first, count);
        }
    });
    ProbeStatistics all;
    all.scale = scaleFor(*std::ranges::max_element(blocks));
    const double square = all.scale * all.scale;
    for (std::size_t j = 0; j < rows; ++j) {
        if (!std::isfinite(sums[j].squares)) throw notFinite();
        const double w = latlongPixelSolidAngle(probe.width, probe.height, static_cast<int>(j));
        all.energy += w * square * sums[j].squares;
        all.squares += w * w * square * sums[j].squares;
        all.negative = all.negative || sums[j].negative;
        for (int c = 0; c < 3; ++c)
            all.absolute[c] += w * all.scale * sums[j].absolute[c];
    }
    all.brightest = brightestPixels(probe, all.scale, blocks);
    return all;
}

double peakThreshold(const ProbeStatistics& statistics, int count) {
    const std::size_t n = static_cast<std::size_t>(count);
    return n < statistics.brightest.size() ? statistics.brightest[n].magnitude : 0;
}

double clampedEnergy(const ProbeStatistics& statistics, double threshold) {
    double taken = 0;
    for (const Candidate& pixel : statistics.brightest) {
        for (const double value : pixel.value) {
            const double rest = std::min(std::abs(value), threshold);
            taken += pixel.solid_angle * (value * value - rest * rest);
        }
    }
    return std::max(0.0, statistics.energy - taken);
}

std::vector<Peak> splitPeaks(const ProbeStatistics& statistics, double threshold) {
    std::vector<Peak> peaks;
    for (const Candidate& pixel : statistics.brightest) {
        if (pixel.magnitude <= threshold) break;
        Peak peak{pixel.column, pixel.row, {}};
        for (int c = 0; c < 3; ++c) {
            peak.excess[c] = pixel.value[c] - std::clamp(pixel.value[c], -threshold, threshold);
        }
        peaks.push_back(peak);
    }
    return peaks;
}

PixelPoints pixelPoints(int width, int height, int column, int row, int n) {
    const GaussRule& rule = gaussRule(n);
    PixelPoints points{};
    std::vector<V2d> azimuths;
    for (const double node : rule.nodes) {
        const double psi = 2 * kPi * (column + 0.5 + 0.5 * node) / width;
        azimuths.emplace_back(std::cos(psi), std::sin(psi));
    }
    double total = 0;
    for (int b = 0; b < n; ++b) {
        const double theta = kPi * (row + 0.5 + 0.5 * rule.nodes[b]) / height;
        const double sine = std::sin(theta), cosine = std::cos(theta);
        for (int a = 0; a < n; ++a) {
            points.x.push_back(sine * azimuths[a].x);
            points.y.push_back(sine * azimuths[a].y);
            points.z.push_back(cosine);
            points.weight.push_back(rule.weights[a] * rule.weights[b] * sine);
            total += points.weight.back();
        }
    }
    for (double& w : points.weight)
        w *= latlongPixelSolidAngle(width, height, row) / total;
    return points;
}

V3d polarDirection(double theta, double psi) {
    const double s = std::sin(theta);
    return {s * std::cos(psi), s * std::sin(psi), std::cos(theta)};
}

} // namespace ibl
