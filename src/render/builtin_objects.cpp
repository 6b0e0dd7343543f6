#include "render/builtin_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

using Imath::V2d;

constexpr double kPi = std::numbers::pi;

// Texture axes of a flat face: u runs along +Y x normal, so that it is level and goes to the right
// seen from outside, v down; of faces that look up or down, u runs along +X.
struct FaceAxes {
    V3d right, down;

    explicit FaceAxes(const V3d& normal) {
        const V3d level = V3d(0, 1, 0).cross(normal);
        right = level.length() > 1e-9 ? level.normalized() : V3d(1, 0, 0);
        down = right.cross(normal);
    }
};

// The image spans the face, undistorted: the square about its box, of the longer side.
void addTexcoords(Mesh& mesh, const V3d& normal, const std::vector<V3d>& corners) {
    const FaceAxes axes(normal);
    V2d low(1e9), high(-1e9);
    std::vector<V2d> places;
    for (const V3d& corner : corners) {
        places.emplace_back(axes.right.dot(corner), axes.down.dot(corner));
        low = {std::min(low.x, places.back().x), std::min(low.y, places.back().y)};
        high = {std::max(high.x, places.back().x), std::max(high.y, places.back().y)};
    }
    const V2d middle = (low + high) * 0.5;
    const double side = std::max(high.x - low.x, high.y - low.y);
    for (const V2d& place : places)
        mesh.texcoords.emplace_back((place - middle) / side + V2d(0.5));
}

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
    addTexcoords(mesh, normal, corners);
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

// Around the axis; at 1000 pixels across, the sagitta of a chord is below a sixth of a pixel.
constexpr std::uint32_t kAround = 128;

V3d aroundAxis(double radius, double y, double u) {
    const double phi =
        2 * kPi * (u - 0.5); // as on the sphere: to the right from outside, 1/2 at +Z
    return {radius * std::sin(phi), y, radius * std::cos(phi)};
}

// The surface that a line of two points (radius, y), from the upper to the lower, sweeps when it is
// turned about the axis, with the normals (outward, up) at its ends. Columns are doubled at the
// seam, and a tip has a vertex for each of them, since its normal is another in each.
void addTurned(Mesh& mesh, const std::array<V2d, 2>& line, const std::array<V2d, 2>& normals) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t column = 0; column <= kAround; ++column) {
        for (std::size_t end = 0; end < 2; ++end) {
            const bool is_tip = line[end].x == 0;
            // Between its triangle's other two corners.
            const double u = (column + (is_tip ? 0.5 : 0.0)) / kAround;
            mesh.positions.emplace_back(aroundAxis(line[end].x, line[end].y, u));
            mesh.normals.emplace_back(aroundAxis(normals[end].x, normals[end].y, u));
            mesh.texcoords.emplace_back(V2d(u, static_cast<double>(end)));
        }
        if (column == kAround) break;
        const std::uint32_t top = first + 2 * column, below = top + 1;
        mesh.indices.insert(mesh.indices.end(), {top, below, top + 3});
        if (line[0].x > 0) mesh.indices.insert(mesh.indices.end(), {top, top + 3, top + 2});
    }
}

