// Depth and normals of a mesh's faces that look away from the eye, for shaders/refraction.glsl.
// Internal to the render layer.
#pragma once

#include "render/camera.h"
#include "render/gl_objects.h"

namespace ibl {

/// The whole frame, at its resolution or, where that is more than 2048 a side, at less.
struct FarSide {
    V2i size;
    Texture texture; ///< outward normal; depth along the view, 0 where there is none
    Renderbuffer depth;
    Framebuffer target;
    Program program;
};
FarSide makeFarSide(const V2i& frame, Program program);

/// Between the two, what is drawn with its program is the far side; then it is texture 19.
void beginFarSide(const FarSide& far_side);
void endFarSide(const FarSide& far_side);

} // namespace ibl
