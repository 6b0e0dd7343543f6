#include "convolve/near_flow.h"

#include "convolve/gauss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace ibl {
namespace {

/// The plane that touches the sphere at a direction; right-handed as seen from outside.
class Plane {
public:
    explicit Plane(const V3d& d) : out_(d) {
        const double s = std::hypot(d.x, d.y);
        east_ = s > 0 ? V3d(-d.y / s, d.x / s, 0) : V3d(0, 1, 0);
        north_ = out_.cross(east_);
    }
    V2d operator()(const V3d& d) const {
        return V2d(d.dot(east_), d.dot(north_)) / std::max(d.dot(out_), 1e-3);
    }

private:
    V3d out_, east_, north_;
};

double cross(const V2d& a, const V2d& b) {
    return a.x * b.y - a.y * b.x;
}

/// A piece's chord in a plane.
struct Segment {
    V2d a, along;
    double length;
};

Segment segmentOf(const Plane& plane, const Arc& arc) {
    Segment segment{plane(arc.a), plane(arc.b), 0};
    segment.along -= segment.a;
    segment.length = segment.along.length();
    segment.along /= std::max(segment.length, 1e-300);
    return segment;
}

template <std::size_t n>
double pairSum(const RadialTable& potential, const std::array<ArcPoint, n>& e,
               const std::array<ArcPoint, n>& f) {
    double sum = 0;
    for (const ArcPoint& x : e)
        for (const ArcPoint& y : f)
            sum += x.along.dot(y.along) * potential((x.at - y.at).length2());
    return sum;
}

/// Of sin^2 t dchi about points x.
template <std::size_t n>
double turnSum(const RadialTable& swirl, std::span<const TexelPoint> points,
               const std::array<ArcPoint, n>& f) {
    double sum = 0;
    for (const ArcPoint& y : f) {
        const V3d turn = y.at.cross(y.along);
        for (const TexelPoint& x : points)
            sum += x.share * x.at.dot(turn) * swirl((x.at - y.at).length2());
    }
    return sum;
}

/// Gauss points to a piece of e, and the piece's length over the distance of the nearest end of f.
constexpr int kFlowPoints = 6;
constexpr double kFlowPiece = 1.5;

/// flowAcross of Phi for straight ones that touch or nearly do: B of edge_table.h for the inner
/// integral, over e Gauss points that stand the closer the nearer f's ends are.
double flowInPlane(const NearField& field, const Segment& e, const Segment& f) {
    const NearKernel& kernel = field.kernel;
    const V2d between = f.a - e.a, normal(-f.along.y, f.along.x);
    // At the place x on e: distance d from f's line, f's ends at s and s + f.length along it.
    const double d0 = -between.dot(normal), slope = e.along.dot(normal);
    const double s0 = between.dot(f.along), drift = -e.along.dot(f.along);
    // Where the integrand changes: beside f's ends, and where e crosses f.
    struct Site {
        double place, distance;
    };
    const V2d to_end = between + f.along * f.length;
    std::array<Site, 3> sites{Site{between.dot(e.along), std::abs(cross(e.along, between))},
                              Site{to_end.dot(e.along), std::abs(cross(e.along, to_end))},
                              Site{-1, 1e3}};
    if (std::abs(slope) > 1e-9) {
        const double place = -d0 / slope, s = s0 + place * drift;
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
    std::array<double, 5> cuts{0, e.length, e.length, e.length, e.length};
    for (std::size_t i = 0; i < 3; ++i)
        if (sites[i].place > 0 && sites[i].place < e.length && sites[i].distance < e.length)
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
                const double s = s0 + x * drift;
                if (std::abs(d) < kernel.reach)
                    sum += half * rule.weights[k] * field.table.flow(d, s, s + f.length);
            }
            from = to;
        }
    }
    return sum * e.along.dot(f.along);
}

/// Whether it may be taken as straight. Where a quadratic turns round, its halves are as bent as
/// it: what is so short does not matter.
bool isFlat(const NearField& field, const Arc& arc, double length) {
    if (length < 1e-6) return true;
    return length <= field.rules.flat && arc.sagitta() <= field.rules.bend * length;
}

