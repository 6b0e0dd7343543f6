#include "convolve/near_weights.h"

#include "convolve/gauss.h"
#include "convolve/near_edges.h"
#include "convolve/peaks.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

/// Pixels this many times the texel's and the pixel's extent away are summed by points. A 1024x512
/// probe with a sun, GGX of roughness 0.05 into faces of 256, against 8 times: 2 leaves a relative
/// RMSE of 2.4e-4, 4 leaves 2.9e-6 for half as much time again.
constexpr double kFar = 4;
/// Gauss points to a piece of a texel's edge, and the piece's length over the distance of the
/// nearest end of a pixel's edge.
constexpr int kFlowPoints = 6;
constexpr double kFlowPiece = 1.5;

double squaredSineAtDistance(double r2) { // of half the angle whose tangent is r
    return 0.5 * r2 / (1 + r2 + std::sqrt(1 + r2));
}

/// Adds share * (the kernel's mass over each near pixel as seen from a direction).
void addMasses(const Block& block, const Plane& plane, const std::vector<EdgePiece>& edges,
               double theta, double psi, double share) {
    const NearField& field = block.field;
    const double mass = field.kernel.mass;
    // Summed around a pixel, dchi is 2 pi where the direction lies in it and else 0; without m
    // dchi, edges beyond the reach need not be summed.
    int column = static_cast<int>(std::floor(psi / block.psi(1))) - block.weights.column;
    column = ((column % field.width) + field.width) % field.width;
    const int row = std::min(static_cast<int>(theta / block.theta(1)), field.height - 1);
    block.add(block.at(row - block.weights.row, column), share * mass);
    const V2d place = plane(polarDirection(theta, psi));
    for (const EdgePiece& edge : edges) {
        const V2d a = edge.a - place;
        // Of a parallel's chord the direction may be on the wrong side, by next to nothing.
        const double distance = std::max(std::abs(cross(a, edge.along)), 1e-15);
        const double from = a.dot(edge.along), to = from + edge.length;
        if (distance > field.kernel.reach || from > field.kernel.reach || to < -field.kernel.reach)
            continue;
        const bool left =
            edge.parallel ? theta < edge.line : std::remainder(psi - edge.line, 2 * kPi) < 0;
        const double d = left ? distance : -distance;
        const double angle =
            field.table.angle(d, from, to) - mass * (std::atan(to / d) - std::atan(from / d));
        block.add(edge.before, share * angle / (2 * kPi));
        block.add(edge.after, -share * angle / (2 * kPi));
    }
}

/// int over the edge that goes from e0 along e of B over the edge f.
double flowAcross(const NearField& field, const V2d& e0, const V2d& e, double length,
                  const EdgePiece& f) {
    const NearKernel& kernel = field.kernel;
    const V2d between = f.a - e0, normal(-f.along.y, f.along.x);
    // At the place x on e: distance d from f's line, f's ends at s_a and s_b along it.
    const double d0 = -between.dot(normal), slope = e.dot(normal);
    const double s_a0 = between.dot(f.along), drift = -e.dot(f.along);
    // Where the integrand changes: beside f's ends, and where e crosses f.
    struct Site {
        double place, distance;
    };
    const V2d to_end = between + f.along * f.length;
    std::array<Site, 3> sites{Site{between.dot(e), std::abs(cross(e, between))},
                              Site{to_end.dot(e), std::abs(cross(e, to_end))}, Site{-1, 1e3}};
    if (std::abs(slope) > 1e-9) {
        const double place = -d0 / slope, s = s_a0 + place * drift;
        if (s <= 0 && s + f.length >= 0) sites[2] = {place, 0};
    }
    const auto nearest = [&](double place) {
        double least = 1e3;
        for (const Site& site : sites)
            least = std::min(least, std::max(std::abs(place - site.place), site.distance));
        return least;
    };
    const GaussRule &many = gaussRule(kFlowPoints), &few = gaussRule(kFlowPoints - 2);
    double sum = 0;
    // Pieces not longer than the distance of what changes from their middle; such places part them.
    std::array<double, 5> cuts{0, length, length, length, length};
    for (std::size_t i = 0; i < 3; ++i)
        if (sites[i].place > 0 && sites[i].place < length && sites[i].distance < length)
            cuts[i + 1] = sites[i].place;
    std::ranges::sort(cuts);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        double from = cuts[i];
        while (from < cuts[i + 1]) {
            double to = cuts[i + 1];
            double room = kernel.width + nearest(0.5 * (from + to));
            while (to - from > kFlowPiece * room) {
                to = from + 0.5 * (to - from);
                room = kernel.width + nearest(0.5 * (from + to));
            }
            const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
            const GaussRule& rule = to - from > 0.5 * room ? many : few;
            for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
                const double x = middle + half * rule.nodes[k], d = d0 + x * slope;
                const double s = s_a0 + x * drift;
                if (std::abs(d) < kernel.reach)
                    sum += half * rule.weights[k] * field.table.flow(d, s, s + f.length);
            }
            from = to;
        }
    }
    return sum;
}

