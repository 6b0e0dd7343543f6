#include "panorama/chart.h"

#include "panorama/layouts.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

/// Sides are off their chords by no more than this in the chart, in pixels, and bent to their area.
/// Neighbours share the vertices, so no area is lost by it.
constexpr double kBend = 1e-3;
/// Below this part of what they may be off by, chords stay as they are.
constexpr double kUnbent = 0.01;
constexpr int kMostHalvings = 30; ///< of a quarter of the sphere, down to isApex
/// Cells stand this much inside, because texels' edges are where cubes' faces meet.
constexpr double kInside = 1e-9;

const V3d kRim(0, 0, -1); ///< of ball maps

V3d middleOf(const V3d& p, const V3d& q) {
    return (p + q).normalized();
}

/// What stands for a parabola between its ends and has its area: the corner of a triangle, a third
/// higher than its middle, which is `off` the chord's.
template <class Vector>
Vector corner(const Vector& middle, const Vector& off) {
    return middle + off * (1.0 / 3);
}

/// Appends what lies between the directions p and q of the image's points a and b.
void appendSide(const Panorama& panorama, const V2d& a, const V2d& b, const V3d& p, const V3d& q,
                double tolerance, int depth, SpherePolygon& outline) {
    const bool near = p.dot(q) > 0.9;
    if (near && panorama.layout == Layout::latlong && a.x == b.x) return; // a meridian
    const V2d c = (a + b) * 0.5;
    const Image& image = panorama.image;
    const V3d m =
        texelDirection(panorama.layout, image.width, image.height, c.x, c.y).value_or(kRim);
    const V3d off = m - middleOf(p, q);
    if (near && off.length2() < tolerance * tolerance) {
        if (off.length2() > std::pow(kUnbent * tolerance, 2))
            outline.push_back(corner(m, off).normalized());
        return;
    }
    if (depth >= kMostHalvings) {
        if (!near) outline.push_back(m);
        return;
    }
    appendSide(panorama, a, c, p, m, tolerance, depth + 1, outline);
    outline.push_back(m);
    appendSide(panorama, c, b, m, q, tolerance, depth + 1, outline);
}

/// The part [first, second] of the way from a to b that lies in a ball map's disc of that radius
/// about its middle.
V2d withinDisc(const V2d& a, const V2d& b, double radius) {
    const V2d from = a - V2d(radius), along = b - a;
    const double aa = along.length2(), ab = from.dot(along), bb = from.length2() - radius * radius;
    const double discriminant = ab * ab - aa * bb;
    if (discriminant <= 0) return {0, 0};
    const double root = std::sqrt(discriminant);
    return {std::clamp((-ab - root) / aa, 0.0, 1.0), std::clamp((-ab + root) / aa, 0.0, 1.0)};
}

double withSign(double x, double sign) {
    return std::copysign(std::max(0.0, x * sign), sign);
}

/// The pole or the rim, about which a sector turns: its azimuth has no value there, and next to it,
/// where kInside keeps cells, none that counts.
bool isApex(Layout layout, const V3d& d) {
    constexpr double kNext = 1e-8;
    if (layout == Layout::latlong) return std::hypot(d.x, d.z) < kNext;
    return isBallMap(layout) && d.z < 0 && std::hypot(d.x, d.y) < kNext;
}

V2d chartPoint(const Panorama& panorama, const Sector& sector, V3d d) {
    const double width = panorama.image.width;
    if (sector.face >= 0) {
        const V3d centre = cubeDirection({sector.face, 0, 0});
        const double depth = std::max(d.dot(centre), 1e-300);
        const auto along = [&](const V3d& end) {
            return std::clamp(0.5 + 0.5 * d.dot(end - centre) / depth, 0.0, 1.0);
        };
        return V2d(along(cubeDirection({sector.face, 1, 0})),
                   along(cubeDirection({sector.face, 0, 1})) + sector.face) *
               width;
    }
    for (int i = 0; i < 3; ++i)
        if (sector.signs[i] != 0) d[i] = withSign(d[i], sector.signs[i]);
    if (panorama.layout == Layout::latlong)
        return {(0.5 - std::atan2(d.x, d.z) / (2 * kPi)) * width, -d.y / d.length()};
    return squareMapPoint(panorama.layout, d) * width;
}

/// By how many times what it may be a side's middle is off its chord's.
double bend(const Panorama& panorama, const V2d& middle, const V2d& off) {
    double unit = 1;
    if (panorama.layout == Layout::latlong) { // a row of -cos(theta), at the poles half of one
        const double row = kPi / panorama.image.height;
        unit = row * std::max(std::sqrt(std::max(0.0, 1 - middle.y * middle.y)), 0.5 * row);
    }
    return std::max(std::abs(off.x), std::abs(off.y) / unit) / kBend;
}

