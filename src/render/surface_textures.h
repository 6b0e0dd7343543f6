// What an object's parts are made of, on the device. Internal to the render layer.
#pragma once

#include "render/gl_objects.h"
#include "render/material.h"
#include "render/mesh.h"

#include <string>
#include <vector>

namespace ibl {

struct SurfaceTextures {
    struct Uploaded {
        Texture texture; ///< with mip levels
        bool premultiplied = false;
    };
    std::vector<Uploaded> textures; ///< as Object::textures
    Texture white, flat;            ///< in the place of a texture that a part does not have
    /// Of the kinds of texture that any part has; CUT_OUTS, 0 or 1: alpha says where some part
    /// is.
    std::vector<std::string> definitions;
};

/// Throws Error (input) for an image larger than the device's textures.
SurfaceTextures uploadSurfaces(const Object& object);

/// Makes `program`, of surface.glsl and the material's shader, draw that part.
void bindSurface(const SurfaceTextures& textures, const Program& program, const Material& material,
                 const Surface& surface);

} // namespace ibl
