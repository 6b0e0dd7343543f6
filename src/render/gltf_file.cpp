// glTF 2.0 (Khronos; ISO/IEC 12113): meshes, nodes, materials, cameras.
#include "render/object_readers.h"

#include "core/error.h"
#include "render/gltf_document.h"
#include "render/gltf_materials.h"
#include "render/mesh_finish.h"

#include <Imath/ImathMatrix.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>

namespace ibl {
namespace {

using Imath::M44d;

constexpr double kTriangles = 4, kStrip = 5, kFan = 6; // modes of primitives

struct Building {
    const GltfDocument& document;
    GltfMaterials& materials;
    ObjectFile& result;
    Mesh mesh{};
    bool skipped_lines = false;

    const GltfJson& array(const char* key) const { return gltfArray(document, document.json, key); }
};

// Matrices multiply row vectors, which is the order of glTF's own numbers.
M44d localMatrix(const GltfDocument& document, const GltfJson& node) {
    M44d m;
    if (const auto n = gltfNumbers(document, node, "matrix", 16); !n.empty()) {
        for (std::size_t i = 0; i < 16; ++i)
            m[static_cast<int>(i / 4)][i % 4] = n[i];
        return m;
    }
    const auto scale = gltfNumbers(document, node, "scale", 3);
    const auto turn = gltfNumbers(document, node, "rotation", 4);
    const auto shift = gltfNumbers(document, node, "translation", 3);
    if (!turn.empty()) { // of a unit quaternion x y z w: row i is what becomes of axis i
        const double x = turn[0], y = turn[1], z = turn[2], w = turn[3];
        m = M44d(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
                 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
                 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0, 0, 0, 0, 1);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            m[i][j] *= scale.empty() ? 1 : scale[static_cast<std::size_t>(i)];
        m[3][i] = shift.empty() ? 0 : shift[static_cast<std::size_t>(i)];
    }
    return m;
}

V3d axis(const M44d& m, int i) {
    return {m[i][0], m[i][1], m[i][2]};
}

// Corner numbers of the primitive's triangles; nothing for points and lines.
std::vector<std::uint32_t> triangles(const Building& b, const GltfJson& primitive,
                                     std::size_t vertices) {
    const double mode = gltfNumber(b.document, primitive, "mode", kTriangles);
    if (mode != kTriangles && mode != kStrip && mode != kFan) return {};
    std::vector<std::uint32_t> corners;
    if (const auto a = gltfIndex(b.document, primitive, "indices", b.array("accessors").size())) {
        corners = gltfIndices(b.document, *a);
    } else {
        corners.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i)
            corners[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t corner : corners) {
        if (corner >= vertices) {
            throw gltfDamaged(b.document, "a face refers to a vertex that it does not have");
        }
    }
    if (mode == kTriangles) {
        corners.resize(corners.size() / 3 * 3);
        return corners;
    }
    std::vector<std::uint32_t> result;
    for (std::size_t i = 2; i < corners.size(); ++i) {
        const std::uint32_t first = mode == kFan ? corners[0] : corners[i - 2 + i % 2];
        const std::uint32_t second = mode == kFan ? corners[i - 1] : corners[i - 1 - i % 2];
        result.insert(result.end(), {first, second, corners[i]});
    }
    return result;
}

std::vector<float> attribute(const Building& b, const GltfJson& primitive, const char* name,
                             std::size_t components) {
    const GltfJson& attributes = gltfObject(b.document, primitive, "attributes");
    const auto a = gltfIndex(b.document, attributes, name, b.array("accessors").size());
    return a ? gltfFloats(b.document, *a, components) : std::vector<float>();
}

void addPrimitive(Building& b, const GltfJson& primitive, const M44d& world) {
    const std::vector<float> positions = attribute(b, primitive, "POSITION", 3);
    const std::vector<float> normals = attribute(b, primitive, "NORMAL", 3);
    const std::vector<float> texcoords = attribute(b, primitive, "TEXCOORD_0", 2);
    const std::size_t vertices = positions.size() / 3;
    std::vector<std::uint32_t> corners = triangles(b, primitive, vertices);
    if (corners.empty()) {
        b.skipped_lines = true;
        return;
    }
    if ((!normals.empty() && normals.size() != positions.size()) ||
        (!texcoords.empty() && texcoords.size() / 2 != vertices)) {
        throw gltfDamaged(b.document, "a primitive's attributes are not of one length");
    }
    Mesh& mesh = b.mesh;
    if (mesh.positions.size() + corners.size() + vertices >
        std::numeric_limits<std::uint32_t>::max() / 2) {
        throw inputError(b.document.path, "holds more than 2^31 vertices; reduce it");
    }
    // Normals go by the transposed inverse, which but for a factor is the matrix of cofactors.
    const V3d x = axis(world, 0), y = axis(world, 1), z = axis(world, 2);
    const std::array<V3d, 3> cofactors{y.cross(z), z.cross(x), x.cross(y)};
    const double determinant = x.dot(cofactors[0]);
    const auto addVertex = [&](std::size_t v) {
        const auto triple = [&](const std::vector<float>& values) {
            return V3d(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
        };
        const V3d p = triple(positions);
        mesh.positions.emplace_back(x * p.x + y * p.y + z * p.z + axis(world, 3));
        V3d n(0);
        if (!normals.empty()) {
            const V3d given = triple(normals);
            n = cofactors[0] * given.x + cofactors[1] * given.y + cofactors[2] * given.z;
            n = (determinant < 0 ? -n : n).normalized();
        }
        mesh.normals.emplace_back(n);
        if (!texcoords.empty()) {
            mesh.texcoords.resize(mesh.positions.size() - 1, V2f(0));
            mesh.texcoords.emplace_back(texcoords[2 * v], texcoords[2 * v + 1]);
        }
    };
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    if (normals.empty()) { // flat faces, says the standard
        for (std::size_t i = 0; i < corners.size(); ++i) {
            addVertex(corners[i]);
            corners[i] = static_cast<std::uint32_t>(i);
        }
    } else {
        for (std::size_t v = 0; v < vertices; ++v)
            addVertex(v);
    }
    Part part{mesh.indices.size(), corners.size(), {}};
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        if (determinant < 0) std::swap(corners[i + 1], corners[i + 2]);
        for (std::size_t k = 0; k < 3; ++k)
            mesh.indices.push_back(first + corners[i + k]);
    }
    part.surface = b.materials.surface(
        gltfIndex(b.document, primitive, "material", b.array("materials").size()));
    b.result.object.parts.push_back(std::move(part));
}

void addCamera(Building& b, std::size_t index, const GltfJson& node, const M44d& world) {
    const GltfJson& json = b.array("cameras")[index];
    std::string name = gltfString(b.document, json, "name");
    if (name.empty()) name = gltfString(b.document, node, "name");
    if (gltfString(b.document, json, "type") != "perspective") {
        b.result.notes.push_back("its camera " + name + " is orthographic and cannot be used");
        return;
    }
    const double fov =
        gltfNumber(b.document, gltfObject(b.document, json, "perspective"), "yfov", 0);
    if (!(fov > 0 && fov < std::numbers::pi)) throw gltfDamaged(b.document, "a yfov cannot be");
    const V3d eye = axis(world, 3);
    b.result.cameras.push_back(
        {index,
         name,
         {eye, eye - axis(world, 2).normalized(), axis(world, 1), fov * 180 / std::numbers::pi}});
}

void addNode(Building& b, const GltfJson& node, const M44d& world) {
    const GltfJson& meshes = b.array("meshes");
    if (const auto mesh = gltfIndex(b.document, node, "mesh", meshes.size())) {
        for (const GltfJson& primitive : gltfArray(b.document, meshes[*mesh], "primitives"))
            addPrimitive(b, primitive, world);
    }
    if (const auto camera = gltfIndex(b.document, node, "camera", b.array("cameras").size())) {
        addCamera(b, *camera, node, world);
    }
}

std::size_t nodeNumber(const Building& b, const GltfJson& value) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= b.array("nodes").size()) {
        throw gltfDamaged(b.document, "it refers to a node that it does not have");
    }
    return static_cast<std::size_t>(value.get<std::uint64_t>());
}

