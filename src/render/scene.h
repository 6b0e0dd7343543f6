// What is drawn: the object, what it is made of, the light and what is behind it.
#pragma once

#include "image/image.h"
#include "lights/scene_light.h"
#include "panorama/panorama.h"
#include "render/material.h"
#include "render/mesh.h"
#include "render/placement.h"

#include <optional>
#include <variant>
#include <vector>

namespace ibl {

/// What is seen beside the object.
struct ProbeBackground {};     ///< the probe itself
struct NoBackground {};        ///< nothing: the picture has premultiplied alpha
using ColorBackground = V3f;   ///< linear radiance
using ImageBackground = Image; ///< linear radiance, 3 channels, of the frame's own size
using Background = std::variant<ProbeBackground, NoBackground, ColorBackground, ImageBackground>;

/// A horizontal plane, without end and seen from above, that shows the object's shadow and nothing
/// else: what is behind the object is what it looks like without the object (differential
/// rendering, Debevec 1998). It casts no shadow: what lights the object from below is taken as
/// light that the ground sends there.
struct Ground {
    double height = -1; ///< y; no part of the object lies below
    /// With it, the light that the object takes away is albedo / pi times the irradiance that it
    /// keeps off, where the background is that of such a ground or brighter. Elsewhere and without
    /// it, the ground reflects as it looks in each pixel: the background is scaled by the
    /// irradiance with over that without the object.
    std::optional<V3d> albedo;
};

/// What became of the scene's lights in a picture.
struct LightCounts {
    int given = 0;
    int drawn = 0;
    int black = 0;  ///< not drawn: without strength
    int unseen = 0; ///< not drawn: behind all that is seen
};

/// The probe convolved with GGX's lobe.
struct SpecularMaps {
    std::vector<Panorama> levels; ///< `faces`, level k's edge that of the first >> k
    double first = 0, last = 0;   ///< roughness of the outer levels, even steps between them
};

/// Between a mesh's vertices: normals (Phong 1975), colours (Gouraud 1971), or neither: the
/// triangle's own normal.
enum class Interpolation { phong, gouraud, flat };

/// All that is uploaded once and drawn from any number of cameras. What the picture does not need
/// may be absent: a diffuse object before no probe needs no probe, a mirror no diffuse map.
struct Scene {
    const Panorama* probe = nullptr;   ///< radiance
    const Panorama* diffuse = nullptr; ///< irradiance / pi, such as prefilter() gives
    const SpecularMaps* specular = nullptr;
    /// (bias, total) of splitSumTable() with `multiscatter`: roughness down from 0 to 1, or a row.
    const Image* split_sum = nullptr;
    /// The probe in `faces`, each level the area-filtered half of the one before.
    const std::vector<Panorama>* probe_levels = nullptr;
    Object object;
    Material material;
    Interpolation interpolation = Interpolation::phong;
    Background background;
    std::vector<SceneLight> lights; ///< of lit materials and of the ground
    std::optional<Ground> ground;
    Turn turn; ///< of the probe, with all maps made of it
    Placement placement;
};

/// Which of these maps a material reads; `far_side` is made by the renderer.
struct MapNeeds {
    bool probe = false, diffuse = false, specular = false, split_sum = false, probe_levels = false;
    bool far_side = false;
};
MapNeeds mapNeeds(const Material& material);

/// Whether the scene needs the probe's radiance, and its diffuse map, to be drawn.
bool needsProbe(const Material& material, const Background& background);
bool needsDiffuse(const Material& material);

/// The least y of an object that is placed so.
double lowestPoint(const Object& object, const Placement& placement);

} // namespace ibl
