#include "panorama/square_maps.h"

#include "panorama/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

using Imath::V2i;

/// Of -0 as well: at -Y, which lies in all four corners, it tells which.
double sign(double x) {
    return std::copysign(1.0, x);
}

/// The lower half's triangles turned over the square's diagonals; its own inverse.
V2d folded(double px, double pz) {
    return {(1 - std::abs(pz)) * sign(px), (1 - std::abs(px)) * sign(pz)};
}

V3d octahedralDirection(double px, double pz) {
    const double py = 1 - std::abs(px) - std::abs(pz);
    if (py >= 0) return V3d(px, py, pz).normalized();
    const V2d p = folded(px, pz);
    return V3d(p.x, py, p.y).normalized();
}

bool inDisc(double a, double b) {
    return a * a + b * b <= 1;
}

/// Coordinate of a texel's centre in [-1, 1].
double centreOf(int x, int n) {
    return (2.0 * x + 1) / n - 1;
}

/// Solid angle within rho of the middle over 2 pi, divided by rho^2: a function that is analytic in
/// rho^2.
double capOverSquare(Layout layout, double rho) {
    if (layout == Layout::mirrorBall) return 2;
    const double x = 0.5 * kPi * rho;
    const double sinc = x < 1e-8 ? 1 : std::sin(x) / x;
    return 0.5 * kPi * kPi * sinc * sinc;
}

/// The integral of F(rho) dphi along a line within the disc, F the solid angle within rho over 2
/// pi: by Gauss's rule of eight points on F / rho^2 (a db - b da), whose second factor is constant
/// along a line.
double sweptInside(Layout layout, const V2d& from, const V2d& to) {
    constexpr std::array<double, 4> kNodes{0.1834346424956498, 0.5255324099163290,
                                           0.7966664774136267, 0.9602898564975363};
    constexpr std::array<double, 4> kWeights{0.3626837833783620, 0.3137066458778873,
                                             0.2223810344533745, 0.1012285362903763};
    const V2d middle = (from + to) * 0.5, half = (to - from) * 0.5;
    double sum = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
        for (double t : {-kNodes[i], kNodes[i]})
            sum += kWeights[i] * capOverSquare(layout, (middle + half * t).length());
    }
    return 0.5 * sum * (from.x * to.y - from.y * to.x);
}

/// The same outside, where F is that of the rim, 2.
double sweptOutside(const V2d& from, const V2d& to) {
    return 2 * std::atan2(from.x * to.y - from.y * to.x, from.dot(to));
}

double sweptAlong(Layout layout, const V2d& from, const V2d& to) {
    const std::optional<V2d> crossings = rimCrossings(from, to);
    if (!crossings) return sweptOutside(from, to);
    const V2d d = to - from;
    const double t0 = std::clamp(crossings->x, 0.0, 1.0);
    const double t1 = std::clamp(crossings->y, 0.0, 1.0);
    const V2d enter = from + d * t0, leave = from + d * t1;
    return sweptOutside(from, enter) + sweptInside(layout, enter, leave) + sweptOutside(leave, to);
}

/// Solid angle of a texel's part in the disc: by Green's theorem the integral of F(rho) dphi around
/// the texel.
double discPart(Layout layout, int n, int x, int y) {
    const double a0 = 2.0 * x / n - 1, a1 = 2.0 * (x + 1) / n - 1;
    const double b0 = 2.0 * y / n - 1, b1 = 2.0 * (y + 1) / n - 1;
    const std::array<V2d, 4> corners{V2d(a0, b0), V2d(a1, b0), V2d(a1, b1), V2d(a0, b1)};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
        sum += sweptAlong(layout, corners[i], corners[(i + 1) % 4]);
    return std::max(0.0, sum);
}

double ballSolidAngle(Layout layout, int n, int x, int y) {
    double sum = 0;
    for (int j = std::max(0, y - 1); j <= std::min(n - 1, y + 1); ++j) {
        for (int i = std::max(0, x - 1); i <= std::min(n - 1, x + 1); ++i) {
            if (owningTexel(layout, n, i, j) == V2i(x, y)) sum += discPart(layout, n, i, j);
        }
    }
    return sum;
}

/// The part of a polygon where p . normal <= limit (Sutherland and Hodgman 1974).
std::vector<V2d> cut(const std::vector<V2d>& polygon, const V2d& normal, double limit) {
    std::vector<V2d> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const V2d p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        const double over_p = p.dot(normal) - limit, over_q = q.dot(normal) - limit;
        if (over_p <= 0) kept.push_back(p);
        if ((over_p < 0 && over_q > 0) || (over_p > 0 && over_q < 0))
            kept.push_back(p + (q - p) * (over_p / (over_p - over_q)));
    }
    return kept;
}

/// Solid angle of a polygon within one face of the octahedron, whose lines are great circles; the
/// triangles by van Oosterom and Strackee (1983).
double facePart(const std::vector<V2d>& polygon) {
    double sum = 0;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const V3d a = octahedralDirection(polygon[0].x, polygon[0].y);
        const V3d b = octahedralDirection(polygon[i - 1].x, polygon[i - 1].y);
        const V3d c = octahedralDirection(polygon[i].x, polygon[i].y);
        const double volume = std::abs((b - a).cross(c - a).dot(a));
        sum += 2 * std::atan2(volume, 1 + a.dot(b) + b.dot(c) + c.dot(a));
    }
    return sum;
}

