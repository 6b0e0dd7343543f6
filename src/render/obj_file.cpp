// Wavefront OBJ through tinyobjloader.
#include "render/mesh.h"

#include "core/error.h"

#include <tiny_obj_loader.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <unordered_map>
#include <utility>

namespace ibl {
namespace {

using Corner = tinyobj::index_t;
using Triangle = std::array<Corner, 3>;

V3f pointAt(const std::vector<float>& values, int index) {
    const auto i = 3 * static_cast<std::size_t>(index);
    return {values[i], values[i + 1], values[i + 2]};
}

V3d faceNormal(const tinyobj::attrib_t& attributes, const Triangle& t) {
    const V3d a(pointAt(attributes.vertices, t[0].vertex_index));
    const V3d b(pointAt(attributes.vertices, t[1].vertex_index));
    const V3d c(pointAt(attributes.vertices, t[2].vertex_index));
    return (b - a).cross(c - a);
}

bool allFinite(const std::vector<float>& values) {
    for (const float value : values) {
        if (!std::isfinite(value)) return false;
    }
    return true;
}

struct ObjFile {
    tinyobj::attrib_t attributes;
    std::vector<Triangle> triangles; // with area; normal index -1 where the file gives none
};

void requireIndices(const std::string& path, const ObjFile& obj, const Corner& corner) {
    const auto points = static_cast<int>(obj.attributes.vertices.size() / 3);
    const auto normals = static_cast<int>(obj.attributes.normals.size() / 3);
    if (corner.vertex_index < 0 || corner.vertex_index >= points) {
        throw inputError(path, "a face refers to a vertex that the file does not have; export it "
                               "again");
    }
    if (corner.normal_index >= normals) {
        throw inputError(path, "a face refers to a normal that the file does not have; export it "
                               "again");
    }
}

ObjFile parse(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        throw inputError(path, "is a directory; give an OBJ file");
    }
    std::ifstream file(path);
    if (!file) throw inputError(path, "cannot be read; check name and permissions");

    ObjFile obj;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    const bool loaded = tinyobj::LoadObj(&obj.attributes, &shapes, &materials, &warning, &error,
                                         &file, nullptr, true, false);
    if (!loaded || file.bad()) {
        throw inputError(path,
                         (error.empty() ? "is no OBJ file" : error.substr(0, error.find('\n'))) +
                             "; export it again");
    }
    // The loader checks the corners of polygons, which it cuts, and leaves those of triangles to
    // us.
    if (warning.find("invalid vertex index") != warning.npos)
        requireIndices(path, obj, {-1, -1, -1});
    if (!allFinite(obj.attributes.vertices) || !allFinite(obj.attributes.normals)) {
        throw inputError(path, "has a coordinate that is not finite; export it again");
    }
    for (const tinyobj::shape_t& shape : shapes) {
        for (std::size_t i = 0; i + 2 < shape.mesh.indices.size(); i += 3) {
            Triangle t{shape.mesh.indices[i], shape.mesh.indices[i + 1], shape.mesh.indices[i + 2]};
            for (Corner& corner : t) {
                requireIndices(path, obj, corner);
                const bool usable =
                    corner.normal_index >= 0 &&
                    pointAt(obj.attributes.normals, corner.normal_index).length() > 0;
                if (!usable) corner.normal_index = -1;
            }
            if (faceNormal(obj.attributes, t).length() > 0) obj.triangles.push_back(t);
        }
    }
    if (obj.triangles.empty()) throw inputError(path, "holds no triangle; give a mesh with faces");
    return obj;
}

// The normal at each vertex: the mean of its faces' normals, weighted by their angle there
// (Thuermer and Wuethrich 1998), which does not depend on how a face was cut into triangles.
std::vector<V3d> smoothNormals(const ObjFile& obj) {
    std::vector<V3d> normals(obj.attributes.vertices.size() / 3, V3d(0));
    for (const Triangle& t : obj.triangles) {
        const V3d face = faceNormal(obj.attributes, t).normalized();
        for (std::size_t k = 0; k < 3; ++k) {
            const auto at = [&](std::size_t i) {
                return V3d(pointAt(obj.attributes.vertices, t[i % 3].vertex_index));
            };
            const V3d a = at(k + 1) - at(k), b = at(k + 2) - at(k);
            const double angle = std::atan2(a.cross(b).length(), a.dot(b));
            normals[static_cast<std::size_t>(t[k].vertex_index)] += face * angle;
        }
    }
    return normals;
}

} // namespace

Mesh loadObj(const std::string& path) {
    const ObjFile obj = parse(path);
    const std::vector<V3d> smooth = smoothNormals(obj);
    Mesh mesh;
    mesh.indices.reserve(3 * obj.triangles.size());
    std::unordered_map<std::uint64_t, std::uint32_t> seen; // (vertex, normal) -> index in the mesh
    const auto vertexOf = [&](const Corner& corner, const V3d& face) {
        const auto key = static_cast<std::uint64_t>(corner.vertex_index) << 32 |
                         static_cast<std::uint32_t>(corner.normal_index);
        const auto [place, is_new] =
            seen.try_emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
            V3d normal = corner.normal_index >= 0
                             ? V3d(pointAt(obj.attributes.normals, corner.normal_index))
                             : smooth[static_cast<std::size_t>(corner.vertex_index)];
            if (!(normal.length() > 1e-9)) normal = face; // faces back to back cancel
            mesh.positions.push_back(pointAt(obj.attributes.vertices, corner.vertex_index));
            mesh.normals.emplace_back(normal.normalized());
        }
        return place->second;
    };
    for (const Triangle& t : obj.triangles) {
        const V3d face = faceNormal(obj.attributes, t);
        std::uint32_t a = vertexOf(t[0], face), b = vertexOf(t[1], face), c = vertexOf(t[2], face);
        const V3d shading(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]);
        const bool given =
            t[0].normal_index >= 0 && t[1].normal_index >= 0 && t[2].normal_index >= 0;
        if (given && face.dot(shading) < 0) std::swap(b, c);
        mesh.indices.insert(mesh.indices.end(), {a, b, c});
    }
    return mesh;
}

} // namespace ibl
