#include "convolve/near_texel.h"

#include "convolve/cut_texels.h"
#include "panorama/conventions.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// The outline of the texel shrunk to `scale`, in pieces of about `longest` radians.
std::vector<Arc> outlineOf(const MapExtent& map, int x, int y, double scale, double longest) {
    std::vector<Arc> outline;
    if (isBallMap(map.layout)) {
        for (const MapRectangle& own : ownRectangles(map.layout, map.width, x, y, scale))
            addCutOutline(map.layout, own, longest, outline);
        return outline;
    }
    const auto [low, high] = ownPart(map.layout, map.width, map.height, x, y);
    const V2d corners[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
    for (int side = 0; side < 4; ++side) {
        const V2d begin = corners[side], step = corners[(side + 1) % 4] - begin;
        const auto place = [&](double t) {
            return texelPlace(map, x, y, (begin + step * t) * scale);
        };
        const int along = side % 2;
        const V2d first = V2d(x + 0.5, y + 0.5) + begin * scale, last = first + step * scale;
        double from = 0;
        for (const double to : partsBetween(first[along], last[along],
                                            kinksAlong(map.layout, map.width, first[1 - along]))) {
            addCurve(place, from, to, 1, longest, outline);
            from = to;
        }
    }
    return outline;
}

/// Positive where the outline runs counter-clockwise as seen from outside: with t the angle from
/// the centre and chi the azimuth about it, the integral of (1 - cos t) dchi.
double solidAngle(const std::vector<Arc>& outline, const V3d& centre) {
    double sum = 0;
    for (const Arc& e : outline)
        for (const ArcPoint& x : threePoints(e))
            sum += centre.dot(x.at.cross(x.along)) / (1 + centre.dot(x.at));
    return sum;
}

} // namespace

std::vector<TexelPoint> pointsOf(const MapExtent& map, int x, int y, const Footprint& footprint) {
    const RowPoints row = texelPoints(map, x, y, footprint);
    std::vector<TexelPoint> points;
    for (std::size_t i = 0; i < row.u.size(); ++i)
        points.push_back({polarDirection(kPi * row.v[i], 2 * kPi * row.u[i]), row.share[i]});
    return points;
}

Texel texelOf(const MapExtent& map, int x, int y, double scale, double longest) {
    const auto [low, high] = ownPart(map.layout, map.width, map.height, x, y);
    Texel texel{texelPlace(map, x, y, (low + high) * (0.5 * scale)),
                0,
                outlineOf(map, x, y, scale, longest),
                0,
                pointsOf(map, x, y, {scale, scale > 0 ? 2 : 1}),
                pointsOf(map, x, y, {scale, scale > 0 ? 3 : 1})};
    for (const Arc& e : texel.outline)
        texel.radius =
            std::max({texel.radius, (e.a - texel.centre).length(), (e.m - texel.centre).length()});
    const double own = solidAngle(texel.outline, texel.centre);
    const double exact = partSolidAngle(map.layout, map.width, map.height, x, y);
    texel.solid_angle = scale < 1 ? own : std::copysign(exact, own); // as the area filter
    return texel;
}

Flow::Flow(const NearField& field, const MapExtent& map, int x, int y, const Footprint& footprint,
           const Texel& texel, Potential potential)
    : field_(field), texel_(texel), potential_(potential) {
    const double scale = footprint.scale;
    if (scale >= leastOutline(field.kernel.lobe())) return;
    // Beside a sun pixels' masses need one point more than footprintOf's, which are for lobes.
    points_ = pointsOf(map, x, y, {scale, footprint.samples + (scale > 0 ? 1 : 0)});
}

double Flow::across(const Arc& f) const {
    if (points_.empty()) return flowAcross(field_, potential_, texel_, f);
    double flow = 0;
    for (const TexelPoint& x : points_)
        flow += x.share * flowAcross(field_, x.at, f);
    return flow;
}

} // namespace ibl
