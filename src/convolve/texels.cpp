#include "convolve/texels.h"

#include "convolve/cut_texels.h"
#include "convolve/gauss.h"
#include "convolve/peaks.h"
#include "convolve/row_geometry.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ibl {
namespace {

/// Direction of a place in the image; beyond a ball map's rim that of the rim, beyond the seam of
/// OpenEXR's lat-long, on which both its first and its last texels lie, on the other side.
V3d directionAt(Layout layout, int width, int height, V2d place) {
    if (layout == Layout::exrLatlong && width > 1) {
        if (place.x < 0.5) place.x += width - 1;
        if (place.x > width - 0.5) place.x -= width - 1;
    }
    return texelDirection(layout, width, height, place.x, place.y).value_or(V3d(0, 0, -1));
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

/// Points of a map that take little time.
constexpr double kPoints = 1 << 15;
/// Enough for any texel: the waves that would need more are weak in its mean.
constexpr double kMostSamples = 768;
/// Where a peak is evaluated at every point: more only if the lobe asks for it.
constexpr double kMostOfPeaks = 16;

/// Points along a texel's edge that a lobe needs of which it is so many diameters wide.
double samplesForLobe(double diameters) {
    return 3 + 7.5 * diameters;
}

/// Of few texels more than that: a lobe's horizon crosses them.
double samplesOfFewTexels(double texel) {
    return std::sqrt(kPoints / (4 * kPi)) * texel;
}

/// For texels of that extent in a map of texels of that angle, `density` times as many points as
/// smooth ones need.
Footprint footprintFor(double lobe_diameter, double texel, int degree, double extent,
                       double density) {
    constexpr double kNone = 0.01; // of what a field's curvature leaves that 1e-5 or less
    Footprint footprint{std::min(2 - lobe_diameter / extent, 1.0), 1, texel, lobe_diameter, degree};
    if (footprint.scale < kNone) footprint.scale = 0;
    if (footprint.scale > 0) {
        const double covered = footprint.scale * extent;
        const double for_lobe = density * samplesForLobe(covered / lobe_diameter);
        const double for_waves = density * (3 + 1.8 * covered * degree / kPi); // Gauss: pi a wave
        // Peaks, of which there may be as many as pixels, cost too much at so many (peak_map.h).
        const double few_texels = samplesOfFewTexels(texel);
        const double many = degree == kAnyDegree ? std::min(few_texels, kMostOfPeaks) : few_texels;
        const double samples = std::min({std::max(for_lobe, many), for_waves, kMostSamples});
        footprint.samples = std::max(2, static_cast<int>(std::ceil(samples)));
    }
    return footprint;
}

/// Takes [0, 1], which stands for [from, to], in the parts that those of `kinks` between leave.
template <class TakePart>
void forParts(double from, double to, const std::vector<double>& kinks, const TakePart& takePart) {
    double begin = 0;
    for (const double end : partsBetween(from, to, kinks)) {
        takePart(begin, end);
        begin = end;
    }
}

/// Appends the points of texel (x, y), which looks along `centre`, by the rule: the texel is a
/// rectangle in the image, so a product of Gauss rules has the highest order.
void addTexel(Layout layout, int width, int height, int x, int y, const V3d& centre,
              double footprint_scale, const GaussRule& rule, RowPoints& points) {
    if (rule.nodes.size() == 1) {
        points.direction.push_back(polar(centre));
        points.share.push_back(1);
        return;
    }
    const std::size_t first = points.share.size();
    double total = 0;
    const auto add = [&](const V3d& d, double area) {
        points.direction.push_back(polar(d));
        // At a pole that is a texel's centre the density is 0.
        points.share.push_back(area * std::max(1e-300, solidAngleDensity(layout, d)));
        total += points.share.back();
    };
    if (isBallMap(layout)) {
        std::vector<MapPoint> within;
        for (const MapRectangle& own : ownRectangles(layout, width, x, y, footprint_scale))
            addCutPoints(layout, own, rule, within);
        for (const MapPoint& point : within)
            add(ballDirection(layout, point.at), point.area);
    } else {
        const TexelPart own = ownPart(layout, width, height, x, y);
        const V2d centre_place(x + 0.5, y + 0.5);
        const V2d low = centre_place + own.low * footprint_scale;
        const V2d high = centre_place + own.high * footprint_scale; // of tiny footprints the same
        // Gauss points see no kink within a part.
        std::vector<double> kinks = kinksAlong(layout, width, low.y);
        for (const double kink : kinksAlong(layout, width, high.y))
            kinks.push_back(kink);
        forParts(low.x, high.x, kinks, [&](double left, double right) {
            for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
                const double s = left + (right - left) * 0.5 * (1 + rule.nodes[a]);
                const double px = low.x + (high.x - low.x) * s;
                const auto takePart = [&](double top, double bottom) {
                    const double area = (right - left) * (bottom - top) * rule.weights[a];
                    for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
                        const double t = top + (bottom - top) * 0.5 * (1 + rule.nodes[b]);
                        const double py = low.y + (high.y - low.y) * t;
                        add(directionAt(layout, width, height, V2d(px, py)),
                            area * rule.weights[b]);
                    }
                };
                forParts(low.y, high.y, kinksAlong(layout, width, px), takePart);
            }
        });
    }
    for (std::size_t i = first; i < points.share.size(); ++i)
        points.share[i] /= total;
}