/// Adds share * (what flows into each near pixel across the texel's edge from e0 to e1, in the
/// edges' plane); `out` is the normal's sign.
void addFlow(const Block& block, const std::vector<EdgePiece>& edges, const V2d& e0, const V2d& e1,
             double out, double share) {
    const double length = (e1 - e0).length(), reach = block.field.kernel.reach;
    if (length == 0) return;
    const V2d e = (e1 - e0) / length, outward = V2d(-e.y, e.x) * out;
    for (const EdgePiece& f : edges) {
        const double facing = outward.dot(V2d(f.along.y, -f.along.x)); // out of `before`
        const V2d a = f.a - e0;
        if (std::abs(facing) < 1e-12 || std::abs(a.dot(e)) > reach + length + f.length ||
            std::abs(a.dot(outward)) > reach + f.length)
            continue;
        const double flow = share * facing * flowAcross(block.field, e0, e, length, f);
        block.add(f.before, -flow);
        block.add(f.after, flow);
    }
}

/// The texel's outline as polar directions, `pieces` to a side.
std::vector<V3d> outlineOf(const MapExtent& map, int x, int y, double scale, int pieces) {
    std::vector<V3d> outline;
    for (int side = 0; side < 4; ++side) {
        for (int k = 0; k < pieces; ++k) {
            const double at = static_cast<double>(k) / pieces - 0.5;
            const V2d place[4] = {{at, -0.5}, {0.5, at}, {-at, 0.5}, {-0.5, -at}};
            outline.push_back(texelPlace(map, x, y, place[side] * scale));
        }
    }
    return outline;
}

/// Adds what flows across a texel's outline, over its solid angle. One plane does for a small one.
void addOutline(const Block& block, const std::vector<V3d>& outline, const V3d& centre,
                bool one_plane, double solid_angle) {
    const double reach = block.field.kernel.reach;
    std::vector<EdgePiece> edges;
    if (one_plane) {
        const double extent = (outline[0] - centre).length();
        edges = edgesAbout(block, centre, reach + 2 * extent);
    }
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const V3d &e0 = outline[i], &e1 = outline[(i + 1) % outline.size()];
        const V3d middle = (e0 + e1).normalized();
        if (!one_plane) edges = edgesAbout(block, middle, reach + 0.5 * (e1 - e0).length());
        const Plane plane(one_plane ? centre : middle);
        // East, south and out are a left-handed frame.
        const double out = e0.cross(e1).dot(centre) > 0 ? 1 : -1;
        addFlow(block, edges, plane(e0), plane(e1), out, 1 / solid_angle);
    }
}

/// The rows and columns within `reach` of the outline.
void setBlock(const NearField& field, const std::vector<V3d>& outline, const V3d& centre,
              NearWeights& weights) {
    const double reach = field.kernel.reach;
    const double own = std::atan2(centre.y, centre.x);
    double top = kPi, bottom = 0, west = 0, east = 0, turned = 0, last = 0;
    bool first = true;
    for (std::size_t i = 0; i <= outline.size(); ++i) {
        const V3d& d = outline[i % outline.size()];
        const double theta = std::atan2(std::hypot(d.x, d.y), d.z);
        double psi = std::atan2(d.y, d.x) - own;
        psi -= 2 * kPi * std::round(psi / (2 * kPi));
        top = std::min(top, theta);
        bottom = std::max(bottom, theta);
        if (!first) turned += std::remainder(psi - last, 2 * kPi);
        first = false;
        last = psi;
        const double sin = std::sin(theta);
        const double width = std::sin(reach) < sin ? std::asin(std::sin(reach) / sin) : kPi;
        west = std::min(west, psi - width);
        east = std::max(east, psi + width);
    }
    if (std::abs(turned) > kPi) (centre.z > 0 ? top : bottom) = centre.z > 0 ? 0 : kPi;
    const double row_step = kPi / field.height, column_step = 2 * kPi / field.width;
    const double from = top - reach, to = bottom + reach;
    weights.row = std::max(0, static_cast<int>(std::floor(from / row_step)));
    weights.rows =
        std::min(field.height, static_cast<int>(std::floor(to / row_step)) + 1) - weights.row;
    weights.column = static_cast<int>(std::floor((own + west) / column_step));
    weights.columns = static_cast<int>(std::floor((own + east) / column_step)) + 1 - weights.column;
    if (from <= 0 || to >= kPi || weights.columns >= field.width) {
        weights.column = static_cast<int>(std::floor(own / column_step)) - field.width / 2;
        weights.columns = field.width;
    }
    weights.weight.assign(static_cast<std::size_t>(weights.rows) * weights.columns, 0.0);
}

