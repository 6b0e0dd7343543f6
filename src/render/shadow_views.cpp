#include "render/shadow_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ibl {
namespace {

// Texels between the caster's outline and the map's edges, so that the four texels about any point
// beyond an edge are empty.
constexpr double kMargin = 2;

struct Frame {
    V3d right, up, towards; // orthonormal; `towards` points to the light
};

Frame frameAbout(const V3d& towards) {
    const V3d helper = std::abs(towards.y) < 0.9 ? V3d(0, 1, 0) : V3d(1, 0, 0);
    const V3d right = helper.cross(towards).normalized();
    return {right, towards.cross(right), towards};
}

struct Interval {
    double least = std::numeric_limits<double>::infinity(), most = -least;
};

// Of the caster's points from its centre along an axis, not narrower than a thousandth of it.
Interval extent(const Caster& caster, const V3d& axis) {
    Interval interval;
    for (const V3f& p : caster.points) {
        const double along = axis.dot(V3d(p) - caster.centre);
        interval.least = std::min(interval.least, along);
        interval.most = std::max(interval.most, along);
    }
    if (caster.points.empty()) interval = {-caster.radius, caster.radius};
    const double lacking = 1e-3 * caster.radius - (interval.most - interval.least);
    if (lacking > 0) interval = {interval.least - 0.5 * lacking, interval.most + 0.5 * lacking};
    return interval;
}

// From the columns that give clip x, y, z and w of (p, 1).
ShadowView viewOf(const std::array<V3d, 4>& columns, const std::array<double, 4>& constants,
                  int size) {
    ShadowView view;
    for (int column = 0; column < 4; ++column) {
        const auto c = static_cast<std::size_t>(column);
        for (int row = 0; row < 3; ++row)
            view.clip_from_world[row][column] = columns[c][row];
        view.clip_from_world[3][column] = constants[c];
    }
    M44d texels;
    texels[0][0] = texels[1][1] = texels[3][0] = texels[3][1] = 0.5 * size;
    texels[2][2] = texels[3][2] = 0.5;
    view.map_from_world = view.clip_from_world * texels;
    view.world_from_map = view.map_from_world.inverse();
    return view;
}

ShadowView orthographic(const V3d& towards, const Caster& caster, int size) {
    const Frame frame = frameAbout(towards);
    const double widen = size / (size - 2 * kMargin);
    std::array<V3d, 4> columns{V3d(0), V3d(0), V3d(0), V3d(0)}; // w is 1
    std::array<double, 4> constants{0, 0, 0, 1};
    const std::array<V3d, 3> axes{frame.right, frame.up, -towards};
    double widest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Interval span = extent(caster, axes[i]);
        const double half = 0.5 * (span.most - span.least) * (i < 2 ? widen : 1.01);
        if (i < 2) widest = std::max(widest, half);
        columns[i] = axes[i] / half;
        constants[i] = -(axes[i].dot(caster.centre) + 0.5 * (span.least + span.most)) / half;
    }
    ShadowView view = viewOf(columns, constants, size);
    view.texel = 2 * widest / size;
    return view;
}

struct Depths {
    double nearest, farthest;
};

ShadowView perspective(const V3d& eye, const Frame& frame, double tan_x, double tan_y,
                       const Depths& depths, int size) {
    const V3d along = -frame.towards;
    const double widen = size / (size - 2 * kMargin);
    tan_x *= widen;
    tan_y *= widen;
    const double span = depths.farthest - depths.nearest;
    const double a = (depths.farthest + depths.nearest) / span;
    const double b = -2 * depths.farthest * depths.nearest / span;
    const std::array<V3d, 4> columns{frame.right / tan_x, frame.up / tan_y, along * a, along};
    ShadowView view = viewOf(
        columns,
        {-columns[0].dot(eye), -columns[1].dot(eye), -columns[2].dot(eye) + b, -along.dot(eye)},
        size);
    view.texel = 2 * std::max(tan_x, tan_y) / size;
    view.perspective = true;
    return view;
}

ShadowView fittedPerspective(const V3d& eye, const Caster& caster, int size) {
    const double radius = caster.radius, distance = (eye - caster.centre).length();
    const Frame frame = frameAbout((eye - caster.centre) / distance);
    const double of_sphere = radius / std::sqrt(distance * distance - radius * radius);
    double tan_x = caster.points.empty() ? of_sphere : 1e-3 * of_sphere, tan_y = tan_x;
    for (const V3f& p : caster.points) {
        const V3d q = V3d(p) - eye;
        const double depth = -frame.towards.dot(q);
        tan_x = std::max(tan_x, std::abs(frame.right.dot(q)) / depth);
        tan_y = std::max(tan_y, std::abs(frame.up.dot(q)) / depth);
    }
    return perspective(eye, frame, tan_x, tan_y,
                       {0.99 * (distance - radius), 1.01 * (distance + radius)}, size);
}

} // namespace

Caster casterOf(std::span<const V3f> points) {
    Box3f box;
    for (const V3f& p : points)
        box.extendBy(p);
    Caster caster{V3d(box.center()), 0, points};
    for (const V3f& p : points)
        caster.radius = std::max(caster.radius, (V3d(p) - caster.centre).length2());
    caster.radius = std::max(std::sqrt(caster.radius) * (1 + 1e-6), 1e-30);
    return caster;
}

std::vector<ShadowView> shadowViews(const SceneLight& light, const Caster& caster, int size) {
    if (light.type == LightType::directional) {
        return {orthographic(light.direction, caster, size)};
    }
    const double distance = (light.position - caster.centre).length();
    if (distance > 1.1 * caster.radius) return {fittedPerspective(light.position, caster, size)};
    std::vector<ShadowView> views;
    const Depths depths{1e-3 * caster.radius, 1.01 * (distance + caster.radius)};
    for (int face = 0; face < 6; ++face) {
        V3d along(0);
        along[face / 2] = face % 2 == 0 ? 1 : -1;
        views.push_back(perspective(light.position, frameAbout(-along), 1, 1, depths, size));
    }
    return views;
}

} // namespace ibl
