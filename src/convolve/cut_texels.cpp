#include "convolve/cut_texels.h"

#include "panorama/square_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace ibl {
namespace {

/// Half the disc's chord at that distance from the middle.
double halfChord(double distance) {
    return std::sqrt(std::max(0.0, 1 - distance * distance));
}

/// The part of a line within the disc, and whether its ends are on the rim.
struct Inside {
    V2d from, to;
    bool enters, leaves;
};

Inside clipped(const V2d& from, const V2d& to) {
    const std::optional<V2d> crossings = rimCrossings(from, to);
    if (!crossings || crossings->x >= 1 || crossings->y <= 0) return {from, from, false, false};
    const double t0 = crossings->x, t1 = crossings->y;
    const V2d d = to - from;
    return {t0 > 0 ? from + d * t0 : from, t1 < 1 ? from + d * t1 : to, t0 > 0, t1 < 1};
}

/// A place along a line, and its change with t.
struct Place {
    double t, density;
};

/// Places along a line, of t from 0 to 1, so close at the chosen ends that what goes there as the
/// root of the distance is smooth in t.
Place placeBetween(double t, bool at_begin, bool at_end) {
    if (at_begin && at_end) return {t * t * (3 - 2 * t), 6 * t * (1 - t)};
    if (at_begin) return {t * t, 2 * t};
    if (at_end) return {t * (2 - t), 2 * (1 - t)};
    return {t, 1};
}

/// The mirror ball's angle from -Z goes as the root of the distance from the rim.
double alongLine(Layout layout, const Inside& line, double t) {
    return layout == Layout::mirrorBall ? placeBetween(t, line.enters, line.leaves).t : t;
}

} // namespace

std::vector<MapRectangle> ownRectangles(Layout layout, int n, int x, int y, double scale) {
    std::vector<MapRectangle> own;
    const int around = scale < 1 ? 0 : 1;
    for (int j = y - around; j <= y + around; ++j) {
        for (int i = x - around; i <= x + around; ++i) {
            if (owningTexel(layout, n, i, j) != Imath::V2i(x, y)) continue;
            const V2d centre((2.0 * i + 1) / n - 1, (2.0 * j + 1) / n - 1), half(scale / n);
            own.push_back({centre - half, centre + half});
        }
    }
    return own;
}

V3d ballDirection(Layout layout, const V2d& place) {
    const auto d = squareMapDirection(layout, 0.5 * (place.x + 1), 0.5 * (place.y + 1));
    return d.value_or(V3d(0, 0, -1));
}

void addCutPoints(Layout layout, const MapRectangle& rectangle, const GaussRule& rule,
                  std::vector<MapPoint>& points) {
    // Turned so that the rim lies in the direction of +x, steeper than 45 degrees.
    const V2d centre = (rectangle.low + rectangle.high) * 0.5;
    const bool swap = std::abs(centre.y) > std::abs(centre.x);
    const auto swapped = [&](const V2d& p) { return swap ? V2d(p.y, p.x) : p; };
    V2d low = swapped(rectangle.low), high = swapped(rectangle.high);
    const double side = swapped(centre).x < 0 ? -1 : 1;
    if (side < 0) low.x = -std::exchange(high.x, -low.x);
    if (low.x < -0.5) { // the whole map: both sides are near
        addCutPoints(layout, {rectangle.low, V2d(0, rectangle.high.y)}, rule, points);
        addCutPoints(layout, {V2d(0, rectangle.low.y), rectangle.high}, rule, points);
        return;
    }
    // Between the places where the rim meets a side across, all is smooth: in the mirror ball's
    // case in the root of the distance from the rim and from such places.
    const double nearer = halfChord(high.x), farther = halfChord(std::max(0.0, low.x));
    std::vector<double> ends;
    for (const double end : {low.y, high.y, -farther, -nearer, nearer, farther}) {
        if (end >= low.y && end <= high.y && std::abs(end) <= farther) ends.push_back(end);
    }
    std::ranges::sort(ends);
    const bool roots = layout == Layout::mirrorBall;
    const auto isMeeting = [&](double y) {
        return std::abs(y) == nearer || std::abs(y) == farther;
    };
    for (std::size_t part = 0; part + 1 < ends.size(); ++part) {
        const double bottom = ends[part], top = ends[part + 1];
        if (top - bottom < 1e-12 * (high.y - low.y)) continue;
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const Place across = placeBetween(0.5 * (1 + rule.nodes[j]), roots && isMeeting(bottom),
                                              roots && isMeeting(top));
            const double y = bottom + (top - bottom) * across.t;
            const double rim = halfChord(y), end = std::min(high.x, rim);
            const double height = 0.5 * rule.weights[j] * across.density * (top - bottom);
            const double first = std::sqrt(rim - end);
            const double last = std::sqrt(std::max(0.0, rim - low.x));
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double t = 0.5 * (1 + rule.nodes[i]);
                const double root = first + (last - first) * t;
                const double x = roots ? rim - root * root : low.x + (end - low.x) * t;
                const double width = roots ? 2 * root * (last - first) : end - low.x;
                points.push_back({swapped({side * x, y}),
                                  0.5 * rule.weights[i] * height * std::max(0.0, width)});
            }
        }
    }
}

void addCutOutline(Layout layout, const MapRectangle& rectangle, double longest,
                   std::vector<Arc>& outline) {
    const V2d &low = rectangle.low, &high = rectangle.high;
    const std::array<V2d, 4> corners{low, V2d(high.x, low.y), high, V2d(low.x, high.y)};
    for (std::size_t i = 0; i < 4; ++i) {
        const Inside line = clipped(corners[i], corners[(i + 1) % 4]);
        if (line.from == line.to) continue;
        const auto place = [&](double t) {
            const bool on_rim = (t == 0 && line.enters) || (t == 1 && line.leaves);
            const V2d p = line.from + (line.to - line.from) * alongLine(layout, line, t);
            const V3d d = on_rim ? V3d(0, 0, -1) : ballDirection(layout, p);
            return V3d(-d.z, d.x, d.y);
        };
        addCurve(place, 0, 1, 4, longest, outline);
    }
}

} // namespace ibl