/// Half axes of the parallelogram that a quadrangle about the plane's origin is.
struct HalfAxes {
    V2d a, b;
};

/// Marks the pixels that are near and sets the weights of the others, by a rule of four points that
/// has the second moments of their displacements from the texel.
void addFar(Block& block, const V3d& centre, const HalfAxes& texel, double extent) {
    const NearField& field = block.field;
    NearWeights& w = block.weights;
    const Plane plane(centre);
    block.near.assign(w.weight.size(), 0);
    for (int j = 0; j < w.rows; ++j) {
        const double theta = 0.5 * (block.theta(w.row + j) + block.theta(w.row + j + 1));
        const double sin = std::sin(theta), half_height = 0.5 * block.theta(1),
                     half_width = 0.5 * block.psi(1) * sin;
        const double pixel = 2 * std::max(half_height, half_width);
        const double far = kFar * std::hypot(extent, pixel);
        const double area = latlongPixelSolidAngle(field.width, field.height, w.row + j);
        for (int i = 0; i < w.columns; ++i) {
            const std::size_t at = static_cast<std::size_t>(j * w.columns + i);
            const double psi = block.psi(1) * (w.column + i + 0.5);
            const V3d d = polarDirection(theta, psi);
            const double chord = (d - centre).length();
            if (chord < far) {
                block.near[at] = 1;
                continue;
            }
            if (chord > field.kernel.reach + extent + pixel) continue;
            const V2d p = plane(d);
            const V2d south = plane(polarDirection(theta + half_height, psi)) - p;
            const V2d east = plane(polarDirection(theta, psi + 0.5 * block.psi(1))) - p;
            // Covariance of both, by its Cholesky factor.
            const auto square = [](double x) { return x * x; };
            const double xx = (square(texel.a.x) + square(texel.b.x) + square(south.x) +
                               square(east.x)) /
                              3,
                         xy = (texel.a.x * texel.a.y + texel.b.x * texel.b.y + south.x * south.y +
                               east.x * east.y) /
                              3,
                         yy = (square(texel.a.y) + square(texel.b.y) + square(south.y) +
                               square(east.y)) /
                              3;
            const double l = std::sqrt(xx), m = xy / l, n = std::sqrt(std::max(0.0, yy - m * m));
            double sum = 0;
            for (const double s : {-1.0, 1.0})
                for (const double t : {-1.0, 1.0})
                    sum += field.kernel.value(
                        squaredSineAtDistance((p + V2d(s * l, s * m + t * n)).length2()));
            w.weight[at] = 0.25 * area * sum;
        }
    }
}

} // namespace

NearField makeNearField(const NearKernel& kernel, int probe_width, int probe_height) {
    const auto mass_beyond = [&](double t) {
        const double s = std::sin(0.5 * t);
        return kernel.massBeyond(s * s);
    };
    return {kernel, EdgeTable(mass_beyond, kernel.width, kernel.reach, kernel.reach + 4 * kPiece),
            probe_width, probe_height};
}

NearWeights nearWeights(const NearField& field, const MapExtent& map, int x, int y,
                        const Footprint& footprint) {
    NearWeights weights;
    const double extent = footprint.scale * map.texel;
    const bool flows = footprint.scale == 1;
    const int pieces = flows ? std::max(1, static_cast<int>(std::ceil(extent / (2 * kPiece)))) : 1;
    const V3d centre = texelPlace(map, x, y, V2d(0));
    const std::vector<V3d> outline = outlineOf(map, x, y, footprint.scale, pieces);
    setBlock(field, outline, centre, weights);
    Block block{field, weights, {}};
    const double solid_angle = texelSolidAngle(map.layout, map.width, map.height, x, y);
    const Plane plane(centre);
    const auto halfAxis = [&](V2d offset) { return plane(texelPlace(map, x, y, offset)); };
    addFar(block, centre,
           {halfAxis(V2d(0.5 * footprint.scale, 0)), halfAxis(V2d(0, 0.5 * footprint.scale))},
           extent);
    if (flows) {
        addOutline(block, outline, centre, pieces == 1, solid_angle);
    } else {
        const RowPoints points = texelPoints(map, x, y, footprint);
        const double radius = field.kernel.reach + extent;
        const std::vector<EdgePiece> edges = edgesAbout(block, centre, radius);
        for (std::size_t i = 0; i < points.u.size(); ++i)
            addMasses(block, plane, edges, kPi * points.v[i], 2 * kPi * points.u[i],
                      points.share[i]);
    }
    double sum = 0;
    for (const double w : weights.weight)
        sum += w;
    // Between what is near and what is far the sums are of two kinds.
    if (flows) {
        weights.area = field.kernel.mass - sum;
    } else {
        for (double& w : weights.weight)
            w *= field.kernel.mass / sum;
    }
    return weights;
}

} // namespace ibl
