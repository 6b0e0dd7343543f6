#include "convolve/texel_mean.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

/// Directions of displacement; their mean is exact for waves of fewer around.
constexpr int kDirections = 20;
/// Displacements to the smaller of texel and pixel.
constexpr int kSteps = 12;
/// Growth of the steps beyond that.
constexpr double kGrowth = 1.15;

double cross(const V2d& a, const V2d& b) {
    return a.x * b.y - a.y * b.x;
}

double areaOf(const std::vector<V2d>& polygon) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    return 0.5 * sum;
}

/// Counter-clockwise.
std::vector<V2d> oriented(const Quad& quad) {
    std::vector<V2d> polygon(quad.begin(), quad.end());
    if (areaOf(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
    return polygon;
}

/// Area of the part of a convex polygon that lies within another, both counter-clockwise
/// (Sutherland and Hodgman 1974).
double commonArea(std::vector<V2d> polygon, const std::vector<V2d>& window) {
    std::vector<V2d> cut;
    for (std::size_t e = 0; e < window.size() && !polygon.empty(); ++e) {
        const V2d from = window[e], along = window[(e + 1) % window.size()] - from;
        cut.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const V2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
            const double side_a = cross(along, a - from), side_b = cross(along, b - from);
            if (side_a >= 0) cut.push_back(a);
            if ((side_a > 0 && side_b < 0) || (side_a < 0 && side_b > 0))
                cut.push_back(a + (b - a) * (side_a / (side_a - side_b)));
        }
        std::swap(polygon, cut);
    }
    return polygon.size() < 3 ? 0 : areaOf(polygon);
}

struct Extent {
    V2d centre;
    double radius;
};

Extent extentOf(const std::vector<V2d>& polygon) {
    Extent extent{{0, 0}, 0};
    for (const V2d& p : polygon)
        extent.centre += p / static_cast<double>(polygon.size());
    for (const V2d& p : polygon)
        extent.radius = std::max(extent.radius, (p - extent.centre).length());
    return extent;
}

double squared(double x) {
    return x * x;
}

/// Mass within t.
double massWithin(const LobeMassBeyond& beyond, double t) {
    return t >= 1.5 ? 1 : 1 - beyond(squared(std::sin(0.5 * t)));
}

/// Mean place of the mass between two angles, 0 at the first and 1 at the second: by parts, the
/// mean over the interval of the share of its mass that lies farther out than where one stands.
double meanPlace(const LobeMassBeyond& beyond, double from, double to) {
    const double inner = massWithin(beyond, from), outer = massWithin(beyond, to);
    if (outer - inner <= 1e-15) return 0.5;
    const GaussRule& rule = gaussRule(16);
    double sum = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        // From zero the lobe may lie within the smallest part of the interval: t = to s^4.
        const double s = 0.5 + 0.5 * rule.nodes[i];
        const double place = from == 0 ? s * s * s * s : s;
        const double density = from == 0 ? 4 * s * s * s : 1;
        const double mass = massWithin(beyond, from + (to - from) * place);
        sum += 0.5 * rule.weights[i] * density * (outer - mass);
    }
    return sum / (outer - inner);
}

} // namespace

Quad quadInPlane(const Rectangle& pixel, const std::array<V3d, 4>& corners) {
    const double theta = 0.5 * (pixel.top + pixel.bottom), psi = 0.5 * (pixel.west + pixel.east);
    const V3d centre = polarDirection(theta, psi), south = polarDirection(theta + 0.5 * kPi, psi);
    const V3d east(-std::sin(psi), std::cos(psi), 0);
    Quad quad;
    for (std::size_t i = 0; i < 4; ++i) {
        quad[i] = V2d(corners[i].dot(east), corners[i].dot(south)) / corners[i].dot(centre);
    }
    return quad;
}

Quad pixelQuad(const Rectangle& p) {
    return quadInPlane(p, {polarDirection(p.top, p.west), polarDirection(p.top, p.east),
                           polarDirection(p.bottom, p.east), polarDirection(p.bottom, p.west)});
}

double overlapShare(const Quad& texel, const Quad& pixel) {
    const std::vector<V2d> t = oriented(texel);
    return commonArea(oriented(pixel), t) / areaOf(t);
}

// a(t) is taken as linear between displacements.
double texelMean(const LobeMassBeyond& mass_beyond, const Quad& texel, const Quad& pixel) {
    const std::vector<V2d> t = oriented(texel), p = oriented(pixel);
    const Extent extent_t = extentOf(t), extent_p = extentOf(p);
    const V2d between = extent_t.centre - extent_p.centre;
    const double room = extent_t.radius + extent_p.radius, distance = between.length();
    const double farthest = distance + room;
    const double step = std::min(extent_t.radius, extent_p.radius) / kSteps;
    const auto share = [&](double displacement) {
        if (displacement < distance - room) return 0.0;
        double sum = 0;
        for (int k = 0; k < kDirections; ++k) {
            const double angle = 2 * kPi * (k + 0.25) / kDirections;
            const V2d by = V2d(std::cos(angle), std::sin(angle)) * displacement;
            if ((between - by).length() > room) continue;
            std::vector<V2d> moved = p;
            for (V2d& corner : moved)
                corner += by;
            sum += commonArea(std::move(moved), t);
        }
        return sum / kDirections / areaOf(t);
    };
    double from = 0, share_from = share(0), mass_from = 0, mean = 0;
    for (double width = step; from < farthest && from < 1.5;
         width *= from < 2 * room ? 1 : kGrowth) {
        const double to = from + width, share_to = share(to);
        const double mass_to = massWithin(mass_beyond, to);
        if (share_from > 0 || share_to > 0) {
            const double place = meanPlace(mass_beyond, from, to);
            mean += (mass_to - mass_from) * (share_from + (share_to - share_from) * place);
        }
        from = to;
        share_from = share_to;
        mass_from = mass_to;
    }
    return mean;
}

} // namespace ibl
