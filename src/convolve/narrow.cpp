#include "convolve/narrow.h"

#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// 1 up to half of the degree (to 1e-6), 1.5e-3 at the degree.
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

NarrowPeaks makeNarrowPeaks(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe,
                            const NarrowLobe& narrow) {
    const int degree = static_cast<int>(narrow.k.size()) - 1;
    NarrowPeaks result{makePeakSum(peaks, width, height, lobe), {}, {}, 0, 0, narrow.area};
    for (std::size_t p = 0; p < peaks.size(); ++p) {
        // Gauss points: about pi a wave, and some.
        const double waves = result.sum.rectangles[p].size * degree / (2 * kPi);
        result.points.push_back(pixelPoints(width, height, peaks[p].column, peaks[p].row,
                                            5 + static_cast<int>(std::ceil(kPi * waves))));
    }
    // The taper's width in degrees, 0.05 B, makes the difference fall as exp(-(0.05 B t)^2 / 2).
    result.reach = std::min(kPi, 110.0 / degree);
    result.band_step = 1.0 / (16 * degree);
    const int count = static_cast<int>(result.reach / result.band_step) + 4;
    result.band.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        // sum over l of (2l + 1) / (4 pi) k_l P_l(cos t)
        const double x = std::cos(i * result.band_step);
        double previous = 0, current = 1, sum = 0;
        for (int l = 0; l <= degree; ++l) {
            sum += (2 * l + 1) / (4 * kPi) * narrow.k[static_cast<std::size_t>(l)] * current;
            const double next = ((2 * l + 1) * x * current - l * previous) / (l + 1);
            previous = current;
            current = next;
        }
        result.band[static_cast<std::size_t>(i)] = sum;
    }
    return result;
}

namespace {

/// The band-limited part of the lobe at the angle t from its axis, by cubic interpolation.
double bandValue(const NarrowPeaks& peaks, double t) {
    const double x = t / peaks.band_step;
    const std::size_t last = peaks.band.size() - 3;
    const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(x), 1, last);
    const double f = x - static_cast<double>(i);
    const double* p = &peaks.band[i - 1];
    return p[0] * -f * (f - 1) * (f - 2) / 6 + p[1] * (f + 1) * (f - 1) * (f - 2) / 2 -
           p[2] * (f + 1) * f * (f - 2) / 2 + p[3] * (f + 1) * f * (f - 1) / 6;
}

/// Mass of the band-limited part of the lobe over peak p's pixel.
double bandMass(const NarrowPeaks& peaks, std::size_t p, const V3d& x) {
    const PixelPoints& points = peaks.points[p];
    double mass = 0;
    for (std::size_t i = 0; i < points.weights.size(); ++i) {
        const double chord = (x - points.directions[i]).length();
        mass += points.weights[i] * bandValue(peaks, 2 * std::asin(std::min(1.0, 0.5 * chord)));
    }
    return mass;
}

} // namespace

void addNarrowPeaks(const NarrowPeaks& peaks, int width, int height, double texel,
                    const Footprint& footprint, const RowPoints& points,
                    const std::vector<double>& area_row, std::vector<double>& texels) {
    const PeakSum& sum = peaks.sum;
    const double spacing = footprint.scale * texel / std::sqrt(points.per_texel);
    const double inner_s = 2 * sum.width < spacing ? std::sin(0.25 * spacing) : 0;
    const double inner = inner_s > 0 ? 1 - sum.mass_beyond(inner_s * inner_s) : 0;
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        for (int c = 0; c < 3; ++c)
            texels[3 * t + c] += (inner - peaks.area) * area_row[3 * t + c];
        const std::size_t first = t * static_cast<std::size_t>(points.per_texel);
        for (std::size_t p = 0; p < sum.peaks.size(); ++p) {
            const double reach = peaks.reach + sum.rectangles[p].size + texel;
            const Axis centre = makeAxis(points.u[first], points.v[first]);
            if ((polarDirection(centre.theta, centre.psi) - peaks.points[p].directions[0])
                    .length() > reach)
                continue;
            const Peak& peak = sum.peaks[p];
            double mean = 0;
            for (std::size_t i = first; i < first + points.per_texel; ++i) {
                const double u = points.u[i], v = points.v[i];
                const Axis axis = makeAxis(u, v);
                const V3d x = polarDirection(axis.theta, axis.psi);
                const bool own = static_cast<int>(u * width) % width == peak.column &&
                                 std::min(static_cast<int>(v * height), height - 1) == peak.row;
                mean += points.share[i] *
                        (peakMass(sum, p, axis, x) - bandMass(peaks, p, x) - (own ? inner : 0));
            }
            for (int c = 0; c < 3; ++c)
                texels[3 * t + c] += mean * peak.excess[c];
        }
    }
}

} // namespace ibl
