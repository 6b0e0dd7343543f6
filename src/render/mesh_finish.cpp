#include "render/mesh_finish.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

using Imath::V2d;

constexpr std::size_t kMostEarCorners = 10000;

template <class T>
bool allFinite(const std::vector<T>& values) {
    return std::ranges::all_of(values, [](const T& v) {
        for (unsigned i = 0; i < T::dimensions(); ++i) {
            if (!std::isfinite(v[static_cast<int>(i)])) return false;
        }
        return true;
    });
}

// Twice the signed area of three points.
double turnAt(const V2d& a, const V2d& b, const V2d& c) {
    return (b - a).cross(c - a);
}

// The polygon in its own plane (Newell's normal), counter-clockwise.
std::vector<V2d> flattened(std::span<const V3f> positions, std::span<const std::uint32_t> corners) {
    V3d normal(0);
    const V3d origin(positions[corners[0]]);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const V3d a = V3d(positions[corners[i]]) - origin;
        const V3d b = V3d(positions[corners[(i + 1) % corners.size()]]) - origin;
        normal += a.cross(b);
    }
    normal.normalize();
    const V3d other = std::abs(normal.x) < 0.6 ? V3d(1, 0, 0) : V3d(0, 1, 0);
    const V3d right = other.cross(normal).normalized(), up = normal.cross(right);
    std::vector<V2d> points;
    for (const std::uint32_t corner : corners) {
        const V3d p = V3d(positions[corner]) - origin;
        points.emplace_back(p.dot(right), p.dot(up));
    }
    return points;
}

bool isConvex(const std::vector<V2d>& points) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (turnAt(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
    }
    return true;
}

// Cuts off ears, corners whose triangle holds no other corner, until three are left.
void addEars(const std::vector<V2d>& points, std::span<const std::uint32_t> corners,
             std::vector<std::uint32_t>& indices) {
    std::vector<std::size_t> rest(corners.size());
    for (std::size_t i = 0; i < rest.size(); ++i)
        rest[i] = i;
    const auto isEar = [&](std::size_t at) {
        const std::size_t n = rest.size();
        const std::size_t before = rest[(at + n - 1) % n], after = rest[(at + 1) % n];
        const V2d &a = points[before], &b = points[rest[at]], &c = points[after];
        if (turnAt(a, b, c) < 0) return false;
        return std::ranges::none_of(rest, [&](std::size_t other) {
            if (other == before || other == rest[at] || other == after) return false;
            const V2d& p = points[other];
            return turnAt(a, b, p) > 0 && turnAt(b, c, p) > 0 && turnAt(c, a, p) > 0;
        });
    };
    std::size_t at = 0, failures = 0;
    while (rest.size() >= 3) {
        const std::size_t n = rest.size();
        at %= n;
        // A polygon that crosses itself may have no ear: then any corner is cut off.
        if (failures < n && !isEar(at)) {
            ++at;
            ++failures;
            continue;
        }
        indices.insert(indices.end(), {corners[rest[(at + n - 1) % n]], corners[rest[at]],
                                       corners[rest[(at + 1) % n]]});
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(at));
        failures = 0;
    }
}

// Twice the area times the unit normal of the triangle whose corners are t[0..2].
V3d faceVector(std::span<const V3f> positions, const std::uint32_t* t) {
    const V3d a(positions[t[0]]), b(positions[t[1]]), c(positions[t[2]]);
    return (b - a).cross(c - a);
}

// The angle at corner k of such a triangle.
double cornerAngle(std::span<const V3f> positions, const std::uint32_t* t, std::size_t k) {
    const V3d corner(positions[t[k]]);
    const V3d a = V3d(positions[t[(k + 1) % 3]]) - corner;
    const V3d b = V3d(positions[t[(k + 2) % 3]]) - corner;
    return std::atan2(a.cross(b).length(), a.dot(b));
}

