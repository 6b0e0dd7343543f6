// Objects from files.
#pragma once

#include "render/camera.h"
#include "render/mesh.h"

#include <string>
#include <vector>

namespace ibl {

/// A perspective camera of a file.
struct NamedCamera {
    std::size_t number = 0; ///< in the file, where not all need be in the scene, or of this kind
    std::string name;
    Camera camera;
};

struct ObjectFile {
    Object object;
    std::vector<NamedCamera> cameras; ///< of glTF
    std::vector<std::string> files;   ///< names read, for dependency files
    std::vector<std::string> notes;   ///< one line each: what a user should know of how it was read
};

/// Reads an object: Wavefront OBJ (with its materials), PLY, or glTF 2.0 (.gltf, .glb), told by its
/// first bytes. Polygons are cut into triangles, those without area are dropped, and normals that
/// the file does not give are computed: the mean of the faces about a vertex, weighted by their
/// angle there (Thuermer and Wuethrich 1998).
/// Throws Error (input) for a file that cannot be read, holds no triangle, refers to what it does
/// not have, or has coordinates that are not finite.
ObjectFile readObject(const std::string& path, int threads = 0);

} // namespace ibl