double octahedralSolidAngle(int n, int x, int y) {
    const double a0 = 2.0 * x / n - 1, a1 = 2.0 * (x + 1) / n - 1;
    const double b0 = 2.0 * y / n - 1, b1 = 2.0 * (y + 1) / n - 1;
    const std::vector<V2d> texel{{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}};
    const double outer = std::max(-a0, a1) + std::max(-b0, b1);
    const double inner =
        std::min(std::abs(a0), std::abs(a1)) + std::min(std::abs(b0), std::abs(b1));
    const bool in_quarter = a0 * a1 >= 0 && b0 * b1 >= 0;
    if (in_quarter && (outer <= 1 || inner >= 1)) return facePart(texel); // the most of them
    double sum = 0;
    for (double sx : {-1.0, 1.0}) {
        for (double sz : {-1.0, 1.0}) {
            const std::vector<V2d> quarter = cut(cut(texel, {-sx, 0}, 0), {0, -sz}, 0);
            sum += facePart(cut(quarter, {sx, sz}, 1)) + facePart(cut(quarter, {-sx, -sz}, -1));
        }
    }
    return sum;
}

} // namespace

bool isSquareMap(Layout layout) {
    return isBallMap(layout) || layout == Layout::octahedral;
}

bool isBallMap(Layout layout) {
    return layout == Layout::angular || layout == Layout::mirrorBall;
}

std::optional<V3d> squareMapDirection(Layout layout, double u, double v) {
    if (layout == Layout::octahedral) return octahedralDirection(2 * u - 1, 2 * v - 1);
    const double a = 2 * u - 1, b = 1 - 2 * v;
    if (!inDisc(a, b)) return std::nullopt;
    const double rho = std::hypot(a, b);
    if (layout == Layout::angular) {
        const double s = rho < 1e-12 ? kPi : std::sin(kPi * rho) / rho;
        return V3d(-a * s, b * s, std::cos(kPi * rho));
    }
    const double c = std::sqrt(std::max(0.0, 1 - rho * rho));
    return V3d(2 * c * a, 2 * c * b, 2 * c * c - 1);
}

V2d squareMapPoint(Layout layout, const V3d& direction) {
    if (layout == Layout::octahedral) {
        const V3d p =
            direction / (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
        const V2d q = p.y < 0 ? folded(p.x, p.z) : V2d(p.x, p.z);
        return {0.5 * (q.x + 1), 0.5 * (q.y + 1)};
    }
    // By the polar angle theta from +Z; the mirror ball's rho is sin(theta / 2).
    const double square = direction.x * direction.x + direction.y * direction.y;
    const double across = std::sqrt(square), z = direction.z;
    const double length = std::sqrt(square + z * z);
    const double rho = layout == Layout::angular ? std::atan2(across, z) / kPi
                       : z > 0                   ? across / std::sqrt(2 * length * (length + z))
                                                 : std::sqrt((length - z) / (2 * length));
    if (across == 0) return {0.5 * (rho + 1), 0.5};
    const double right = layout == Layout::angular ? -direction.x : direction.x;
    return {0.5 * (right / across * rho + 1), 0.5 * (1 - direction.y / across * rho)};
}

std::optional<V2d> rimCrossings(const V2d& from, const V2d& to) {
    const V2d d = to - from;
    const double a = d.dot(d), b = from.dot(d), c = from.dot(from) - 1;
    const double discriminant = b * b - a * c;
    if (discriminant <= 0) return std::nullopt;
    const double root = std::sqrt(discriminant);
    return V2d((-b - root) / a, (-b + root) / a);
}

std::optional<V2i> owningTexel(Layout layout, int n, int x, int y) {
    if (!isBallMap(layout)) return V2i(x, y);
    const double a = centreOf(x, n), b = centreOf(y, n);
    if (inDisc(a, b)) return V2i(x, y);
    const double half = 1.0 / n;
    if (!inDisc(std::max(0.0, std::abs(a) - half), std::max(0.0, std::abs(b) - half))) {
        return std::nullopt;
    }
    const V2i across(x + (a > 0 ? -1 : 1), y), along(x, y + (b > 0 ? -1 : 1));
    const V2i first = std::abs(a) >= std::abs(b) ? across : along;
    if (inDisc(centreOf(first.x, n), centreOf(first.y, n))) return first;
    // On a diagonal the step along both is nearer to the middle than the corner that is inside.
    return V2i(across.x, along.y);
}

double squareMapSolidAngle(Layout layout, int n, int x, int y) {
    if (layout == Layout::octahedral) return octahedralSolidAngle(n, x, y);
    if (!inDisc(centreOf(x, n), centreOf(y, n))) return 0;
    return ballSolidAngle(layout, n, x, y);
}

} // namespace ibl
