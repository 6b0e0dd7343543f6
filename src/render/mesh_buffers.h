// A mesh on the device and its way into the frame. Internal to the render layer.
#pragma once

#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/mesh.h"

#include <Imath/ImathMatrix.h>

#include <optional>

namespace ibl {

using Imath::M44d;

struct MeshBuffers {
    Buffer positions, normals, texcoords, indices;
    VertexArray array;
};

/// Throws Error when there are more indices than one draw call takes (usage) or no memory
/// (missing).
MeshBuffers uploadMesh(const Mesh& mesh);

/// World to clip space for a frame whose row 0 is its upper one (y is down), the samples `jitter`
/// from the pixels' centres, near and far plane about the box; for row vectors, which is GL's
/// column-major order in memory. Nothing when the box is behind the camera.
std::optional<M44d> clipFromWorld(const CameraRays& rays, const Box3f& box, const V2d& jitter);

} // namespace ibl