// The nodes that stand in the scene itself: of the default scene, or those that are no one's child.
std::vector<std::size_t> rootNodes(const Building& b) {
    const GltfJson& scenes = b.array("scenes");
    std::vector<std::size_t> roots;
    if (!scenes.empty()) {
        const auto scene = gltfIndex(b.document, b.document.json, "scene", scenes.size());
        for (const GltfJson& node : gltfArray(b.document, scenes[scene.value_or(0)], "nodes"))
            roots.push_back(nodeNumber(b, node));
        return roots;
    }
    std::vector<bool> is_child(b.array("nodes").size());
    for (const GltfJson& node : b.array("nodes")) {
        for (const GltfJson& child : gltfArray(b.document, node, "children"))
            is_child[nodeNumber(b, child)] = true;
    }
    for (std::size_t i = 0; i < is_child.size(); ++i) {
        if (!is_child[i]) roots.push_back(i);
    }
    return roots;
}

void addNodes(Building& b) {
    struct Waiting {
        std::size_t node;
        M44d parent;
    };
    std::vector<Waiting> waiting;
    for (const std::size_t root : rootNodes(b))
        waiting.push_back({root, M44d()});
    std::ranges::reverse(waiting);
    std::vector<bool> seen(b.array("nodes").size());
    while (!waiting.empty()) {
        const Waiting next = waiting.back();
        waiting.pop_back();
        if (seen[next.node]) throw gltfDamaged(b.document, "a node stands in two places");
        seen[next.node] = true;
        const GltfJson& node = b.array("nodes")[next.node];
        const M44d world = localMatrix(b.document, node) * next.parent;
        addNode(b, node, world);
        const GltfJson& children = gltfArray(b.document, node, "children");
        for (std::size_t i = children.size(); i > 0; --i)
            waiting.push_back({nodeNumber(b, children[i - 1]), world});
    }
}

