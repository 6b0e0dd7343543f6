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

/// The mirror ball's angle from -Z goes as the root of the distance from the rim: places along a
/// line are taken so that it is smooth in `t`, from 0 to 1.
double alongLine(Layout layout, const Inside& line, double t) {
    if (layout != Layout::mirrorBall) return t;
    if (line.enters && line.leaves) return t * t * (3 - 2 * t);
    if (line.enters) return t * t;
    return line.leaves ? t * (2 - t) : t;
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

    const double widest = halfChord(std::max(0.0, low.x));
    const double bottom = std::max(low.y, -widest), top = std::min(high.y, widest);
    for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
        const double y = 0.5 * (bottom + top + (top - bottom) * rule.nodes[j]);
        const double rim = halfChord(y), begin = std::max(low.x, -rim);
        const double extent = std::min(high.x, rim) - begin;
        // The mirror ball's angle from -Z is smooth in the root of the distance from the rim.
        const bool root = layout == Layout::mirrorBall && high.x > rim;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = 0.5 * (1 + rule.nodes[i]);
            const double x = begin + extent * (root ? 1 - t * t : t);
            points.push_back({swapped({side * x, y}), 0.25 * rule.weights[i] * rule.weights[j] *
                                                          (top - bottom) * std::max(0.0, extent) *
                                                          (root ? 2 * t : 1)});
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
