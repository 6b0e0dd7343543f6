#include "convolve/peak_sum.h"

#include "convolve/simd.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Gauss points, n to a pixel's edge.
struct PointRule {
    int n;
    /// Of the angle over which the lobe varies, the pixel's largest size for which they do: 2 x 2
    /// are off by (size / scale)^4 / 4320 of it, 4 x 4 by (size / scale)^8 / 1.8e10, and 8 x 8 with
    /// the lobe's poles at that distance by 2e-8.
    double largest;
    /// Largest error for what is 0 up to a place in the pixel and then rises by 1 to a pixel, as
    /// the lobe does from its horizon on.
    double kink;
};
constexpr std::array<PointRule, 3> kPointRules{
    {{2, 0.1, 0.0224}, {4, 0.5, 0.0092}, {8, 1.2, 0.0028}}};

/// Relative RMSE that the lobe's kink at its horizon may leave where points pass over it.
constexpr double kKink = 2e-7;

/// That RMSE, beside the peak's mean over the sphere, of points over a pixel of that size: the
/// error lies in a ring of the size about the horizon.
double kinkError(const RationalLobe& lobe, double norm, const PointRule& rule, double size) {
    const double slope = norm * lobe.factor * 4 / ((1 + lobe.a2) * (1 + lobe.a2));
    return 4 * kPi * rule.kink * slope * size * std::sqrt(0.5 * size);
}

PeakRectangle rectangleOf(const Peak& peak, const PeakSum& sum, int width, int height) {
    PeakRectangle r{};
    r.edges = {kPi * peak.row / height, kPi * (peak.row + 1) / height,
               2 * kPi * peak.column / width, 2 * kPi * (peak.column + 1) / width};
    r.size = std::max(kPi / height, 2 * kPi / width * std::sin(kPi * (peak.row + 0.5) / height));
    const double beyond = 0.5 * kPi + 2 * r.size;
    r.none = beyond < kPi ? std::cos(beyond) : -2;
    const auto rational = rationalLobe(sum.lobe);
    // Of a lobe that is no rational function the most points take as long as the edges.
    for (std::size_t i = 0; i < (rational ? 3 : 2); ++i) {
        const PointRule& rule = kPointRules[i];
        RangedPoints& points = r.points[i];
        points.points = pixelPoints(width, height, peak.column, peak.row, rule.n);
        if (!rational) continue;
        // lobeScaleAt grows from the axis on and falls towards the horizon, which must not cross
        // the pixel.
        const double scale = r.size / rule.largest;
        const double from = lobeScaleFrom(sum.lobe, sum.width, scale);
        const double to = 0.5 * kPi - std::max(scale, 1.6 * r.size);
        points.low = to > 0 ? std::cos(to) : 2;
        points.high = from < kPi ? std::cos(from) : -2;
        if (from == 0) points.high = 2; // cosines of rounded directions
        if (kinkError(*rational, sum.norm, rule, r.size) < kKink) points.low = -2;
    }
    return r;
}

/// acos to 7e-5, for choices (Abramowitz and Stegun 1964, 4.4.45).
double roughAngle(double cosine) {
    const double x = std::min(1.0, std::abs(cosine));
    const double angle =
        std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - 0.0187293 * x)));
    return cosine < 0 ? kPi - angle : angle;
}

double firstCosine(const PeakRectangle& r, const V3d& d) {
    const PixelPoints& p = r.points.front().points;
    return p.x[0] * d.x + p.y[0] * d.y + p.z[0] * d.z;
}

/// The lobe's normalised mass over peak p's pixel, seen from (u, v) along the polar direction d.
double peakMass(const PeakSum& sum, std::size_t p, double u, double v, const V3d& d) {
    const PeakRectangle& r = sum.rectangles[p];
    const double cosine = firstCosine(r, d);
    if (cosine < r.none) return 0;
    const double t = roughAngle(cosine), scale = lobeScaleAt(sum.lobe, sum.width, t);
    const std::size_t rule = r.size > kPointRules[0].largest * scale ? 1 : 0;
    if (r.size > kPointRules[rule].largest * scale) {
        const Axis axis = makeAxis(u, v);
        // Where a ring (Charlie) is dark, the whole mass times the turn about the axis would leave
        // its rounding: there by the mass within, which is none on the axis.
        const auto within = [&](double h) { return 1 - sum.mass_beyond(h); };
        if (t + 2 * r.size < sum.width) return rectangleMass(within, 0, sum.disc, axis, r.edges);
        const auto q = [&](double h) { return -sum.mass_beyond(h); };
        return rectangleMass(q, 1, sum.disc, axis, r.edges);
    }
    const PixelPoints& points = r.points[rule].points;
    double mass = 0;
    for (std::size_t i = 0; i < points.weight.size(); ++i) {
        const double c = points.x[i] * d.x + points.y[i] * d.y + points.z[i] * d.z;
        mass += points.weight[i] * lobeValue(sum.lobe, c);
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

/// Adds all peaks that points do for to the places from `begin` to `end`, a multiple of kLanes of
/// them, and tells the others.
IBL_MULTIVERSION
void addSmoothPeaks(const PeakSum& sum, const RationalLobe& lobe, const V3d* direction,
                    std::size_t begin, std::size_t end, double* values,
                    std::vector<CloserLook>& others) {
    const double factor = sum.norm * lobe.factor, half = 0.5 * (1 - lobe.a2), a2 = lobe.a2;
    for (std::size_t first = begin; first < end; first += kLanes) {
        const V3d* d = direction + first;
        const Lanes x{d[0].x, d[1].x, d[2].x, d[3].x};
        const Lanes y{d[0].y, d[1].y, d[2].y, d[3].y};
        const Lanes z{d[0].z, d[1].z, d[2].z, d[3].z};
        Lanes sums[3]{};
        for (std::size_t p = 0; p < sum.rectangles.size(); ++p) {
            const PeakRectangle& peak = sum.rectangles[p];
            const RangedPoints* ranged = peak.points.data();
            const PixelPoints& few = ranged->points;
            const Lanes c0 = few.x[0] * x + few.y[0] * y + few.z[0] * z;
            const auto none = c0 < peak.none;
            if (none[0] & none[1] & none[2] & none[3]) continue;
            const RangedPoints* const all = ranged + peak.points.size();
            for (; ranged != all; ++ranged) {
                const auto met = ((c0 >= ranged->low) & (c0 <= ranged->high)) | none;
                if (met[0] & met[1] & met[2] & met[3]) break;
            }
            if (ranged == all) {
                others.push_back({first, p});
                continue;
            }
            const PixelPoints& points = ranged->points;
            const double *px = points.x.data(), *py = points.y.data(), *pz = points.z.data();
            const double* weight = points.weight.data();
            Lanes mass{};
            for (std::size_t k = 0; k < points.weight.size(); ++k) {
                const Lanes c = px[k] * x + py[k] * y + pz[k] * z;
                const Lanes root = a2 + half * (1 - c);
                mass += weight[k] * (c > 0 ? c : Lanes{}) / (root * root);
            }
            mass *= factor;
            for (int k = 0; k < 3; ++k)
                sums[k] += sum.peaks[p].excess[k] * mass;
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
                lobe,
                LobeMassBeyond(lobe),
                lobeWidth(lobe),
                1 / lobeIntegral(lobe),
                {lobeReach(lobe), lobeVariation(lobe)}};
    for (const Peak& peak : peaks)
        sum.rectangles.push_back(rectangleOf(peak, sum, width, height));
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
            addSmoothPeaks(sum, *lobe, points.direction.data(), done,
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