void noteWhatIsPassedOver(const Building& b) {
    std::vector<std::string>& notes = b.result.notes;
    if (b.skipped_lines) notes.emplace_back("its points and lines are not drawn");
    if (!b.array("skins").empty()) notes.emplace_back("its skins are passed over");
    if (!b.array("animations").empty()) notes.emplace_back("its animations are passed over");
    std::string extensions;
    for (const GltfJson& name : b.array("extensionsUsed")) {
        if (!name.is_string() || name == "KHR_mesh_quantization") continue;
        extensions += (extensions.empty() ? "" : ", ") + name.get<std::string>();
    }
    if (!extensions.empty()) notes.push_back("its glTF extensions are passed over: " + extensions);
}

} // namespace

ObjectFile readGltf(const std::string& path, std::span<const char> bytes, int threads) {
    const GltfDocument document = openGltf(path, bytes);
    ObjectFile result;
    result.files.push_back(path);
    result.files.insert(result.files.end(), document.files.begin(), document.files.end());
    GltfMaterials materials(document, threads, result);
    Building building{document, materials, result};
    addNodes(building);
    noteWhatIsPassedOver(building);
    building.mesh.texcoords.resize(
        building.mesh.texcoords.empty() ? 0 : building.mesh.positions.size(), V2f(0));
    finishMesh(path, building.mesh, result.object.parts);
    std::ranges::stable_sort(result.cameras, {}, &NamedCamera::number);
    result.object.mesh = std::move(building.mesh);
    return result;
}

} // namespace ibl
