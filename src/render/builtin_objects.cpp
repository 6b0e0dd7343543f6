#include "render/builtin_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

// A flat convex polygon, as a fan, its corners counter-clockwise about `normal`.
void addPolygon(Mesh& mesh, const V3d& normal, std::vector<V3d> corners) {
    const V3d right = (corners[0] - normal * normal.dot(corners[0])).normalized();
    const V3d up = normal.cross(right);
    const auto angle = [&](const V3d& p) { return std::atan2(up.dot(p), right.dot(p)); };
    std::sort(corners.begin(), corners.end(),
              [&](const V3d& a, const V3d& b) { return angle(a) < angle(b); });
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V3d& corner : corners) {
        mesh.positions.emplace_back(corner);
        mesh.normals.emplace_back(normal);
    }
    for (std::uint32_t i = 2; i < corners.size(); ++i) {
        mesh.indices.insert(mesh.indices.end(), {first, first + i - 1, first + i});
    }
}

// A convex solid about the origin from its corners and the directions of its faces: a face holds
// the corners farthest along its direction.
Mesh makeSolid(const std::vector<V3d>& corners, const std::vector<V3d>& directions) {
    Mesh mesh;
    for (const V3d& direction : directions) {
        const V3d normal = direction.normalized();
        double farthest = 0;
        for (const V3d& corner : corners)
            farthest = std::max(farthest, normal.dot(corner));
        std::vector<V3d> face;
        for (const V3d& corner : corners) {
            if (normal.dot(corner) > farthest - 1e-9) face.push_back(corner);
        }
        addPolygon(mesh, normal, std::move(face));
    }
    return mesh;
}

constexpr std::array<double, 2> kSigns{-1, 1};

std::vector<V3d> cubeCorners() {
    std::vector<V3d> corners;
    for (const double x : kSigns) {
        for (const double y : kSigns) {
            for (const double z : kSigns)
                corners.push_back(V3d(x, y, z) / std::sqrt(3.0));
        }
    }
    return corners;
}

// (0, +-a, +-b) and its cyclic permutations.
std::vector<V3d> cyclicCorners(double a, double b) {
    std::vector<V3d> corners;
    for (const double s : kSigns) {
        for (const double t : kSigns) {
            corners.emplace_back(0, s * a, t * b);
            corners.emplace_back(t * b, 0, s * a);
            corners.emplace_back(s * a, t * b, 0);
        }
    }
    return corners;
}

} // namespace

Mesh makeCube() {
    return makeSolid(cubeCorners(),
                     {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
}

Mesh makeDodecahedron() {
    // Corners: those of the cube and (0, +-1/phi, +-phi) cyclic, all at sqrt(3) before scaling.
    // Faces look towards the corners (0, +-phi, +-1) cyclic of the dual icosahedron.
    constexpr double phi = std::numbers::phi;
    std::vector<V3d> corners = cubeCorners();
    for (const V3d& corner : cyclicCorners(1 / phi, phi)) {
        corners.push_back(corner / std::sqrt(3.0));
    }
    return makeSolid(corners, cyclicCorners(phi, 1));
}

Mesh makeTorus() {
    // At 1000 pixels across, the sagitta of a chord is below a sixth of a pixel. Finer is dear:
    // software rasterisers shade blocks of 16 pixels for every triangle in them.
    constexpr std::uint32_t around = 128, across = 64;
    constexpr double ring = 0.7, tube = 0.3;
    Mesh mesh;
    for (std::uint32_t i = 0; i < around; ++i) {
        const double u = 2 * kPi * i / around;
        const V3d outward(std::cos(u), std::sin(u), 0);
        for (std::uint32_t j = 0; j < across; ++j) {
            const double v = 2 * kPi * j / across;
            const V3d normal = outward * std::cos(v) + V3d(0, 0, std::sin(v));
            mesh.positions.emplace_back(outward * ring + normal * tube);
            mesh.normals.emplace_back(normal);
            const std::uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
            const std::uint32_t a = i * across + j, b = next_i * across + j,
                                c = next_i * across + next_j, d = i * across + next_j;
            mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
        }
    }
    return mesh;
}

} // namespace ibl
