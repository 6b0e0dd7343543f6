#include "convolve/peak_sum.h"

#include "convolve/simd.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

// Of Gauss points over a pixel of that size, where the lobe varies over `scale`, 2 x 2 are off by
// (size / scale)^4 / 4320 of it, 4 x 4 by (size / scale)^8 / 1.8e10.
constexpr double kCoarse = 0.1; ///< of the scale: up to that size by 2 x 2 points,
constexpr double kFine = 0.5;   ///< by 4 x 4, or else by the pixel's edges

/// Relative RMSE that the lobe's kink at its horizon may leave where points pass over it.
constexpr double kKink = 2e-7;

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

/// From this angle between a direction and a pixel's first point all of it is beyond the horizon.
double beyondHorizon(const PeakRectangle& r) {
    return 0.5 * kPi + 2 * r.size;
}

/// That RMSE, beside the peak's mean over the sphere, with 2 x 2 points over a pixel of that size:
/// a function that is 0 up to a place and then rises by `slope` is off by 0.0225 of the slope times
/// the size at most (by 2 points of Gauss's), in a ring of the size about the horizon.
double kinkError(const RationalLobe& lobe, double norm, double size) {
    const double slope = norm * lobe.factor * 4 / ((1 + lobe.a2) * (1 + lobe.a2));
    return 4 * kPi * 0.0225 * slope * size * std::sqrt(0.5 * size);
}

SmoothPeak smoothPeak(const Peak& peak, const PeakRectangle& r, const PeakSum& sum,
                      const RationalLobe& lobe) {
    SmoothPeak smooth{};
    for (int k = 0; k < 4; ++k) {
        const V3d& d = r.coarse.directions[k];
        smooth.x[k] = d.x;
        smooth.y[k] = d.y;
        smooth.z[k] = d.z;
        smooth.weight[k] = r.coarse.weights[k];
    }
    // lobeScaleAt grows from the axis on and falls towards the horizon.
    const double scale = r.size / kCoarse, to = 0.5 * kPi - scale;
    const double from = lobeScaleFrom(sum.lobe, sum.width, scale);
    smooth.low = to > 0 ? std::cos(to) : 2;
    smooth.high = from < to ? std::cos(from) : -2;
    if (from == 0) smooth.high = 2; // cosines of rounded directions
    smooth.none = beyondHorizon(r) < kPi ? std::cos(beyondHorizon(r)) : -2;
    if (kinkError(lobe, sum.norm, r.size) < kKink) smooth.low = -2;
    std::ranges::copy(peak.excess, smooth.excess);
    return smooth;
}

/// acos to 7e-5, for choices (Abramowitz and Stegun 1964, 4.4.45).
double roughAngle(double cosine) {
    const double x = std::min(1.0, std::abs(cosine));
    const double angle =
        std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - 0.0187293 * x)));
    return cosine < 0 ? kPi - angle : angle;
}

/// The lobe's normalised mass over peak p's pixel, seen from (u, v) along the polar direction x.
double peakMass(const PeakSum& sum, std::size_t p, double u, double v, const V3d& x) {
    const PeakRectangle& r = sum.rectangles[p];
    const double t = roughAngle(x.dot(r.coarse.directions[0]));
    if (t > beyondHorizon(r)) return 0;
    const double scale = lobeScaleAt(sum.lobe, sum.width, t);
    if (r.size > kFine * scale) {
        const Axis axis = makeAxis(u, v);
        // Where a ring (Charlie) is dark, the whole mass times the turn about the axis would leave
        // its rounding: there by the mass within, which is none on the axis.
        const auto within = [&](double h) { return 1 - sum.mass_beyond(h); };
        if (t + 2 * r.size < sum.width) return rectangleMass(within, 0, sum.disc, axis, r.edges);
        const auto q = [&](double h) { return -sum.mass_beyond(h); };
        return rectangleMass(q, 1, sum.disc, axis, r.edges);
    }
    const PixelPoints& points = r.size > kCoarse * scale ? r.fine : r.coarse;
    double mass = 0;
    for (std::size_t i = 0; i < points.weights.size(); ++i) {
        mass += points.weights[i] * lobeValue(sum.lobe, x.dot(points.directions[i]));
    }
    return sum.norm * mass;
}

