#include "convolve/texels.h"

#include "convolve/gauss.h"
#include "convolve/peaks.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ibl {
namespace {

/// Solid angle per unit of image area, up to a factor: sin theta in lat-longs, on a face the cube
/// of the direction's largest component.
double density(Layout layout, const V3d& d) {
    if (layout == Layout::latlong || layout == Layout::exrLatlong) return std::hypot(d.x, d.z);
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return largest * largest * largest;
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

/// Appends the points of texel (x, y).
void addTexel(Layout layout, int width, int height, int x, int y, const Footprint& footprint,
              RowPoints& points) {
    // The texel is a rectangle in the image, so a product of Gauss rules has the highest order.
    const GaussRule rule = footprintRule(footprint.samples);
    const std::size_t first = points.u.size();
    double total = 0;
    for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
        for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
            const double dx = 0.5 * footprint.scale * rule.nodes[a];
            const double dy = 0.5 * footprint.scale * rule.nodes[b];
            const V3d d = texelDirection(layout, width, height, x + 0.5 + dx, y + 0.5 + dy).value();
            const V2d p = latlongPoint(d);
            points.u.push_back(p.x);
            points.v.push_back(p.y);
            points.share.push_back(rule.weights[a] * rule.weights[b] * density(layout, d));
            total += points.share.back();
        }
    }
    for (std::size_t i = first; i < points.share.size(); ++i)
        points.share[i] /= total;
}

} // namespace

double texelAngle(const PrefilterRequest& request) {
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
    const bool cube = isCubeFamily(request.layout) || request.layout == Layout::exrCube;
    return cube ? 6 * n * n : 2 * n * n;
}

std::array<V3d, 4> texelCorners(Layout layout, int width, int height, int x, int y, double scale) {
    std::array<V3d, 4> corners;
    for (int i = 0; i < 4; ++i) {
        const double dx = i == 1 || i == 2 ? 0.5 : -0.5, dy = i >= 2 ? 0.5 : -0.5;
        const V3d d =
            texelDirection(layout, width, height, x + 0.5 + scale * dx, y + 0.5 + scale * dy)
                .value();
        const V2d p = latlongPoint(d);
        corners[static_cast<std::size_t>(i)] = polarDirection(kPi * p.y, 2 * kPi * p.x);
    }
    return corners;
}

RowPoints rowPoints(Layout layout, int width, int height, int y, const Footprint& footprint) {
    RowPoints points;
    const std::size_t points_across = footprintRule(footprint.samples).nodes.size();
    points.per_texel = static_cast<int>(points_across * points_across);
    for (int x = 0; x < width; ++x) {
        if (!texelDirection(layout, width, height, x + 0.5, y + 0.5)) continue;
        points.column.push_back(x);
        points.solid_angle.push_back(texelSolidAngle(layout, width, height, x, y));
        addTexel(layout, width, height, x, y, footprint, points);
    }
    return points;
}

} // namespace ibl
