// What is drawn: the object, what it is made of, the light and what is behind it.
#pragma once

#include "image/image.h"
#include "panorama/panorama.h"
#include "render/material.h"
#include "render/mesh.h"
#include "render/placement.h"

#include <variant>

namespace ibl {

/// What is seen beside the object.
struct ProbeBackground {};     ///< the probe itself
struct NoBackground {};        ///< nothing: the picture has premultiplied alpha
using ColorBackground = V3f;   ///< linear radiance
using ImageBackground = Image; ///< linear radiance, 3 channels, of the frame's own size
using Background = std::variant<ProbeBackground, NoBackground, ColorBackground, ImageBackground>;

/// All that is uploaded once and drawn from any number of cameras. What the picture does not need
/// may be absent: a diffuse object before no probe needs no probe, a mirror no diffuse map.
struct Scene {
    const Panorama* probe = nullptr;   ///< radiance
    const Panorama* diffuse = nullptr; ///< irradiance / pi, such as prefilter() gives
    Object object;
    Material material;
    Background background;
    Turn turn; ///< of the probe, with all maps made of it
    Placement placement;
};

/// Whether the scene needs the probe's radiance, and its diffuse map, to be drawn.
bool needsProbe(const Material& material, const Background& background);
bool needsDiffuse(const Material& material);

} // namespace ibl
