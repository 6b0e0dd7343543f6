#include "convolve/narrow.h"

#include "convolve/texel_mean.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>
#include <ranges>

namespace ibl {
namespace {

/// 1 up to 0.6 of the degree (to 1e-6), 1.5e-3 at the degree.
double taper(double l, int degree) {
    return 0.5 * std::erfc(14 * (l / degree - 0.85));
}

/// How much of a wave of degree l the mean over a square of that many radians keeps, at the most:
/// the envelope of sin(x) / x, x = l footprint / 2.
double footprintGain(double l, double footprint) {
    return std::min(1.0, 2 / (l * footprint));
}

/// Stretches of degrees: what is left out in them, but for the constant m, is weight (k - m)^2.
struct Stretch {
    double k;
    double weight;
};

std::vector<Stretch> stretches(const std::vector<double>& k, int degree, const Spectrum& spectrum,
                               double footprint) {
    std::vector<Stretch> all;
    for (int l = 1; l <= degree; ++l) {
        const double w = (1 - taper(l, degree)) * footprintGain(l, footprint);
        all.push_back(
            {k[static_cast<std::size_t>(l)], w * w * spectrum.power[static_cast<std::size_t>(l)]});
    }
    // S_l = beyond degree / l^2 has the energy `beyond` in all. Past the coefficients that are
    // known they go on to fall, about as exp(-decay l).
    const double last = static_cast<double>(k.size() - 1);
    const double decay = -std::log(std::max(std::abs(k.back()), 1e-300)) / last;
    constexpr double kRatio = 1.02;
    for (double l = degree + 1; l < 1e3 * degree; l *= kRatio) {
        const double w = footprintGain(l, footprint);
        const double value = l <= last ? k[static_cast<std::size_t>(l)] : std::exp(-decay * l);
        const double energy = spectrum.beyond * degree / l * (1 - 1 / kRatio);
        all.push_back({value, w * w * energy});
    }
    return all;
}

} // namespace

Spectrum continuedSpectrum(std::vector<double> power, double energy, int degree) {
    power.resize(std::min(power.size(), static_cast<std::size_t>(degree) + 1));
    double left = energy;
    for (const double s : power)
        left -= s;
    left = std::max(left, 1e-14 * energy); // the difference of nearly equal sums
    // Over l > L the terms left * (L + 1) / (l (l + 1)) sum to `left`, L the last degree measured.
    const std::size_t first = std::max<std::size_t>(power.size(), 1);
    power.resize(first, 0.0);
    for (std::size_t l = first; l <= static_cast<std::size_t>(degree); ++l) {
        const double product = static_cast<double>(l) * static_cast<double>(l + 1);
        power.push_back(left * static_cast<double>(first) / product);
    }
    return {power, left * static_cast<double>(first) / (degree + 1)};
}

NarrowLobe makeNarrowLobe(const std::vector<double>& k, int degree, const Spectrum& spectrum,
                          double footprint) {
    const std::vector<Stretch> left_out = stretches(k, degree, spectrum, footprint);
    double weight = 0, product = 0, sum = 0;
    for (const Stretch& s : left_out) {
        weight += s.weight;
        product += s.weight * s.k;
    }
    NarrowLobe narrow;
    narrow.area = weight > 0 ? std::clamp(product / weight, 0.0, 1.0) : 0;
    for (const Stretch& s : left_out)
        sum += s.weight * (s.k - narrow.area) * (s.k - narrow.area);
    narrow.error = std::sqrt(sum);
    for (int l = 0; l <= degree; ++l) {
        narrow.k.push_back((k[static_cast<std::size_t>(l)] - narrow.area) * taper(l, degree));
    }
    // The mean is exact.
    narrow.k[0] = 1 - narrow.area;
    return narrow;
}

// The mass of the band-limited part within t, by int P_l = (P_(l-1) - P_(l+1)) / (2l + 1), is
//
//     M(t) = k_0 (1 - cos t) / 2 + sum over l >= 1 of k_l (P_(l-1) - P_(l+1))(cos t) / 2.
NarrowPeaks makeNarrowPeaks(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe,
                            const NarrowLobe& narrow) {
    const int degree = static_cast<int>(narrow.k.size()) - 1;
    NarrowPeaks result{makePeakSum(peaks, width, height, lobe), narrow.area, 0, 0, {}, 0};
    if (peaks.empty()) return result;
    result.variation = 2.0 / degree;
    result.step = 1.0 / (16 * degree);
    // The taper's width in degrees, 0.05 B, makes the difference fall as exp(-(0.05 B t)^2 / 2).
    const int count = static_cast<int>(std::min(1.4, 110.0 / degree) / result.step) + 3;
    result.beyond.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double chord = i * result.step, x = 1 - 0.5 * chord * chord;
        double previous = 1, current = x, mass = narrow.k[0] * (1 - x) / 2;
        for (int l = 1; l <= degree; ++l) {
            const double next = ((2 * l + 1) * x * current - l * previous) / (l + 1);
            mass += 0.5 * narrow.k[static_cast<std::size_t>(l)] * (previous - next);
            previous = current;
            current = next;
        }
        result.beyond[static_cast<std::size_t>(i)] = narrow.k[0] - mass;
    }
    constexpr double kNoMass = 1e-7;
    int last = count - 3;
    const auto difference = [&](int i) {
        const double half_chord = 0.5 * i * result.step;
        return std::abs(result.beyond[static_cast<std::size_t>(i)] -
                        result.sum.mass_beyond(half_chord * half_chord));
    };
    while (last > 1 && difference(last) < kNoMass)
        --last;
    result.reach = last * result.step;
    return result;
}

