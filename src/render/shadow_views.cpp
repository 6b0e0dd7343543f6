#include "render/shadow_views.h"

#include <algorithm>
#include <array>
#include <cmath>

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

std::array<V3d, 8> corners(const Box3f& box) {
    std::array<V3d, 8> points;
    for (std::size_t i = 0; i < 8; ++i) {
        points[i] = {i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                     i & 4 ? box.max.z : box.min.z};
    }
    return points;
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
    const V3d centre(caster.box.center());
    const V3d half = V3d(caster.box.size()) * 0.5;
    // The box and the sphere both hold the caster: the nearer of the two along each axis.
    const auto extent = [&](const V3d& axis) {
        const double of_box = std::abs(axis.x) * half.x + std::abs(axis.y) * half.y +
                              std::abs(axis.z) * half.z;
        return std::max(std::min(of_box, caster.radius), 1e-3 * caster.radius);
    };
    const double widen = size / (size - 2 * kMargin);
    const double x = extent(frame.right) * widen, y = extent(frame.up) * widen;
    const double z = extent(towards) * 1.01;
    const std::array<V3d, 4> columns{frame.right / x, frame.up / y, towards / -z, V3d(0)};
    ShadowView view = viewOf(columns,
                             {-columns[0].dot(centre), -columns[1].dot(centre),
                              -columns[2].dot(centre), 1},
                             size);
    view.texel = 2 * std::max(x, y) / size;
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
    ShadowView view = viewOf(columns,
                             {-columns[0].dot(eye), -columns[1].dot(eye),
                              -columns[2].dot(eye) + b, -along.dot(eye)},
                             size);
    view.texel = 2 * std::max(tan_x, tan_y) / size;
    view.perspective = true;
    return view;
}

ShadowView fittedPerspective(const V3d& eye, const Caster& caster, int size) {
    const V3d centre(caster.box.center());
    const V3d offset = eye - centre;
    const double distance = offset.length();
    const Frame frame = frameAbout(offset / distance);
    const double of_sphere =
        caster.radius / std::sqrt(distance * distance - caster.radius * caster.radius);
    double tan_x = 0, tan_y = 0;
    for (const V3d& corner : corners(caster.box)) {
        const V3d q = corner - eye;
        const double depth = -frame.towards.dot(q);
        if (depth <= 0) {
            tan_x = tan_y = of_sphere;
            break;
        }
        tan_x = std::max(tan_x, std::abs(frame.right.dot(q)) / depth);
        tan_y = std::max(tan_y, std::abs(frame.up.dot(q)) / depth);
    }
    const auto bounded = [&](double t) {
        return std::max(std::min(t, of_sphere), 1e-3 * of_sphere);
    };
    const Depths depths{0.99 * (distance - caster.radius), 1.01 * (distance + caster.radius)};
    return perspective(eye, frame, bounded(tan_x), bounded(tan_y), depths, size);
}

} // namespace

Caster casterOf(const Mesh& mesh) {
    Caster caster;
    for (const V3f& p : mesh.positions)
        caster.box.extendBy(p);
    const V3f centre = caster.box.center();
    double square = 0;
    for (const V3f& p : mesh.positions)
        square = std::max(square, static_cast<double>((p - centre).length2()));
    caster.radius = std::max(std::sqrt(square) * (1 + 1e-6), 1e-30);
    return caster;
}

std::vector<ShadowView> shadowViews(const SceneLight& light, const Caster& caster, int size) {
    if (light.type == LightType::directional) {
        return {orthographic(light.direction, caster, size)};
    }
    const double distance = (light.position - V3d(caster.box.center())).length();
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
