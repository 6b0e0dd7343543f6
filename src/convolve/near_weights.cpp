#include "convolve/near_weights.h"

#include "convolve/gauss.h"
#include "convolve/peaks.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

/// Edges are cut in pieces this long (radians) at most: a parallel is off its chord by 3e-5 of it.
constexpr double kPiece = 0.015;
/// Pixels this many times the texel's and the pixel's extent away are summed by points.
constexpr double kFar = 2;

double squaredSineAtDistance(double r2) { // of half the angle whose tangent is r
    return 0.5 * r2 / (1 + r2 + std::sqrt(1 + r2));
}

/// The plane that touches the sphere at a direction, x to the east, y to the south.
class Plane {
public:
    explicit Plane(const V3d& d) : out_(d) {
        const double psi = std::atan2(d.y, d.x), theta = std::atan2(std::hypot(d.x, d.y), d.z);
        east_ = V3d(-std::sin(psi), std::cos(psi), 0);
        south_ = polarDirection(theta + 0.5 * kPi, psi);
    }
    V2d operator()(const V3d& d) const {
        return V2d(d.dot(east_), d.dot(south_)) / std::max(d.dot(out_), 1e-3);
    }

private:
    V3d out_, east_, south_;
};

double cross(const V2d& a, const V2d& b) {
    return a.x * b.y - a.y * b.x;
}

/// Pixels about a texel.
struct Block {
    const NearField& field;
    NearWeights& weights;
    std::vector<char> near; ///< [rows][columns]: by edges