namespace {

/// The band-limited part's mass beyond a chord, by cubic interpolation; it is even in the chord.
double bandBeyond(const NarrowPeaks& peaks, double chord) {
    const double x = chord / peaks.step;
    const std::size_t i = std::min(static_cast<std::size_t>(x), peaks.beyond.size() - 3);
    const double f = x - static_cast<double>(i);
    const double* p = &peaks.beyond[i];
    const double before = i == 0 ? p[1] : p[-1];
    return before * -f * (f - 1) * (f - 2) / 6 + p[0] * (f + 1) * (f - 1) * (f - 2) / 2 -
           p[1] * (f + 1) * f * (f - 2) / 2 + p[2] * (f + 1) * f * (f - 1) / 6;
}

/// Mean over a texel's points of a kernel's mass over a peak's pixel; Q and total as for
/// rectangleMass.
template <class Q>
double meanAtPoints(const Q& q, double total, const Disc& disc, const Rectangle& pixel,
                    const RowPoints& points, std::size_t texel) {
    const std::size_t first = texel * static_cast<std::size_t>(points.per_texel);
    double mean = 0;
    for (std::size_t i = first; i < first + points.per_texel; ++i) {
        const Axis axis = makeAxis(points.u[i], points.v[i]);
        mean += points.share[i] * rectangleMass(q, total, disc, axis, pixel);
    }
    return mean;
}

/// Whether the texel reaches so near to the pixel that the lobe may fall between its points,
/// `spacing` apart: at t from its axis it varies over t / 2 at least.
bool isNear(const std::array<V3d, 4>& corners, const PeakRectangle& r, double spacing) {
    const auto diagonal = [](const V3d& a, const V3d& b) { return (a - b).length(); };
    const double texel =
        std::max(diagonal(corners[0], corners[2]), diagonal(corners[1], corners[3]));
    const V3d centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const double distance = (centre - r.coarse.directions[0]).length();
    return distance < 0.5 * texel + 1.5 * r.size + 8 * spacing && distance + texel < 1.2;
}

} // namespace

void addNarrowPeaks(const NarrowPeaks& peaks, const MapRow& row, const Footprint& footprint,
                    const RowPoints& points, const std::vector<double>& area_row,
                    std::vector<double>& texels) {
    const PeakSum& sum = peaks.sum;
    const auto band = [&](double h) {
        const double chord = 2 * std::sqrt(h);
        return chord < peaks.reach ? -bandBeyond(peaks, chord) : -sum.mass_beyond(h);
    };
    const auto difference = [&](double h) { return -band(h) - sum.mass_beyond(h); };
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        for (int c = 0; c < 3; ++c)
            texels[3 * t + c] -= peaks.area * area_row[3 * t + c];
        const std::array<V3d, 4> corners =
            texelCorners(row.layout, row.width, row.height, points.column[t], row.y, 1);
        const double size = (corners[0] - corners[2]).length();
        const double spacing = footprint.scale * size / footprint.samples;
        for (std::size_t p = 0; p < sum.peaks.size(); ++p) {
            const PeakRectangle& r = sum.rectangles[p];
            const double far = peaks.reach + 2 * (r.size + size);
            if ((corners[0] - r.coarse.directions[0]).length() > far) continue;
            double mean;
            if (footprint.scale > 0 && isNear(corners, r, spacing)) {
                const std::array<V3d, 4> shrunk = texelCorners(
                    row.layout, row.width, row.height, points.column[t], row.y, footprint.scale);
                mean = texelMean(sum.mass_beyond, shrunk, r.edges) -
                       meanAtPoints(band, 1 - peaks.area, {0.5 * kPi, peaks.variation}, r.edges,
                                    points, t);
            } else {
                mean = meanAtPoints(difference, peaks.area, {peaks.reach, peaks.variation}, r.edges,
                                    points, t);
            }
            for (int c = 0; c < 3; ++c)
                texels[3 * t + c] += mean * sum.peaks[p].excess[c];
        }
    }
}

} // namespace ibl
