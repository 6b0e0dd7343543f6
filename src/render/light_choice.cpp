#include "render/light_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ibl {
namespace {

// Cells a side of an octahedral map, and a bound on the angle between two directions of a cell: a
// step of da = db = 2 / kCells is sqrt(6) da long on the octahedron's surface, which is nowhere
// nearer to the origin than 1 / sqrt(3).
constexpr int kCells = 128;
constexpr double kCellAngle = 0.0663;

std::size_t cellOf(const V3d& d) {
    const double scale = 1 / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
    double a = d.x * scale, b = d.z * scale;
    if (d.y < 0) {
        const double folded = (1 - std::abs(b)) * (a < 0 ? -1 : 1);
        b = (1 - std::abs(a)) * (b < 0 ? -1 : 1);
        a = folded;
    }
    const auto index = [](double t) {
        return std::clamp(static_cast<int>((t + 1) * 0.5 * kCells), 0, kCells - 1);
    };
    return static_cast<std::size_t>(index(b) * kCells + index(a));
}

// One normal for each cell that holds normals of facets, turned to the eye as they are shaded.
std::vector<V3d> normalsSeen(const Mesh& mesh, const V3d& eye) {
    std::vector<V3d> found(static_cast<std::size_t>(kCells) * kCells, V3d(0));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const V3d a(mesh.positions[mesh.indices[i]]);
        const V3d b(mesh.positions[mesh.indices[i + 1]]);
        const V3d c(mesh.positions[mesh.indices[i + 2]]);
        const double side = (b - a).cross(c - a).dot(eye - a) < 0 ? -1 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const V3d n = V3d(mesh.normals[mesh.indices[i + k]]) * side;
            found[cellOf(n)] = n;
        }
    }
    std::erase(found, V3d(0));
    return found;
}

bool isBlack(const SceneLight& light) {
    return light.strength == V3d(0);
}

// Whether some of the unit sphere that the eye sees faces the light. From outside that is the cap
// of half angle acos(1/d) about the eye's direction e: l.e > cos(90 degrees + acos(1/d)).
bool facesSphere(const V3d& light, const V3d& eye) {
    const double d2 = eye.length2();
    return d2 <= 1 || light.dot(eye) / std::sqrt(d2) > -std::sqrt(1 - 1 / d2);
}

} // namespace

double lowestPoint(const Object& object, const Placement& placement) {
    const Similarity similarity = similarityOf(placement, extentOf(object));
    if (!object.mesh) return similarity.shift.y - similarity.scale;
    double lowest = std::numeric_limits<double>::infinity();
    for (const V3f& p : object.mesh->positions)
        lowest = std::min(lowest, similarity.point(V3d(p)).y);
    return lowest;
}

std::vector<SceneLight> turnedLights(const std::vector<SceneLight>& lights, const Turn& turn) {
    const M33d matrix = turnMatrix(turn);
    std::vector<SceneLight> turned = lights;
    for (SceneLight& light : turned) {
        if (light.type == LightType::directional) light.direction = light.direction * matrix;
    }
    return turned;
}

std::vector<SceneLight> lightsThatShow(const Scene& scene, const std::vector<SceneLight>& lights,
                                       const Similarity& similarity, const V3d& eye,
                                       LightCounts& counts) {
    const bool lit = shaderInfo(scene.material.shader).lit;
    const Object& object = scene.object;
    std::vector<V3d> normals;
    // Facets are looked at where the object is not placed.
    const M33d object_from_world = similarity.turn.transposed();
    const V3d brought = (eye - similarity.shift) / similarity.scale * object_from_world;
    if (lit && object.mesh) normals = normalsSeen(*object.mesh, brought);
    const auto seen = [&](const SceneLight& light) {
        const V3d& l = light.direction;
        if (light.type != LightType::directional) return true;
        if (scene.ground && l.y > 0) return true;
        if (!lit) return false;
        const V3d turned = l * object_from_world;
        if (!object.mesh) return facesSphere(turned, brought);
        return std::ranges::any_of(normals,
                                   [&](const V3d& n) { return n.dot(turned) > -kCellAngle; });
    };
    counts = {};
    counts.given = static_cast<int>(lights.size());
    std::vector<SceneLight> shown;
    for (const SceneLight& light : lights) {
        if (isBlack(light)) {
            ++counts.black;
        } else if (!seen(light)) {
            ++counts.unseen;
        } else {
            shown.push_back(light);
        }
    }
    counts.drawn = static_cast<int>(shown.size());
    return shown;
}

} // namespace ibl
