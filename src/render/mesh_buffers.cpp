#include "render/mesh_buffers.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <limits>

namespace ibl {

MeshBuffers uploadMesh(const Mesh& mesh) {
    if (mesh.indices.size() > static_cast<std::size_t>(std::numeric_limits<GLsizei>::max())) {
        throw Error(ExitCode::usage,
                    "render: the object has more than 715 million triangles; reduce it");
    }
    const auto bytes = [](const auto& v) {
        return static_cast<GLsizeiptr>(v.size() * sizeof v[0]);
    };
    MeshBuffers buffers{makeBuffer(bytes(mesh.positions), mesh.positions.data()),
                        makeBuffer(bytes(mesh.normals), mesh.normals.data()),
                        {},
                        makeBuffer(bytes(mesh.indices), mesh.indices.data()),
                        {}};
    GLuint array = 0;
    glCreateVertexArrays(1, &array);
    buffers.array = VertexArray(array);
    glVertexArrayElementBuffer(array, buffers.indices.id());
    const auto bind = [&](GLuint attribute, const Buffer& source, GLint components) {
        glVertexArrayVertexBuffer(array, attribute, source.id(), 0,
                                  components * static_cast<GLsizei>(sizeof(float)));
        glVertexArrayAttribFormat(array, attribute, components, GL_FLOAT, GL_FALSE, 0);
        glEnableVertexArrayAttrib(array, attribute);
    };
    bind(0, buffers.positions, 3);
    bind(1, buffers.normals, 3);
    if (!mesh.texcoords.empty()) {
        buffers.texcoords = makeBuffer(bytes(mesh.texcoords), mesh.texcoords.data());
        bind(2, buffers.texcoords, 2);
    }
    checkGl("uploading the object");
    return buffers;
}

std::optional<M44d> clipFromWorld(const CameraRays& rays, const Box3f& box, const V2d& jitter) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (int corner = 0; corner < 8; ++corner) {
        const V3d p(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                    corner & 4 ? box.max.z : box.min.z);
        const double depth = rays.forward.dot(p - rays.eye);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    if (farthest <= 0) return std::nullopt;
    farthest *= 1.001;
    nearest = std::max(nearest * 0.999, farthest * 1e-5);

    // Pixel x of a point at q from the eye is centre.x + (q . step_x) / |step_x|^2 / depth.
    const V3d x = rays.step_x / (rays.step_x.length2() * rays.centre.x);
    const V3d y = rays.step_y / (rays.step_y.length2() * rays.centre.y);
    const V3d shift(jitter.x / rays.centre.x, jitter.y / rays.centre.y, 0);
    const double a = (farthest + nearest) / (farthest - nearest);
    const double b = -2 * farthest * nearest / (farthest - nearest);
    const V3d& z = rays.forward;
    const std::array<V3d, 4> rows{x - z * shift.x, y - z * shift.y, z * a, z};
    M44d m;
    for (int row = 0; row < 4; ++row) {
        for (int i = 0; i < 3; ++i)
            m[i][row] = rows[row][i];
        m[3][row] = -rows[row].dot(rays.eye) + (row == 2 ? b : 0);
    }
    return m;
}

} // namespace ibl
