#include "convolve/texels.h"

#include "convolve/gauss.h"
#include "convolve/peaks.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ibl {
namespace {

/// Direction of the point at (dx, dy) from a texel's centre, drawn towards the centre where it lies
/// outside a ball map's disc.
V3d directionIn(Layout layout, int width, int height, V2d centre, V2d offset) {
    for (;; offset *= 0.8) {
        const V2d p = centre + offset;
        if (const auto d = texelDirection(layout, width, height, p.x, p.y)) return *d;
    }
}

/// A rule of at least n points on [-1, 1]: Gauss's, for many points in equal parts.
GaussRule footprintRule(int n) {
    constexpr int kPart = 16;
    if (n <= kPart) return gaussRule(n);
    const int parts = (n + kPart - 1) / kPart;
    GaussRule rule;
    for (int part = 0; part < parts; ++part) {
        for (int i = 0; i < kPart; ++i) {
            rule.nodes.push_back((2 * part + 1 + gaussRule(kPart).nodes[i]) / parts - 1);
            rule.weights.push_back(gaussRule(kPart).weights[i] / parts);
        }
    }
    return rule;
}

/// Appends the points of texel (x, y), which looks along `centre`, by the rule: the texel is a
/// rectangle in the image, so a product of Gauss rules has the highest order.
void addTexel(Layout layout, int width, int height, int x, int y, const V3d& centre,
              double footprint_scale, const GaussRule& rule, RowPoints& points) {
    if (rule.nodes.size() == 1) {
        const V2d p = latlongPoint(centre);
        points.u.push_back(p.x);
        points.v.push_back(p.y);
        points.share.push_back(1);
        return;
    }
    const std::size_t first = points.u.size();
    double total = 0;
    for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
        for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
            const double dx = 0.5 * footprint_scale * rule.nodes[a];
            const double dy = 0.5 * footprint_scale * rule.nodes[b];
            const V3d d = directionIn(layout, width, height, {x + 0.5, y + 0.5}, {dx, dy});
            const V2d p = latlongPoint(d);
            points.u.push_back(p.x);
            points.v.push_back(p.y);
            // At a pole that is a texel's centre the density is 0.
            points.share.push_back(rule.weights[a] * rule.weights[b] *
                                   std::max(1e-300, solidAngleDensity(layout, d)));
            total += points.share.back();
        }
    }
    for (std::size_t i = first; i < points.share.size(); ++i)
        points.share[i] /= total;
}

} // namespace

double texelAngle(const PrefilterRequest& request) {
    if (isSquareMap(request.layout)) return std::sqrt(4 * kPi / texelCount(request));
    const bool rows = request.layout == Layout::latlong || request.layout == Layout::exrLatlong;
    return (rows ? kPi : 0.5 * kPi) / request.size;
}

Footprint footprintOf(const Lobe& lobe, double texel, int degree) {
    const double diameter = 2 * lobeWidth(lobe);
    Footprint footprint;
    footprint.scale = std::clamp(2 - diameter / texel, 0.0, 1.0);
    if (footprint.scale > 0) {
        const double extent = footprint.scale * texel;
        const double for_lobe = 1 + 4 * extent / diameter;
        const double for_waves = 2 + 1.2 * extent * degree / kPi; // Gauss: pi points a wave
        footprint.samples = std::max(2, static_cast<int>(std::ceil(std::min(for_lobe, for_waves))));
    }
    return footprint;
}

double texelCount(const PrefilterRequest& request) {
    const double n = request.size;
    if (isBallMap(request.layout)) return 0.25 * kPi * n * n;
    if (isSquareMap(request.layout)) return n * n;
    const bool cube = isCubeFamily(request.layout) || request.layout == Layout::exrCube;
    return cube ? 6 * n * n : 2 * n * n;
}

V3d texelPlace(const MapExtent& map, int x, int y, V2d offset) {
    // A face's edge in the image is as well the next one's.
    constexpr double kWithin = 1 - 1e-10;
    const V3d d =
        directionIn(map.layout, map.width, map.height, {x + 0.5, y + 0.5}, offset * kWithin);
    return {-d.z, d.x, d.y};
}

RowPoints texelPoints(const MapExtent& map, int x, int y, const Footprint& footprint) {
    RowPoints points;
    const V3d centre = directionIn(map.layout, map.width, map.height, {x + 0.5, y + 0.5}, V2d(0));
    addTexel(map.layout, map.width, map.height, x, y, centre, footprint.scale,
             footprintRule(footprint.samples), points);
    return points;
}

RowPoints rowPoints(Layout layout, int width, int height, int y, const Footprint& footprint) {
    RowPoints points;
    const GaussRule rule = footprintRule(footprint.samples);
    points.per_texel = static_cast<int>(rule.nodes.size() * rule.nodes.size());
    for (int x = 0; x < width; ++x) {
        const auto centre = texelDirection(layout, width, height, x + 0.5, y + 0.5);
        if (!centre) continue;
        points.column.push_back(x);
        points.solid_angle.push_back(texelSolidAngle(layout, width, height, x, y));
        addTexel(layout, width, height, x, y, *centre, footprint.scale, rule, points);
    }
    return points;
}

} // namespace ibl
