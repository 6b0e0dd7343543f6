#include "render/mesh.h"

#include "render/builtin_objects.h"

#include <algorithm>
#include <array>

namespace ibl {
namespace {

constexpr std::array<std::string_view, 5> kNames{"sphere", "cube", "torus", "teapot",
                                                 "dodecahedron"};

} // namespace

std::span<const std::string_view> builtinObjectNames() {
    return kNames;
}

std::optional<Object> builtinObject(std::string_view name) {
    if (name == "sphere") return Object{};
    if (name == "cube") return Object{makeCube()};
    if (name == "torus") return Object{makeTorus()};
    if (name == "teapot") return Object{makeTeapot()};
    if (name == "dodecahedron") return Object{makeDodecahedron()};
    return std::nullopt;
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
