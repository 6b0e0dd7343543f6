#include "render/mesh.h"

#include "render/builtin_objects.h"

#include <algorithm>
#include <array>

namespace ibl {
namespace {

struct Named {
    std::string_view name;
    Mesh (*make)(); ///< none: the sphere
};
constexpr std::array<Named, 11> kObjects{{
    {"sphere", nullptr},
    {"cube", makeCube},
    {"torus", makeTorus},
    {"teapot", makeTeapot},
    {"plane", makePlane},
    {"cylinder", makeCylinder},
    {"cone", makeCone},
    {"tetrahedron", makeTetrahedron},
    {"octahedron", makeOctahedron},
    {"dodecahedron", makeDodecahedron},
    {"icosahedron", makeIcosahedron},
}};
constexpr auto kNames = [] {
    std::array<std::string_view, kObjects.size()> names;
    for (std::size_t i = 0; i < names.size(); ++i)
        names[i] = kObjects[i].name;
    return names;
}();

} // namespace

std::span<const std::string_view> builtinObjectNames() {
    return kNames;
}

std::optional<Object> builtinObject(std::string_view name) {
    const auto row = std::ranges::find(kObjects, name, &Named::name);
    if (row == kObjects.end()) return std::nullopt;
    Object object;
    if (row->make) object.mesh = row->make();
    return object;
}

Box3f bounds(const Object& object) {
    if (!object.mesh) return {V3f(-1), V3f(1)};
    Box3f box;
    for (const V3f& position : object.mesh->positions)
        box.extendBy(position);
    return box;
}

std::vector<Part> partsOf(const Object& object) {
    if (!object.parts.empty()) return object.parts;
    return {{0, object.mesh ? object.mesh->indices.size() : 0, {}}};
}

Extent extentOf(const Object& object) {
    Extent extent;
    extent.box = bounds(object);
    if (!object.mesh) return extent;
    extent.centre = (V3d(extent.box.min) + V3d(extent.box.max)) * 0.5;
    extent.radius = 0;
    for (const V3f& position : object.mesh->positions) {
        extent.radius = std::max(extent.radius, (V3d(position) - extent.centre).length());
    }
    return extent;
}

} // namespace ibl