void carrySide(const Panorama& panorama, const Sector& sector, const V3d& p, const V3d& q,
               const V2d& a, const V2d& b, int depth, std::vector<V2d>& flat) {
    const V3d m = middleOf(p, q);
    const V2d c = chartPoint(panorama, sector, m), off = c - (a + b) * 0.5;
    const double bent = bend(panorama, c, off);
    if (bent < 1 || depth >= kMostHalvings) {
        if (bent > kUnbent) flat.push_back(corner(c, off));
        return;
    }
    carrySide(panorama, sector, p, m, a, c, depth + 1, flat);
    flat.push_back(c);
    carrySide(panorama, sector, m, q, c, b, depth + 1, flat);
}

/// The chart's points of an apex, between those beside it: along the rim or the pole's row.
void carryApex(const Panorama& panorama, const Sector& sector, const V3d& apex, const V3d& before,
               const V3d& after, std::vector<V2d>& flat) {
    if (panorama.layout == Layout::latlong) {
        for (const V3d& d : {before, after})
            flat.emplace_back(chartPoint(panorama, sector, d).x, -std::copysign(1.0, apex.y));
        return;
    }
    const double radius = 0.5 * panorama.image.width;
    const auto azimuth = [&](const V3d& d) {
        const V2d p = chartPoint(panorama, sector, d) - V2d(radius);
        return std::atan2(p.y, p.x);
    };
    const double from = azimuth(before), turn = std::remainder(azimuth(after) - from, 2 * kPi);
    const int pieces =
        1 + static_cast<int>(std::abs(turn) / std::sqrt(8 * kBend / std::max(1.0, radius)));
    const double piece = turn / pieces;
    // As far out as gives the polygon the sector's area.
    const double out = piece == 0 ? radius : radius * std::sqrt(piece / std::sin(piece));
    for (int k = 0; k <= pieces; ++k) {
        const double at = from + piece * k;
        flat.push_back(V2d(radius) + V2d(std::cos(at), std::sin(at)) * out);
    }
}

} // namespace

void appendCell(const Panorama& panorama, double x, double y, double size, double tolerance,
                SpherePolygon& outline) {
    const Image& image = panorama.image;
    const double low = kInside, high = size - kInside;
    const std::array<V2d, 4> corners{V2d(low, low), V2d(high, low), V2d(high, high),
                                     V2d(low, high)};
    const bool ball = isBallMap(panorama.layout);
    const auto direction = [&](const V2d& p) {
        return texelDirection(panorama.layout, image.width, image.height, x + p.x, y + p.y)
            .value_or(kRim);
    };
    const std::array<V3d, 4> directions{direction(corners[0]), direction(corners[1]),
                                        direction(corners[2]), direction(corners[3])};
    for (std::size_t i = 0; i < 4; ++i) {
        const V2d from = corners[i] + V2d(x, y), to = corners[(i + 1) % 4] + V2d(x, y);
        const V2d within = ball ? withinDisc(from, to, 0.5 * image.width) : V2d(0, 1);
        if (within.x >= within.y) continue;
        const V2d a = from + (to - from) * within.x, b = from + (to - from) * within.y;
        const V3d p = within.x > 0 ? kRim : directions[i],
                  q = within.y < 1 ? kRim : directions[(i + 1) % 4];
        outline.push_back(p);
        appendSide(panorama, a, b, p, q, tolerance, 0, outline);
        if (within.y < 1) outline.push_back(q);
    }
}

std::vector<Sector> sectorsOf(Layout layout) {
    std::vector<Sector> sectors;
    if (layout == Layout::faces) {
        for (int face = 0; face < 6; ++face) {
            const V3d centre = cubeDirection({face, 0, 0});
            const V3d s = cubeDirection({face, 1, 0}) - centre,
                      t = cubeDirection({face, 0, 1}) - centre;
            sectors.push_back({{centre + s, centre - s, centre + t, centre - t}, V3d(0), face});
        }
        return sectors;
    }
    const bool octants = layout == Layout::octahedral;
    const V3d axes = octants                     ? V3d(1, 1, 1)
                     : layout == Layout::latlong ? V3d(1, 0, 1)
                                                 : V3d(1, 1, 0);
    for (int k = 0; k < 8; ++k) {
        const V3d signs(k & 1 ? -1 : 1, k & 2 ? -1 : 1, k & 4 ? -1 : 1);
        Sector sector{{}, signs * axes, -1};
        bool twice = false;
        for (int i = 0; i < 3; ++i) {
            V3d normal(0);
            normal[i] = sector.signs[i];
            if (axes[i] != 0) sector.normals.push_back(normal);
            twice |= axes[i] == 0 && signs[i] < 0;
        }
        if (!twice) sectors.push_back(sector);
    }
    return sectors;
}