    double theta(int row) const { return kPi * row / field.height; }
    double psi(int column) const { return 2 * kPi * column / field.width; }
    /// Index of a pixel counted from the first, or -1 outside.
    int at(int row, int column) const {
        if (row < 0 || row >= weights.rows || column < 0) return -1;
        if (column >= weights.columns) {
            if (weights.columns < field.width) return -1;
            column -= weights.columns; // all the way around
        }
        return row * weights.columns + column;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) const {
        if (isNear(pixel)) weights.weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// A piece a b of an edge in a plane.
struct EdgePiece {
    int before, after; ///< the pixels that it divides, -1 outside the block
    V2d a, b;
    bool origin_before; ///< whether the plane's origin lies on the side of `before`
};

/// Calls visit(piece) for every piece of an edge of a near pixel within `radius` of the plane's
/// origin: parallels westwards with the pixel in the north before them, meridians southwards with
/// that in the west. From a to b `before` is on the left, x going to y.
template <class Visit>
void forEachEdge(const Block& block, const V3d& origin, double radius, const Visit& visit) {
    const Plane plane(origin);
    const NearWeights& w = block.weights;
    const double theta0 = std::atan2(std::hypot(origin.x, origin.y), origin.z);
    const double psi0 = std::atan2(origin.y, origin.x);
    const auto along = [&](EdgePiece piece, double theta, double psi, double dtheta, double dpsi) {
        if (!block.isNear(piece.before) && !block.isNear(piece.after)) return;
        const double length = std::max(std::abs(dtheta), std::abs(dpsi) * std::sin(theta));
        const int n = std::max(1, static_cast<int>(std::ceil(length / kPiece)));
        const double room = radius + length / n;
        V3d from = polarDirection(theta, psi);
        for (int k = 1; k <= n; ++k) {
            const V3d to = polarDirection(theta + dtheta * k / n, psi + dpsi * k / n);
            if ((from - origin).length2() < room * room) {
                piece.a = plane(from);
                piece.b = plane(to);
                visit(piece);
            }
            from = to;
        }
    };
    const double row_step = block.theta(1), column_step = block.psi(1);
    for (int j = 0; j <= w.rows; ++j) {
        const double theta = block.theta(w.row + j);
        if (std::abs(theta - theta0) > radius || w.row + j == 0 || w.row + j == block.field.height)
            continue;
        for (int i = 0; i < w.columns; ++i)
            along({block.at(j - 1, i), block.at(j, i), {}, {}, theta0 < theta}, theta,
                  block.psi(w.column + i + 1), 0, -column_step);
    }
    const bool all_around = w.columns == block.field.width;
    for (int i = 0; i <= w.columns - (all_around ? 1 : 0); ++i) {
        const double psi = block.psi(w.column + i);
        const bool west = std::remainder(psi0 - psi, 2 * kPi) < 0;
        for (int j = 0; j < w.rows; ++j)
            along({block.at(j, i == 0 && all_around ? w.columns - 1 : i - 1), block.at(j, i), {},
                   {}, west},
                  block.theta(w.row + j), psi, row_step, 0);
    }
}

/// Adds share * (the kernel's mass over each near pixel as seen from a direction).
void addMasses(const Block& block, const V3d& direction, double share) {
    const NearField& field = block.field;
    const double mass = field.kernel.mass;
    // Summed around a pixel, dchi is 2 pi where the direction lies in it and else 0; without m
    // dchi, edges beyond the reach need not be summed.
    const double theta = std::atan2(std::hypot(direction.x, direction.y), direction.z);
    const double psi = std::atan2(direction.y, direction.x);
    int column = static_cast<int>(std::floor(psi / block.psi(1))) - block.weights.column;
    column = ((column % field.width) + field.width) % field.width;
    const int row = std::min(static_cast<int>(theta / block.theta(1)), field.height - 1);
    block.add(block.at(row - block.weights.row, column), share * mass);
    forEachEdge(block, direction, field.kernel.reach, [&](const EdgePiece& piece) {
        const double length = (piece.b - piece.a).length();
        if (length == 0) return;
        const V2d along = (piece.b - piece.a) / length;
        // Of a parallel's chord the origin may be on the wrong side, by next to nothing.
        const double distance = std::max(std::abs(cross(piece.a, along)), 1e-15);
        const double d = piece.origin_before ? distance : -distance;
        const double from = piece.a.dot(along), to = piece.b.dot(along);
        const double angle = field.table.angle(d, from, to) -
                             mass * (std::atan(to / d) - std::atan(from / d));
        block.add(piece.before, share * angle / (2 * kPi));
        block.add(piece.after, -share * angle / (2 * kPi));
    });
}

/// int over the edge e0 e1 of B over the edge a b.
double flowAcross(const NearField& field, const V2d& e0, const V2d& e1, const V2d& a,
                  const V2d& b) {
    const double length = (e1 - e0).length(), other = (b - a).length();
    if (length == 0 || other == 0) return 0;
    const V2d e = (e1 - e0) / length, f = (b - a) / other, normal(-f.y, f.x);
    // At the place x on e: distance d from the line of a b, a and b at s_a and s_b along it.
    const double d0 = (e0 - a).dot(normal), slope = e.dot(normal);
    const double s_a0 = (a - e0).dot(f), s_b0 = (b - e0).dot(f), drift = -e.dot(f);
    // Where the integrand changes: beside a, beside b, and where e crosses a b.
    struct Site {
        double place, distance;
    };
    std::array<Site, 3> sites{Site{(a - e0).dot(e), std::abs(cross(e, a - e0))},
                              Site{(b - e0).dot(e), std::abs(cross(e, b - e0))},
                              Site{0, 1e3}};
    if (std::abs(slope) > 1e-9) {
        const double place = -d0 / slope;
        const bool crosses = s_a0 + place * drift <= 0 && s_b0 + place * drift >= 0;
        if (crosses) sites[2] = {place, 0};
    }
    std::array<double, 5> cuts{0, length, length, length, length};
    for (std::size_t i = 0; i < 3; ++i)
        if (sites[i].distance < 1e2) cuts[i + 1] = std::clamp(sites[i].place, 0.0, length);
    std::ranges::sort(cuts);
    const GaussRule& rule = gaussRule(4);
    const auto piece = [&](const auto& self, double from, double to) -> double {
        const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
        double nearest = 1e3;
        for (const Site& site : sites)
            nearest = std::min(nearest, std::max(std::abs(middle - site.place), site.distance));
        if (2 * half > 1.5 * (field.kernel.width + nearest))
            return self(self, from, middle) + self(self, middle, to);
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double x = middle + half * rule.nodes[i], d = d0 + x * slope;
            if (std::abs(d) >= field.kernel.reach) continue;
            sum += rule.weights[i] * field.table.flow(d, s_a0 + x * drift, s_b0 + x * drift);
        }
        return half * sum;
    };
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        if (cuts[i + 1] > cuts[i]) sum += piece(piece, cuts[i], cuts[i + 1]);
    return sum;
}

/// Adds share * (what flows into each near pixel across the texel's edge from e0 to e1); `centre`
/// is the texel's.
void addFlow(const Block& block, const V3d& e0, const V3d& e1, const V3d& centre, double share) {
    const V3d middle = (e0 + e1).normalized();
    const Plane plane(middle);
    const V2d from = plane(e0), to = plane(e1), e = (to - from).normalized();
    // East, south and out are a left-handed frame.
    const V2d outward = V2d(-e.y, e.x) * (e0.cross(e1).dot(centre) > 0 ? 1 : -1);
    const double radius = block.field.kernel.reach + 0.5 * (to - from).length();
    forEachEdge(block, middle, radius, [&](const EdgePiece& piece) {
        const V2d along = (piece.b - piece.a).normalized();
        const double facing = outward.dot(V2d(along.y, -along.x)); // out of `before`
        if (std::abs(facing) < 1e-12) return;
        const double flow =
            share * facing * flowAcross(block.field, from, to, piece.a, piece.b);
        block.add(piece.before, -flow);
        block.add(piece.after, flow);
    });
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
                               square(east.x)) / 3,
                         xy = (texel.a.x * texel.a.y + texel.b.x * texel.b.y + south.x * south.y +
                               east.x * east.y) / 3,
                         yy = (square(texel.a.y) + square(texel.b.y) + square(south.y) +
                               square(east.y)) / 3;
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
    const Plane plane(centre);
    const auto halfAxis = [&](V2d offset) { return plane(texelPlace(map, x, y, offset)); };
    addFar(block, centre,
           {halfAxis(V2d(0.5 * footprint.scale, 0)), halfAxis(V2d(0, 0.5 * footprint.scale))},
           extent);
    if (flows) {
        const double solid_angle = texelSolidAngle(map.layout, map.width, map.height, x, y);
        for (std::size_t i = 0; i < outline.size(); ++i)
            addFlow(block, outline[i], outline[(i + 1) % outline.size()], centre, 1 / solid_angle);
    } else {
        const RowPoints points = texelPoints(map, x, y, footprint);
        for (std::size_t i = 0; i < points.u.size(); ++i)
            addMasses(block, polarDirection(kPi * points.v[i], 2 * kPi * points.u[i]),
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
