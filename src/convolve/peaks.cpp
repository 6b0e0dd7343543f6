#include "convolve/peaks.h"

#include "convolve/edges.h"
#include "core/parallel.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr int kRowsPerTask = 16;

double magnitude(const float* pixel, double scale) {
    return scale * std::max({std::abs(double{pixel[0]}), std::abs(double{pixel[1]}),
                             std::abs(double{pixel[2]})});
}

/// Angle over which the lobe changes by its own size, t from its axis: as far as its horizon or its
/// poles in the complex plane. Charlie, (1 - cos t)^q cos t, has its singularity on the axis and
/// grows by q cot(t/2) dt.
double scaleAt(const Lobe& lobe, double width, double t) {
    const double to_horizon = std::abs(0.5 * kPi - t);
    double smooth = width;
    if (lobe.kernel == Kernel::ggx) smooth = std::max(width, 0.5 * t);
    if (lobe.kernel == Kernel::charlie)
        smooth = std::min(0.5 * t, 2 * lobe.parameter * lobe.parameter * std::tan(0.5 * t));
    return std::min(smooth, to_horizon);
}

void addPixel(ProbeStatistics& part, const Candidate& pixel) {
    const double w = pixel.solid_angle;
    for (int c = 0; c < 3; ++c) {
        const double value = pixel.value[c];
        part.absolute[c] += w * std::abs(value);
        part.energy += w * value * value;
        part.squares += w * value * w * value;
        part.negative = part.negative || value < 0;
    }
    const auto brighter = [](const Candidate& a, const Candidate& b) {
        return a.magnitude > b.magnitude;
    };
    std::vector<Candidate>& best = part.brightest; // a heap with the dimmest on top
    const bool full = best.size() > kMostPeaks;
    if (full && pixel.magnitude <= best.front().magnitude) return;
    if (full) {
        std::ranges::pop_heap(best, brighter);
        best.pop_back();
    }
    best.push_back(pixel);
    std::ranges::push_heap(best, brighter);
}

/// n x n points over a pixel, Gauss's in (psi, theta): in cos theta the pixels at the poles would
/// not be smooth.
PixelPoints pixelPoints(int width, int height, int column, int row, int n) {
    const GaussRule& rule = gaussRule(n);
    PixelPoints points;
    double total = 0;
    for (int b = 0; b < n; ++b) {
        const double theta = kPi * (row + 0.5 + 0.5 * rule.nodes[b]) / height;
        for (int a = 0; a < n; ++a) {
            const double psi = 2 * kPi * (column + 0.5 + 0.5 * rule.nodes[a]) / width;
            points.directions.push_back(polarDirection(theta, psi));
            points.weights.push_back(rule.weights[a] * rule.weights[b] * std::sin(theta));
            total += points.weights.back();
        }
    }
    for (double& w : points.weights)
        w *= latlongPixelSolidAngle(width, height, row) / total;
    return points;
}

PeakRectangle rectangleOf(const Peak& peak, int width, int height) {
    PeakRectangle r;
    r.edges = {kPi * peak.row / height, kPi * (peak.row + 1) / height,
               2 * kPi * peak.column / width, 2 * kPi * (peak.column + 1) / width};
    r.size = std::max(kPi / height, 2 * kPi / width * std::sin(kPi * (peak.row + 0.5) / height));
    r.coarse = pixelPoints(width, height, peak.column, peak.row, 2);
    r.fine = pixelPoints(width, height, peak.column, peak.row, 4);
    return r;
}

} // namespace

ProbeStatistics measureProbe(const Image& probe, double scale, int threads) {
    const std::size_t tasks = (probe.height + kRowsPerTask - 1) / kRowsPerTask;
    std::vector<ProbeStatistics> parts(tasks);
    parallelFor(tasks, threads, [&](std::size_t task) {
        const int first = static_cast<int>(task) * kRowsPerTask;
        for (int j = first; j < std::min(first + kRowsPerTask, probe.height); ++j) {
            const double w = latlongPixelSolidAngle(probe.width, probe.height, j);
            for (int i = 0; i < probe.width; ++i) {
                const float* p = probe.at(i, j);
                addPixel(
                    parts[task],
                    {i, j, magnitude(p, scale), w, {scale * p[0], scale * p[1], scale * p[2]}});
            }
        }
    });
    ProbeStatistics all;
    for (const ProbeStatistics& part : parts) {
        all.energy += part.energy;
        all.squares += part.squares;
        all.negative = all.negative || part.negative;
        for (int c = 0; c < 3; ++c)
            all.absolute[c] += part.absolute[c];
        all.brightest.insert(all.brightest.end(), part.brightest.begin(), part.brightest.end());
    }
    std::ranges::stable_sort(all.brightest, std::greater<>(), &Candidate::magnitude);
    if (all.brightest.size() > kMostPeaks + 1) all.brightest.resize(kMostPeaks + 1);
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

V3d polarDirection(double theta, double psi) {
    const double s = std::sin(theta);
    return {s * std::cos(psi), s * std::sin(psi), std::cos(theta)};
}

PeakSum makePeakSum(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe) {
    PeakSum sum{peaks,
                {},
                lobe,
                LobeMassBeyond(lobe),
                lobeWidth(lobe),
                1 / lobeIntegral(lobe),
                {lobeReach(lobe), lobeVariation(lobe)}};
    for (const Peak& peak : peaks)
        sum.rectangles.push_back(rectangleOf(peak, width, height));
    return sum;
}

// By Gauss points where the lobe is smooth over the pixel (2 x 2 are off by (size / scale)^4 / 4320
// of it, 4 x 4 by (size / scale)^8 / 1.8e10), else by the pixel's edges.
double peakMass(const PeakSum& sum, std::size_t p, const Axis& axis, const V3d& x) {
    const PeakRectangle& r = sum.rectangles[p];
    const double t = std::acos(std::clamp(x.dot(r.coarse.directions[0]), -1.0, 1.0));
    if (t > 0.5 * kPi + 2 * r.size) return 0;
    const double scale = scaleAt(sum.lobe, sum.width, t);
    if (r.size > 0.5 * scale) {
        const auto q = [&](double h) { return -sum.mass_beyond(h); };
        return rectangleMass(q, 1, sum.disc, axis, r.edges);
    }
    const PixelPoints& points = r.size > 0.1 * scale ? r.fine : r.coarse;
    double mass = 0;
    for (std::size_t i = 0; i < points.weights.size(); ++i) {
        mass += points.weights[i] * lobeValue(sum.lobe, x.dot(points.directions[i]));
    }
    return sum.norm * mass;
}

void addPeaks(const PeakSum& sum, const std::vector<double>& u, const std::vector<double>& v,
              double* values) {
    for (std::size_t i = 0; i < u.size(); ++i) {
        const Axis axis = makeAxis(u[i], v[i]);
        const V3d x = polarDirection(axis.theta, axis.psi);
        for (std::size_t p = 0; p < sum.peaks.size(); ++p) {
            const double mass = peakMass(sum, p, axis, x);
            for (int c = 0; c < 3; ++c)
                values[3 * i + c] += sum.peaks[p].excess[c] * mass;
        }
    }
}

Image peakImage(const std::vector<Peak>& peaks, int width, int height) {
    Image image(width, height);
    std::ranges::fill(image.pixels, 0.0f);
    for (const Peak& peak : peaks) {
        for (int c = 0; c < 3; ++c)
            image.at(peak.column, peak.row)[c] = static_cast<float>(peak.excess[c]);
    }
    return image;
}

} // namespace ibl
