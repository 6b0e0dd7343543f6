// How a light looks at what casts shadows: the matrices of shadow maps.
#pragma once

#include "lights/scene_light.h"
#include "render/mesh.h"

#include <Imath/ImathMatrix.h>

#include <span>
#include <vector>

namespace ibl {

using Imath::M44d;

/// What casts shadows, as far as its maps are fitted to it: points, or, where there are none, all
/// of a sphere.
struct Caster {
    V3d centre{0, 0, 0};
    double radius = 1; ///< of a sphere about the centre that holds everything
    std::span<const V3f> points;
};

/// That of points, which must outlive it.
Caster casterOf(std::span<const V3f> points);

/// One shadow map: row vectors p M, as Imath multiplies. All of the caster lies within its edges,
/// two texels and more away from them, and within its depth.
struct ShadowView {
    M44d clip_from_world; ///< for drawing the map
    M44d map_from_world;  ///< after division by w: x and y in texels, depth 0 to 1
    M44d world_from_map;  ///< its inverse
    /// Largest side of a texel, per unit of distance from the light where `perspective`.
    double texel = 0;
    bool perspective = false;
};

/// The maps of size x size texels, 16 or more, that a light needs: one, orthographic for a
/// directional light and perspective otherwise; but six about a point or spot light that stands
/// within the caster's sphere or close to it: those that look along +X -X +Y -Y +Z -Z.
std::vector<ShadowView> shadowViews(const SceneLight& light, const Caster& caster, int size);

} // namespace ibl
