// Objects to show: triangle meshes, built in or from files, and the exact sphere.
#pragma once

#include "image/image.h"

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
    std::vector<V2f>
        texcoords; ///< one a position, or none; v down, (0, 0) the image's first corner
    std::vector<std::uint32_t> indices;
};

/// How a texture goes on beyond its edges.
enum class Wrap { repeat, mirror, clamp };

struct SurfaceTexture {
    Image image; ///< linear; of 3 channels, or 4, the last an alpha
    Wrap across = Wrap::repeat;
    Wrap down = Wrap::repeat;
    bool premultiplied = false; ///< colours are multiplied by alpha
};

/// As Surface::alpha_cutoff: alpha is how much of the surface there is; the rest shows what is
/// behind it. Without it and a cutoff above 0, alpha does not count.
constexpr double kBlended = -1;

/// What a part of an object is made of. The shader's base colour tints `base_color`; emission is
/// added to whatever it gives. Textures are places in Object::textures; factors multiply them.
struct Surface {
    V3d base_color{1, 1, 1};
    V3d emissive{0, 0, 0};
    std::optional<double> metallic, roughness; ///< instead of the shader's parameters of that name
    double normal_scale = 1;
    double alpha = 1;
    double alpha_cutoff = 0; ///< what has less alpha is not there; kBlended
    std::optional<std::size_t> base_texture;
    std::optional<std::size_t> metallic_roughness_texture; ///< B metallic, G roughness
    std::optional<std::size_t> normal_texture; ///< x, y, z of the normal as 2 c - 1: x along u, y
                                               ///< against v, z outwards (glTF 2.0)
    std::optional<std::size_t> emissive_texture;
    std::optional<std::size_t> alpha_texture; ///< its first channel
};

/// Triangles that are drawn together: `count` indices from the `first` on.
struct Part {
    std::size_t first = 0;
    std::size_t count = 0;
    Surface surface;
};

/// What is drawn: a mesh, or, where there is none, the unit sphere at the origin, which is
/// intersected in every sample and so has its exact outline and normals at any size.
struct Object {
    std::optional<Mesh> mesh;
    std::vector<Part> parts{}; ///< that cover the mesh; none: all of it is one plain part
    std::vector<SurfaceTexture> textures{};
};

/// The object's parts; one of everything where it lists none. The sphere's is without indices.
std::vector<Part> partsOf(const Object& object);

/// Names of the built-in objects, in the order in which they are shown to users.
std::span<const std::string_view> builtinObjectNames();

/// The built-in object of that name, if there is one. Each lies in the unit sphere about the origin
/// and touches it: the solids, plane and cylinder with their corners, torus and teapot from inside
/// with their farthest point.
std::optional<Object> builtinObject(std::string_view name);

/// A box around the object.
Box3f bounds(const Object& object);

/// Where an object is: the middle of its box, and its farthest point's distance from there.
struct Extent {
    Box3f box;
    V3d centre{0, 0, 0};
    double radius = 1;
};
Extent extentOf(const Object& object);

} // namespace ibl
