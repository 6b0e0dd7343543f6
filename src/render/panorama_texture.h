// A panorama on the device, to be read by shaders/lookup.glsl. Internal to the render layer.
#pragma once

#include "panorama/panorama.h"
#include "render/gl_objects.h"

#include <span>
#include <string>
#include <vector>

namespace ibl {

/// Lat-longs stay lat-longs and cubes cubes, texel for texel, in 32-bit floats (radiance above
/// 65504 would be infinite in halves). `lookUp` of the shader then gives what radianceAt() gives.
struct PanoramaTexture {
    Texture texture;
    bool is_cube = true;
    bool border = false; ///< OpenEXR's border rule

    /// NAME_SAMPLER and NAME_BORDER, as shaders/maps.glsl wants them.
    std::vector<std::string> definitions(const std::string& name) const;
};

/// Throws Error (input) when the device has no texture of that size; the subject is `name`.
PanoramaTexture uploadPanorama(const Panorama& panorama, const std::string& name);

/// A cube map of mip levels, interpolated between them. Level k has the layout `faces` and the edge
/// of the first >> k. The same error.
Texture uploadCubeLevels(std::span<const Panorama> levels, const std::string& name);

/// An image's pixels, as they are. The same error.
Texture uploadImage(const Image& image, const std::string& name);

} // namespace ibl
