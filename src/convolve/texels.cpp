#include "convolve/texels.h"

#include "convolve/gauss.h"
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

/// Appends the points of texel (x, y).
void addTexel(Layout layout, int width, int height, int x, int y, const Footprint& footprint,
              RowPoints& points) {
    // The texel is a rectangle in the image, so a product of Gauss rules has the highest order.
    const GaussRule& rule = gaussRule(footprint.samples);
    const std::size_t first = points.u.size();
    double total = 0;
    for (int b = 0; b < footprint.samples; ++b) {
        for (int a = 0; a < footprint.samples; ++a) {
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

Footprint footprintOf(const Lobe& lobe, double texel) {
    const double diameter = 2 * lobeWidth(lobe);
    Footprint footprint;
    footprint.scale = std::clamp(2 - diameter / texel, 0.0, 1.0);
    if (footprint.scale > 0) {
        const double wanted = std::ceil(1 + 3 * footprint.scale * texel / diameter);
        footprint.samples = static_cast<int>(std::clamp<double>(wanted, 2, kMostSamples));
    }
    return footprint;
}

RowPoints rowPoints(Layout layout, int width, int height, int y, const Footprint& footprint) {
    RowPoints points;
    points.per_texel = footprint.samples * footprint.samples;
    for (int x = 0; x < width; ++x) {
        if (!texelDirection(layout, width, height, x + 0.5, y + 0.5)) continue;
        points.column.push_back(x);
        points.solid_angle.push_back(texelSolidAngle(layout, width, height, x, y));
        addTexel(layout, width, height, x, y, footprint, points);
    }
    return points;
}

} // namespace ibl
