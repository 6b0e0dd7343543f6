#include "convolve/narrow.h"

#include "convolve/error_bound.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Farther than this from a peak its part varies little over a texel.
constexpr double kNearTexels = 6;

/// 1 at l = 0, a half at 3/4 of the degree, 2e-3 at the degree.
double taper(int l, int degree) {
    return 0.5 * std::erfc(8 * (static_cast<double>(l) / degree - 0.75));
}

/// How much of a wave of degree l the mean over a square of that many radians keeps, at the most:
/// the envelope of sin(x) / x, x = l texel / 2.
double footprintGain(int l, double texel) {
    return std::min(1.0, 2 / (l * texel));
}

} // namespace

NarrowLobe makeNarrowLobe(const Lobe& lobe, int degree) {
    const std::vector<double> k = zonalCoefficients(lobe, degree + 1);
    NarrowLobe narrow;
    narrow.area = k[static_cast<std::size_t>(3 * degree / 4)];
    for (int l = 0; l <= degree; ++l) {
        const double rest = k[static_cast<std::size_t>(l)] - narrow.area, h = taper(l, degree);
        narrow.k.push_back(rest * h);
        narrow.error.push_back(std::abs(rest) * (1 - h));
    }
    // Beyond the degree k_l goes on to fall, about as exp(-decay l).
    narrow.decay = -std::log(std::max(k.back(), 1e-300)) / degree;
    return narrow;
}

double narrowError(const NarrowLobe& lobe, const std::vector<double>& power, double energy,
                   double texel) {
    double sum = 0;
    const int degree = static_cast<int>(lobe.k.size()) - 1;
    for (int l = 1; l <= degree; ++l) {
        const double e = lobe.error[static_cast<std::size_t>(l)] * footprintGain(l, texel);
        sum += e * e * power[static_cast<std::size_t>(l)];
    }
    double beyond = 0;
    for (double l = degree; l < 1e3 * degree; l *= 1.1) {
        const double e = std::abs(std::exp(-lobe.decay * l) - lobe.area);
        beyond = std::max(beyond, e * footprintGain(static_cast<int>(l), texel));
    }
    sum += beyond * beyond * energyBeyond(power, energy).back();
    return std::sqrt(sum);
}

void addNarrowPeaks(const std::vector<Peak>& peaks, const Image& probe, const Lobe& lobe,
                    double texel, const Footprint& footprint, const RowPoints& points,
                    const std::vector<double>& area_row, std::vector<double>& texels) {
    const int w = probe.width, h = probe.height;
    std::vector<V3d> places;
    for (const Peak& peak : peaks)
        places.push_back(latlongDirection((peak.column + 0.5) / w, (peak.row + 0.5) / h));
    const double diameter = 2 * lobeWidth(lobe);
    const double spacing = footprint.scale * texel / std::sqrt(points.per_texel);
    const double inner_s = diameter < spacing ? std::sin(0.25 * spacing) : 0;
    const double inner = inner_s > 0 ? 1 - LobeMassBeyond(lobe)(inner_s * inner_s) : 0;
    const double near = std::cos(std::min(kPi, kNearTexels * texel + 2 * kPi / w + kPi / h));
    const auto insideOf = [&](const Peak& peak, double u, double v) {
        return static_cast<int>(u * w) % w == peak.column &&
               std::min(static_cast<int>(v * h), h - 1) == peak.row;
    };
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        const auto first = static_cast<std::ptrdiff_t>(t) * points.per_texel;
        std::vector<double> u(points.u.begin() + first,
                              points.u.begin() + first + points.per_texel);
        std::vector<double> v(points.v.begin() + first,
                              points.v.begin() + first + points.per_texel);
        std::vector<double> share(points.share.begin() + first,
                                  points.share.begin() + first + points.per_texel);
        const V3d centre = latlongDirection(u[u.size() / 2], v[v.size() / 2]);
        const bool is_near = std::any_of(places.begin(), places.end(),
                                         [&](const V3d& p) { return p.dot(centre) > near; });
        if (!is_near) {
            u = {u[u.size() / 2]};
            v = {v[v.size() / 2]};
            share = {1};
        }
        std::vector<double> values(3 * u.size(), 0.0);
        addPeaks(peaks, w, h, lobe, u, v, values.data());
        for (std::size_t i = 0; i < u.size(); ++i) {
            for (const Peak& peak : peaks) {
                const double own = is_near && insideOf(peak, u[i], v[i]) ? inner : 0;
                for (int c = 0; c < 3; ++c)
                    values[3 * i + c] -= own * peak.excess[c];
            }
            for (int c = 0; c < 3; ++c)
                texels[3 * t + c] += share[i] * values[3 * i + c];
        }
        for (int c = 0; c < 3; ++c)
            texels[3 * t + c] += inner * area_row[3 * t + c];
    }
}

} // namespace ibl