/// Sets the lat-long points of the directions.
void locate(RowPoints& points) {
    points.u.resize(points.direction.size());
    points.v.resize(points.direction.size());
    latlongPoints(points.direction.data(), points.direction.size(), points.u.data(),
                  points.v.data());
}

} // namespace

TexelPart ownPart(Layout layout, int width, int height, int x, int y) {
    TexelPart part{V2d(-0.5), V2d(0.5)};
    if (layout != Layout::exrLatlong && layout != Layout::exrCube) return part;
    const bool cube = layout == Layout::exrCube;
    const int rows = cube ? width : height;
    if (cube && width > 1 && x == 0) part.low.x = 0;
    if (cube && width > 1 && x == width - 1) part.high.x = 0;
    if (rows > 1 && y % rows == 0) part.low.y = 0;
    if (rows > 1 && y % rows == rows - 1) part.high.y = 0;
    return part;
}

std::vector<double> kinksAlong(Layout layout, int width, double place) {
    if (layout != Layout::octahedral) return {};
    const double middle = 0.5 * width, edge = middle - std::abs(place - middle);
    return {middle - edge, middle, middle + edge};
}

std::vector<double> partsBetween(double from, double to, const std::vector<double>& kinks) {
    std::vector<double> ends{1.0};
    for (const double kink : kinks) {
        const double t = (kink - from) / (to - from);
        if (t > 0 && t < 1) ends.push_back(t);
    }
    std::ranges::sort(ends);
    return ends;
}

double partSolidAngle(Layout layout, int width, int height, int x, int y) {
    const bool half = layout == Layout::exrLatlong && width > 1 && (x == 0 || x == width - 1);
    return texelSolidAngle(layout, width, height, x, y) * (half ? 2 : 1);
}

double texelAngle(const PrefilterRequest& request) {
    if (isSquareMap(request.layout)) return std::sqrt(4 * kPi / texelCount(request));
    const bool rows = request.layout == Layout::latlong || request.layout == Layout::exrLatlong;
    return (rows ? kPi : 0.5 * kPi) / request.size;
}

double pixelAngle(const Panorama& probe) {
    return texelAngle({{},
                       probe.layout,
                       layoutSize(probe.layout, probe.image.width, probe.image.height).value()});
}

Footprint footprintOf(const Lobe& lobe, double texel, int degree) {
    return footprintFor(2 * lobeWidth(lobe), texel, degree, texel, 1);
}

double leastOutline(const Lobe& lobe) {
    return lobe.kernel == Kernel::charlie || endsInStep(lobe) ? 0.01 : 0.25;
}

bool isCrossedByHorizons(const Lobe& lobe, const Footprint& of_map) {
    constexpr double kFewer = 1.5; // so many times fewer points leave little
    const double diameters = of_map.scale * of_map.texel / of_map.lobe_diameter;
    return of_map.scale >= leastOutline(lobe) &&
           samplesOfFewTexels(of_map.texel) >
               std::max(kFewer * kMostOfPeaks, samplesForLobe(diameters));
}

