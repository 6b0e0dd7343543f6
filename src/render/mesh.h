// Objects to show: triangle meshes, built in or from a Wavefront OBJ file, and the exact sphere.
#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

using Imath::Box3f;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

/// Triangles, three indices each, counter-clockwise seen from outside.
struct Mesh {
    std::vector<V3f> positions;
    std::vector<V3f> normals; ///< unit, outward; one a position
    std::vector<std::uint32_t> indices;
};

/// What is drawn: a mesh, or, where there is none, the unit sphere at the origin, which is
/// intersected in every sample and so has its exact outline and normals at any size.
struct Object {
    std::optional<Mesh> mesh;
};

/// Names of the built-in objects, in the order in which they are shown to users.
std::span<const std::string_view> builtinObjectNames();

/// The built-in object of that name, if there is one. Each is centred on the origin; sphere, cube
/// and dodecahedron have the unit sphere as circumscribed sphere, torus and teapot touch it from
/// inside with their farthest point.
std::optional<Object> builtinObject(std::string_view name);

/// The triangles of a Wavefront OBJ file, where it says they are. Polygons are cut into triangles,
/// materials and texture coordinates are passed over. Normals that the file does not give are
/// computed: the mean of the faces about a vertex weighted by their angle there. Triangles without
/// area are dropped, and triangles wound against their own normals turned over.
/// Throws Error (input) for a file that cannot be read, holds no triangle or refers to a vertex
/// that it does not have, and for coordinates that are not finite.
Mesh loadObj(const std::string& path);

/// A box around the object.
Box3f bounds(const Object& object);

} // namespace ibl
