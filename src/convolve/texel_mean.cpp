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
/// Pixels wider than this (radians) are cut in parts, over which the plane is the sphere to 3e-4.
constexpr double kLargestPart = 0.03;
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

/// Corners in the plane that touches the sphere at the rectangle's middle, counter-clockwise.
std::vector<V2d> inPlane(const Rectangle& r, const std::array<V3d, 4>& corners) {
    const double theta = 0.5 * (r.top + r.bottom), psi = 0.5 * (r.west + r.east);
    const V3d centre = polarDirection(theta, psi), south = polarDirection(theta + 0.5 * kPi, psi);
    const V3d east(-std::sin(psi), std::cos(psi), 0);
    std::vector<V2d> polygon;
    for (const V3d& c : corners)
        polygon.push_back(V2d(c.dot(east), c.dot(south)) / c.dot(centre));
    if (areaOf(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
    return polygon;
}

/// The integral of |T n (P + t)| dM(t). The overlap is taken as linear between displacements.
double planeIntegral(const LobeMassBeyond& mass_beyond, const std::vector<V2d>& texel,
                     const std::vector<V2d>& pixel) {
    const Extent of_texel = extentOf(texel), of_pixel = extentOf(pixel);
    const V2d between = of_texel.centre - of_pixel.centre;
    const double room = of_texel.radius + of_pixel.radius, distance = between.length();
    const auto overlap = [&](double displacement) {
        if (displacement < distance - room) return 0.0;
        double sum = 0;
        for (int k = 0; k < kDirections; ++k) {
            const double angle = 2 * kPi * (k + 0.25) / kDirections;
            const V2d by = V2d(std::cos(angle), std::sin(angle)) * displacement;
            if ((between - by).length() > room) continue;
            std::vector<V2d> moved = pixel;
            for (V2d& corner : moved)
                corner += by;
            sum += commonArea(std::move(moved), texel);
        }
        return sum / kDirections;
    };
    const double smaller = std::min(of_texel.radius, of_pixel.radius);
    double step = smaller / kSteps;
    double from = 0, overlap_from = overlap(0), mass_from = 0, integral = 0;
    while (from < distance + room && from < 1.5) {
        const double to = from + step, overlap_to = overlap(to);
        const double mass_to = massWithin(mass_beyond, to);
        if (overlap_from > 0 || overlap_to > 0) {
            const double place = meanPlace(mass_beyond, from, to);
            integral +=
                (mass_to - mass_from) * (overlap_from + (overlap_to - overlap_from) * place);
        }
        from = to;
        overlap_from = overlap_to;
        mass_from = mass_to;
        if (from > 2 * smaller) step *= kGrowth;
    }
    return integral;
}

/// Solid angle of the triangle of three directions (van Oosterom and Strackee 1983).
double triangle(const V3d& a, const V3d& b, const V3d& c) {
    return 2 * std::atan2(std::abs(a.dot(b.cross(c))), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

} // namespace

double texelMean(const LobeMassBeyond& mass_beyond, const std::array<V3d, 4>& texel,
                 const Rectangle& pixel) {
    const double solid_angle =
        triangle(texel[0], texel[1], texel[2]) + triangle(texel[0], texel[2], texel[3]);
    const double middle = 0.5 * (pixel.top + pixel.bottom);
    const double height = pixel.bottom - pixel.top, width = pixel.east - pixel.west;
    const int rows = static_cast<int>(std::ceil(height / kLargestPart));
    const int columns =
        std::max(1, static_cast<int>(std::ceil(width * std::sin(middle) / kLargestPart)));
    double sum = 0;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const Rectangle r{pixel.top + height * j / rows, pixel.top + height * (j + 1) / rows,
                              pixel.west + width * i / columns,
                              pixel.west + width * (i + 1) / columns};
            const std::vector<V2d> part =
                inPlane(r, {polarDirection(r.top, r.west), polarDirection(r.top, r.east),
                            polarDirection(r.bottom, r.east), polarDirection(r.bottom, r.west)});
            // The plane's areas as the sphere's.
            const double area = (r.east - r.west) * (std::cos(r.top) - std::cos(r.bottom));
            sum += planeIntegral(mass_beyond, inPlane(r, texel), part) * area / areaOf(part);
        }
    }
    return sum / solid_angle;
}

} // namespace ibl