Footprint footprintOfTexel(const Footprint& of_map, Layout layout, int size, int x, int y) {
    if (!isBallMap(layout)) return of_map;
    const double rho = std::hypot((2.0 * x + 1) / size - 1, (2.0 * y + 1) / size - 1);
    // Of the angle from +Z.
    const auto angle = [layout](double r) {
        return layout == Layout::mirrorBall ? 2 * std::asin(std::min(r, 1.0)) : kPi * r;
    };
    const double extent = angle(std::min(1.0, rho + 1.0 / size)) - angle(rho - 1.0 / size);
    // Directions change unevenly within it: the diffuse ball of 5 texels is 5e-6 off with as many
    // points as others have.
    return footprintFor(of_map.lobe_diameter, of_map.texel, of_map.degree,
                        std::max(extent, of_map.texel), 1.4);
}

double texelCount(const PrefilterRequest& request) {
    const double n = request.size;
    if (isBallMap(request.layout)) return 0.25 * kPi * n * n;
    if (isSquareMap(request.layout)) return n * n;
    const bool cube = isCubeFamily(request.layout) || request.layout == Layout::exrCube;
    return cube ? 6 * n * n : 2 * n * n;
}

TexelsAlongEdges texelsAlongEdges(const PrefilterRequest& request, int threads) {
    constexpr double kOn = 1e-9;
    const V2i extent = layoutExtent(request.layout, request.size);
    std::vector<std::vector<int>> columns(static_cast<std::size_t>(extent.y));
    parallelFor(columns.size(), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < extent.x; ++x) {
            const auto d = texelDirection(request.layout, extent.x, extent.y, x + 0.5, y + 0.5);
            if (d && (std::abs(d->y) < kOn || std::hypot(d->x, d->z) < kOn))
                columns[row].push_back(x);
        }
    });
    TexelsAlongEdges along{};
    for (int y = 0; y < extent.y; ++y) {
        for (const int x : columns[static_cast<std::size_t>(y)]) {
            along.at.emplace_back(x, y);
            along.share += texelSolidAngle(request.layout, extent.x, extent.y, x, y) / (4 * kPi);
        }
    }
    return along;
}

V3d texelPlace(const MapExtent& map, int x, int y, V2d offset) {
    // A face's edge in the image is as well the next one's.
    constexpr double kWithin = 1 - 1e-10;
    const V3d d =
        directionAt(map.layout, map.width, map.height, V2d(x + 0.5, y + 0.5) + offset * kWithin);
    return polar(d);
}

RowPoints texelPoints(const MapExtent& map, int x, int y, const Footprint& footprint) {
    RowPoints points;
    const V3d centre = directionAt(map.layout, map.width, map.height, {x + 0.5, y + 0.5});
    addTexel(map.layout, map.width, map.height, x, y, centre, footprint.scale,
             footprintRule(footprint.samples), points);
    locate(points);
    return points;
}

RowPoints rowPoints(Layout layout, int width, int height, int y, const Footprint& footprint) {
    RowPoints points;
    const GaussRule rule = footprintRule(footprint.samples);
    std::vector<double> of_face; // a texel's solid angle is the same however its face is turned
    if (isCubeFamily(layout)) {
        const int edge = layoutSize(layout, width, height).value();
        of_face.resize(static_cast<std::size_t>(edge));
        faceRowSolidAngles(edge, y % edge, of_face.data());
    }
    const std::size_t at_most = width * rule.nodes.size() * rule.nodes.size();
    points.direction.reserve(at_most);
    points.share.reserve(at_most);
    for (int x = 0; x < width; ++x) {
        const auto centre = texelDirection(layout, width, height, x + 0.5, y + 0.5);
        if (!centre) continue;
        points.column.push_back(x);
        points.solid_angle.push_back(of_face.empty()
                                         ? texelSolidAngle(layout, width, height, x, y)
                                         : of_face[static_cast<std::size_t>(x) % of_face.size()]);
        points.first.push_back(points.direction.size());
        if (isBallMap(layout)) {
            const Footprint own = footprintOfTexel(footprint, layout, width, x, y);
            addTexel(layout, width, height, x, y, *centre, own.scale, footprintRule(own.samples),
                     points);
        } else {
            addTexel(layout, width, height, x, y, *centre, footprint.scale, rule, points);
        }
    }
    points.first.push_back(points.direction.size());
    locate(points);
    return points;
}

} // namespace ibl
