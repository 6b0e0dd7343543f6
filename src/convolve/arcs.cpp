#include "convolve/arcs.h"

#include <numbers>

namespace ibl {
namespace {

ArcPoint pointOn(const Arc& arc, double s, double weight) {
    const V3d bend = (arc.a + arc.b) * 0.5 - arc.m, chord = (arc.b - arc.a) * 0.5;
    return {arc.m + (chord + bend * s) * s, (chord + bend * (2 * s)) * weight};
}

} // namespace

std::array<ArcPoint, 2> twoPoints(const Arc& arc) {
    constexpr double kNode = std::numbers::inv_sqrt3;
    return {pointOn(arc, -kNode, 1), pointOn(arc, kNode, 1)};
}

std::array<ArcPoint, 3> threePoints(const Arc& arc) {
    constexpr double kNode = 0.774596669241483377; // sqrt(3/5)
    return {pointOn(arc, -kNode, 5.0 / 9), pointOn(arc, 0, 8.0 / 9), pointOn(arc, kNode, 5.0 / 9)};
}

} // namespace ibl