// A flat disc about the axis that looks up or down.
void addDisc(Mesh& mesh, double radius, double y, double up) {
    std::vector<V3d> corners;
    for (std::uint32_t column = 0; column < kAround; ++column)
        corners.push_back(aroundAxis(radius, y, static_cast<double>(column) / kAround));
    addPolygon(mesh, {0, up, 0}, std::move(corners));
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

Mesh makeTetrahedron() {
    std::vector<V3d> corners{{0, 1, 0}};
    const double ring = std::sqrt(8.0) / 3;
    for (const double azimuth : {60, 180, 300}) {
        const double a = azimuth * kPi / 180;
        corners.emplace_back(ring * std::sin(a), -1.0 / 3, ring * std::cos(a));
    }
    std::vector<V3d> directions; // a face looks away from the corner that it lacks
    for (const V3d& corner : corners)
        directions.push_back(-corner);
    return makeSolid(corners, directions);
}

Mesh makeOctahedron() {
    return makeSolid({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                     cubeCorners());
}

Mesh makeIcosahedron() {
    // Its faces look towards the dodecahedron's corners.
    constexpr double phi = std::numbers::phi;
    std::vector<V3d> corners = cyclicCorners(1, phi);
    for (V3d& corner : corners)
        corner.normalize();
    std::vector<V3d> directions = cubeCorners();
    for (const V3d& corner : cyclicCorners(phi, 1 / phi))
        directions.push_back(corner);
    return makeSolid(corners, directions);
}

Mesh makePlane() {
    Mesh mesh;
    const double side = 1 / std::sqrt(2.0);
    addPolygon(mesh, {0, 1, 0},
               {{-side, 0, -side}, {-side, 0, side}, {side, 0, side}, {side, 0, -side}});
    return mesh;
}

Mesh makeCylinder() {
    const double half = 1 / std::sqrt(2.0);
    Mesh mesh;
    addTurned(mesh, {V2d(half, half), V2d(half, -half)}, {V2d(1, 0), V2d(1, 0)});
    addDisc(mesh, half, half, 1);
    addDisc(mesh, half, -half, -1);
    return mesh;
}

Mesh makeCone() {
    const double radius = std::sqrt(3.0) / 2;
    // The side rises by 3/2 over the radius: its normal is (3/2, radius) of length sqrt 3.
    const V2d normal(std::sqrt(3.0) / 2, 0.5);
    Mesh mesh;
    addTurned(mesh, {V2d(0, 1), V2d(radius, -0.5)}, {normal, normal});
    addDisc(mesh, radius, -0.5, -1);
    return mesh;
}

Mesh makeSphere() {
    constexpr std::uint32_t rows = kAround / 2;
    Mesh mesh;
    for (std::uint32_t row = 0; row <= rows; ++row) {
        const double theta = kPi * row / rows;
        const bool is_pole = row == 0 || row == rows;
        for (std::uint32_t column = 0; column <= kAround; ++column) {
            // A pole has a vertex for each of its triangles, between the other two corners.
            const double u = (column + (is_pole ? 0.5 : 0.0)) / kAround;
            const double radius = is_pole ? 0 : std::sin(theta);
            mesh.positions.emplace_back(aroundAxis(radius, std::cos(theta), u));
            mesh.normals.push_back(mesh.positions.back());
            mesh.texcoords.emplace_back(V2d(u, double(row) / rows));
            if (row == rows || column == kAround) continue;
            const std::uint32_t a = row * (kAround + 1) + column, b = a + kAround + 1;
            const bool last = row + 1 == rows;
            if (!last) mesh.indices.insert(mesh.indices.end(), {a, b, b + 1});
            if (row > 0) mesh.indices.insert(mesh.indices.end(), {a, last ? b : b + 1, a + 1});
        }
    }
    return mesh;
}

Mesh makeTorus() {
    // At 1000 pixels across, the sagitta of a chord is below a sixth of a pixel. Finer is dear:
    // software rasterisers shade blocks of 16 pixels for every triangle in them.
    constexpr std::uint32_t around = 128, across = 64;
    constexpr double ring = 0.7, tube = 0.3;
    Mesh mesh;
    for (std::uint32_t i = 0; i <= around; ++i) { // seams are doubled, for the texture
        const double u = 2 * kPi * (i % around) / around;
        const V3d outward(std::cos(u), std::sin(u), 0);
        for (std::uint32_t j = 0; j <= across; ++j) {
            const double v = 2 * kPi * (j % across) / across;
            const V3d normal = outward * std::cos(v) + V3d(0, 0, std::sin(v));
            mesh.positions.emplace_back(outward * ring + normal * tube);
            mesh.normals.emplace_back(normal);
            mesh.texcoords.emplace_back(V2d(1 - double(i) / around, double(j) / across));
            if (i == around || j == across) continue;
            const std::uint32_t a = i * (across + 1) + j, b = a + across + 1, c = b + 1, d = a + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
        }
    }
    return mesh;
}

} // namespace ibl