void clipTo(const Sector& sector, const SpherePolygon& polygon, SpherePolygon& part) {
    part = polygon;
    SpherePolygon kept;
    for (const V3d& normal : sector.normals) {
        if (std::ranges::all_of(part, [&](const V3d& d) { return d.dot(normal) >= 0; })) continue;
        if (std::ranges::all_of(part, [&](const V3d& d) { return d.dot(normal) <= 0; })) {
            part.clear();
            return;
        }
        kept.clear();
        for (std::size_t i = 0; i < part.size(); ++i) { // Sutherland and Hodgman 1974
            const V3d &p = part[i], &q = part[(i + 1) % part.size()];
            const double over_p = p.dot(normal), over_q = q.dot(normal);
            if (over_p >= 0) kept.push_back(p);
            if ((over_p > 0 && over_q < 0) || (over_p < 0 && over_q > 0)) {
                const double t = over_p / (over_p - over_q);
                kept.push_back((p + (q - p) * t).normalized());
            }
        }
        part.swap(kept);
        if (part.size() < 3) {
            part.clear();
            return;
        }
    }
}

void carry(const Panorama& panorama, const Sector& sector, const SpherePolygon& part,
           std::vector<V2d>& flat) {
    flat.clear();
    // Vertices that lie on an apex one after another are one.
    SpherePolygon corners;
    for (const V3d& d : part) {
        if (!corners.empty() && isApex(panorama.layout, d) &&
            isApex(panorama.layout, corners.back()))
            continue;
        corners.push_back(d);
    }
    while (corners.size() > 1 && isApex(panorama.layout, corners.front()) &&
           isApex(panorama.layout, corners.back()))
        corners.pop_back();
    const std::size_t n = corners.size();
    if (n < 3) return;
    V2d a = chartPoint(panorama, sector, corners[0]);
    const V2d first = a;
    for (std::size_t i = 0; i < n; ++i) {
        const V3d &p = corners[i], &q = corners[(i + 1) % n];
        const V2d b = i + 1 < n ? chartPoint(panorama, sector, q) : first;
        if (isApex(panorama.layout, p)) {
            carryApex(panorama, sector, p, corners[(i + n - 1) % n], q, flat);
        } else {
            flat.push_back(a);
            // A meridian leads to an apex, and another one away.
            if (!isApex(panorama.layout, q)) carrySide(panorama, sector, p, q, a, b, 0, flat);
        }
        a = b;
    }
}

ChartDensity chartDensity(const Panorama& panorama, const V2d& p) {
    const double width = panorama.image.width, unit = 2 / width;
    const double a = unit * p.x - 1, b = unit * p.y - 1;
    // A function f of q, which is quadratic in a and b: (x, y) its gradient, of second derivatives
    // 2 (1, 1) or, with `mixed`, 2 (2, 2) and 2 mixed.
    const auto composed = [unit](double f, double df, double ddf, double x, double y,
                                 double mixed) {
        const double along = mixed == 0 ? 2 : 4;
        return ChartDensity{f, (along * df + ddf * x * x) * unit * unit,
                            (2 * mixed * df + ddf * x * y) * unit * unit,
                            (along * df + ddf * y * y) * unit * unit};
    };
    const auto ofSquare = [&](double square, double x, double y, double mixed) { // square^(-3/2)
        const double f = 1 / (square * std::sqrt(square));
        return composed(f, -1.5 * f / square, 3.75 * f / (square * square), x, y, mixed);
    };
    switch (panorama.layout) {
    case Layout::angular: {
        const double q = a * a + b * b, t = kPi * kPi * q, theta = std::sqrt(t);
        if (theta < 0.1) { // sin(theta) / theta by its series
            const double f = 1 - t / 6 * (1 - t / 20 * (1 - t / 42));
            return composed(f, -kPi * kPi / 6 * (1 - t / 10 * (1 - t / 28)),
                            kPi * kPi * kPi * kPi / 60 * (1 - t / 14), 2 * a, 2 * b, 0);
        }
        const double f = std::sin(theta) / theta;
        const double df = (std::cos(theta) - f) / (2 * t);
        const double ddf = (-f - 6 * df) / (4 * t);
        return composed(f, kPi * kPi * df, kPi * kPi * kPi * kPi * ddf, 2 * a, 2 * b, 0);
    }
    case Layout::octahedral: { // a plane about the origin, seen from there
        const double sa = std::copysign(1.0, a), sb = std::copysign(1.0, b);
        const double c = 1 - std::abs(a) - std::abs(b);
        const double x = c < 0 ? a - sa : a,
                     z = c < 0 ? b - sb : b; // of the lower half turned over
        return ofSquare(x * x + c * c + z * z, 2 * (x - c * sa), 2 * (z - c * sb), sa * sb);
    }
    case Layout::faces: {
        const double t = b - 2 * std::clamp(std::floor(p.y / width), 0.0, 5.0);
        return ofSquare(1 + a * a + t * t, 2 * a, 2 * t, 0);
    }
    default: // equal areas
        return {1, 0, 0, 0};
    }
}

} // namespace ibl