void requireSound(const std::string& file, const Mesh& mesh) {
    if (!allFinite(mesh.positions) || !allFinite(mesh.normals) || !allFinite(mesh.texcoords)) {
        throw inputError(file, "has a coordinate that is not finite; export it again");
    }
    const std::size_t count = mesh.positions.size();
    if (std::ranges::any_of(mesh.indices, [&](std::uint32_t i) { return i >= count; })) {
        throw inputError(file, "a face refers to a vertex that the file does not have; export it "
                               "again");
    }
}

// Keeps the triangles with area; the parts shrink with them.
void dropEmptyTriangles(Mesh& mesh, std::vector<Part>& parts) {
    std::size_t kept = 0;
    for (Part& part : parts) {
        const std::size_t first = kept;
        for (std::size_t i = part.first; i + 2 < part.first + part.count; i += 3) {
            const std::uint32_t* t = mesh.indices.data() + i;
            if (!(faceVector(mesh.positions, t).length() > 0)) continue;
            std::copy_n(t, 3, mesh.indices.data() + kept);
            kept += 3;
        }
        part.first = first;
        part.count = kept - first;
    }
    mesh.indices.resize(kept);
    std::erase_if(parts, [](const Part& part) { return part.count == 0; });
}

} // namespace

void addPolygon(const std::string& file, std::span<const V3f> positions,
                std::span<const std::uint32_t> corners, std::vector<std::uint32_t>& indices) {
    const auto fan = [&] {
        for (std::size_t i = 2; i < corners.size(); ++i)
            indices.insert(indices.end(), {corners[0], corners[i - 1], corners[i]});
    };
    if (corners.size() <= 3) return fan();
    const std::vector<V2d> points = flattened(positions, corners);
    if (isConvex(points)) return fan();
    if (corners.size() > kMostEarCorners) {
        throw inputError(file, "has a polygon of " + std::to_string(corners.size()) +
                                   " corners that is not convex; export it as triangles");
    }
    addEars(points, corners, indices);
}

void finishMesh(const std::string& file, Mesh& mesh, std::vector<Part>& parts,
                std::span<const std::uint32_t> places) {
    requireSound(file, mesh);
    dropEmptyTriangles(mesh, parts);
    if (mesh.indices.empty()) {
        throw inputError(file, "holds no triangle; give a mesh with faces");
    }
    const std::size_t count = mesh.positions.size();
    std::vector<bool> given(count, false);
    mesh.normals.resize(count, V3f(0));
    bool all_given = true;
    for (std::size_t i = 0; i < count; ++i) {
        given[i] = mesh.normals[i].length() > 0;
        all_given = all_given && given[i];
    }
    std::uint32_t groups = static_cast<std::uint32_t>(count);
    if (!places.empty()) groups = *std::ranges::max_element(places) + 1;
    const auto groupOf = [&](std::size_t v) { return places.empty() ? v : places[v]; };
    std::vector<V3d> smooth(all_given ? 0 : groups, V3d(0));
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        std::uint32_t* t = mesh.indices.data() + i;
        const V3d face = faceVector(mesh.positions, t);
        if (given[t[0]] && given[t[1]] && given[t[2]]) {
            const V3d shading = V3d(mesh.normals[t[0]]).normalized() +
                                V3d(mesh.normals[t[1]]).normalized() +
                                V3d(mesh.normals[t[2]]).normalized();
            if (face.dot(shading) < 0) std::swap(t[1], t[2]);
        }
        if (all_given) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            V3f& first_face = mesh.normals[t[k]]; // for faces back to back, whose sum is nothing
            if (!given[t[k]] && first_face.length() == 0) first_face = V3f(face.normalized());
            smooth[groupOf(t[k])] += face.normalized() * cornerAngle(mesh.positions, t, k);
        }
    }
    for (std::size_t v = 0; v < count; ++v) {
        V3f& normal = mesh.normals[v];
        if (given[v]) {
            normal = V3f(V3d(normal).normalized());
        } else if (smooth[groupOf(v)].length() > 1e-9) {
            normal = V3f(smooth[groupOf(v)].normalized());
        }
    }
}

} // namespace ibl