void addPeak(const PeakSum& sum, std::size_t p, const RowPoints& points, std::size_t i,
             double* values) {
    const double mass = peakMass(sum, p, points.u[i], points.v[i], points.direction[i]);
    for (int c = 0; c < 3; ++c)
        values[3 * i + c] += sum.peaks[p].excess[c] * mass;
}

/// A peak that has to be looked at closer, from kLanes points of which `first` is the first.
struct CloserLook {
    std::size_t first;
    std::size_t peak;
};

/// Adds all peaks that 2 x 2 points do for to the points from `begin` to `end`, a multiple of
/// kLanes of them, and tells the others.
IBL_MULTIVERSION
void addSmoothPeaks(const std::vector<SmoothPeak>& peaks, const RationalLobe& lobe, double norm,
                    const V3d* direction, std::size_t begin, std::size_t end, double* values,
                    std::vector<CloserLook>& others) {
    const double factor = norm * lobe.factor, half = 0.5 * (1 - lobe.a2), a2 = lobe.a2;
    for (std::size_t first = begin; first < end; first += kLanes) {
        const V3d* d = direction + first;
        const Lanes x{d[0].x, d[1].x, d[2].x, d[3].x};
        const Lanes y{d[0].y, d[1].y, d[2].y, d[3].y};
        const Lanes z{d[0].z, d[1].z, d[2].z, d[3].z};
        Lanes sums[3]{};
        for (std::size_t p = 0; p < peaks.size(); ++p) {
            const SmoothPeak& peak = peaks[p];
            const Lanes c0 = peak.x[0] * x + peak.y[0] * y + peak.z[0] * z;
            const auto none = c0 < peak.none;
            const auto met = ((c0 >= peak.low) & (c0 <= peak.high)) | none;
            if (!(met[0] & met[1] & met[2] & met[3])) {
                others.push_back({first, p});
                continue;
            }
            if (none[0] & none[1] & none[2] & none[3]) continue;
            Lanes mass{};
            for (int k = 0; k < 4; ++k) {
                const Lanes c = peak.x[k] * x + peak.y[k] * y + peak.z[k] * z;
                const Lanes root = a2 + half * (1 - c);
                mass += peak.weight[k] * (c > 0 ? c : Lanes{}) / (root * root);
            }
            mass *= factor;
            for (int k = 0; k < 3; ++k)
                sums[k] += peak.excess[k] * mass;
        }
        for (int lane = 0; lane < kLanes; ++lane) {
            for (int c = 0; c < 3; ++c)
                values[3 * (first + lane) + c] += sums[c][lane];
        }
    }
}

} // namespace

PeakSum makePeakSum(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe) {
    PeakSum sum{peaks,
                {},
                {},
                lobe,
                LobeMassBeyond(lobe),
                lobeWidth(lobe),
                1 / lobeIntegral(lobe),
                {lobeReach(lobe), lobeVariation(lobe)}};
    const auto rational = rationalLobe(lobe);
    for (const Peak& peak : peaks) {
        sum.rectangles.push_back(rectangleOf(peak, width, height));
        if (rational) sum.smooth.push_back(smoothPeak(peak, sum.rectangles.back(), sum, *rational));
    }
    return sum;
}

void addPeaks(const PeakSum& sum, const RowPoints& points, double* values) {
    const std::size_t count = points.u.size();
    std::size_t done = 0;
    if (const auto lobe = rationalLobe(sum.lobe)) {
        constexpr std::size_t kAtOnce = 64 * kLanes; // all peaks may need a closer look
        const std::size_t whole = count / kLanes * kLanes;
        std::vector<CloserLook> others;
        for (; done < whole; done = std::min(done + kAtOnce, whole)) {
            others.clear();
            addSmoothPeaks(sum.smooth, *lobe, sum.norm, points.direction.data(), done,
                           std::min(done + kAtOnce, whole), values, others);
            for (const CloserLook& other : others) {
                for (int lane = 0; lane < kLanes; ++lane)
                    addPeak(sum, other.peak, points, other.first + lane, values);
            }
        }
    }
    for (std::size_t i = done; i < count; ++i) {
        for (std::size_t p = 0; p < sum.peaks.size(); ++p)
            addPeak(sum, p, points, i, values);
    }
}

} // namespace ibl