/// How long pieces may be, by the rules, whose middles are `between` apart and that reach `half`
/// from there together. Phi is a logarithm from 0 on, Psi is smooth over the kernel's width.
double roomBetween(const NearField& field, Potential potential, double between, double half) {
    const double distance = between - half;
    if (potential == Potential::withoutArea) return distance;
    return std::min(std::max(distance, 0.0) + 0.5 * field.kernel.width,
                    roomBesideRing(field, between, half));
}

/// int_e int_f Phi dx . dy, or of Psi.
double contourSum(const NearField& field, Potential potential, const Arc& e, const Arc& f) {
    const double e_length = e.length(), f_length = f.length();
    const double between = (e.m - f.m).length(), half = 0.5 * (e_length + f_length);
    const double distance = between - half;
    const double size = std::max(e_length, f_length);
    if (e_length == 0 || f_length == 0) return 0;
    const bool compact = potential == Potential::withoutArea;
    if (compact && distance > field.kernel.reach) return 0;
    const RadialTable& table = compact ? field.phi : field.psi;
    const double room = roomBetween(field, potential, between, half);
    if (room > field.rules.two * size) return pairSum(table, twoPoints(e), twoPoints(f));
    if (room > field.rules.three * size) return pairSum(table, threePoints(e), threePoints(f));
    bool split_e = e_length >= f_length;
    if (compact) {
        const bool e_flat = isFlat(field, e, e_length), f_flat = isFlat(field, f, f_length);
        if (e_flat && f_flat) {
            const Plane plane(e.m);
            return flowInPlane(field, segmentOf(plane, e), segmentOf(plane, f));
        }
        split_e = f_flat || (split_e && !e_flat);
    }
    const auto [first, second] = (split_e ? e : f).halves();
    if (split_e)
        return contourSum(field, potential, first, f) + contourSum(field, potential, second, f);
    return contourSum(field, potential, e, first) + contourSum(field, potential, e, second);
}

} // namespace

double flowAcross(const NearField& field, Potential potential, const Texel& texel, const Arc& f) {
    const bool compact = potential == Potential::withoutArea;
    const double length = f.length(), size = std::max(1.4 * texel.radius, length);
    const double between = (f.m - texel.centre).length(), half = 0.5 * length + texel.radius;
    const double distance = between - half;
    if (length == 0 || (compact && distance > field.kernel.reach)) return 0;
    const RadialTable& swirl = compact ? field.outer_swirl : field.swirl;
    const double room = roomBetween(field, potential, between, half);
    if (room > field.rules.two * size) return turnSum(swirl, texel.four, twoPoints(f));
    if (room > field.rules.three * size) return turnSum(swirl, texel.nine, threePoints(f));
    double sum = 0;
    for (const Arc& e : texel.outline)
        sum -= contourSum(field, potential, e, f);
    return sum / texel.solid_angle;
}

double flowAcross(const NearField& field, const V3d& x, const Arc& f) {
    const double length = f.length();
    const double between = (x - f.m).length();
    const double room = std::max(between - 0.5 * length, 0.0) + 0.5 * field.kernel.width;
    const double ring_room = roomBesideRing(field, between, 0.5 * length);
    if (length == 0) return 0;
    if (std::min(room, ring_room) > field.rules.three * length) {
        const TexelPoint point{x, 1};
        return turnSum(field.swirl, {&point, 1}, threePoints(f));
    }
    if (ring_room < room || !isFlat(field, f, length)) {
        const auto [first, second] = f.halves();
        return flowAcross(field, x, first) + flowAcross(field, x, second);
    }
    const Plane plane(x);
    const Segment s = segmentOf(plane, f);
    const double d = cross(s.a, s.along), from = s.a.dot(s.along);
    double sum = field.table.angle(d, from, from + s.length);
    // sin^2(t/2) dchi = x . (y x dy) / (2 (1 + x . y)), of which all is smooth here.
    for (const ArcPoint& y : twoPoints(f))
        sum -= 0.5 * field.kernel.mass * x.dot(y.at.cross(y.along)) / (1 + x.dot(y.at));
    return sum / (2 * kPi);
}

} // namespace ibl
