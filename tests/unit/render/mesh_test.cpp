#include "render/mesh.h"

#include "render/builtin_objects.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace ibl {
namespace {

using Point = std::tuple<int, int, int>;

// Vertices of flat faces and of patches are repeated: what is at one place counts as one.
Point place(const V3f& p) {
    const auto snap = [](float x) { return static_cast<int>(std::lround(x * 1e5)); };
    return {snap(p.x), snap(p.y), snap(p.z)};
}

// How often each edge is walked, less how often it is walked the other way; and whether any is
// walked twice in one direction.
struct Edges {
    std::map<std::pair<Point, Point>, int> walks;

    explicit Edges(const Mesh& mesh) {
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Point a = place(mesh.positions[mesh.indices[i + k]]);
                const Point b = place(mesh.positions[mesh.indices[i + (k + 1) % 3]]);
                ++walks[{a, b}];
            }
        }
    }
    bool consistent() const {
        for (const auto& [edge, count] : walks) {
            if (count != 1) return false;
        }
        return true;
    }
    // Corners - edges + faces of a closed mesh, each edge being walked both ways.
    long euler(const Mesh& mesh) const {
        std::set<Point> corners;
        for (const std::uint32_t i : mesh.indices)
            corners.insert(place(mesh.positions[i]));
        return static_cast<long>(corners.size() + mesh.indices.size() / 3) -
               static_cast<long>(walks.size() / 2);
    }
    std::size_t open() const {
        std::size_t count = 0;
        for (const auto& [edge, walked] : walks)
            count += !walks.count({edge.second, edge.first});
        return count;
    }
};

double volume(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const V3d a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
            c(mesh.positions[mesh.indices[i + 2]]);
        sum += a.dot(b.cross(c)) / 6;
    }
    return sum;
}

Mesh builtinMesh(std::string_view name) {
    return *builtinObject(name)->mesh;
}

TEST(Mesh, EveryNameIsAnObjectAndOnlyTheSphereIsAnalytic) {
    for (const std::string_view name : builtinObjectNames()) {
        const auto object = builtinObject(name);
        ASSERT_TRUE(object) << name;
        EXPECT_EQ(object->mesh.has_value(), name != "sphere");
        const Box3f box = bounds(*object);
        if (name == "cone" || name == "tetrahedron") continue; // about their corners, not their box
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(box.min[axis], -box.max[axis], 1e-5) << name; // centred
        }
    }
    EXPECT_FALSE(builtinObject("sphere.obj"));
}

TEST(Mesh, NormalsAreUnitAndOnTheTrianglesOuterSide) {
    for (const std::string_view name : builtinObjectNames()) {
        if (name == "sphere") continue;
        const Mesh mesh = builtinMesh(name);
        ASSERT_EQ(mesh.positions.size(), mesh.texcoords.size());
        ASSERT_EQ(mesh.positions.size(), mesh.normals.size());
        for (const V3f& n : mesh.normals)
            ASSERT_NEAR(n.length(), 1, 1e-6) << name;
        double farthest = 0;
        for (const V3f& p : mesh.positions)
            farthest = std::max<double>(farthest, p.length());
        EXPECT_NEAR(farthest, 1, 1e-6) << name;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            std::array<V3d, 3> p, n;
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] = V3d(mesh.positions[mesh.indices[i + k]]);
                n[k] = V3d(mesh.normals[mesh.indices[i + k]]);
            }
            const V3d face = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
            // The teapot's sharpest bends, at spout and knob, turn by up to 50 degrees a triangle.
            for (const V3d& normal : n)
                ASSERT_GT(face.dot(normal), 0.6) << name << " " << p[0];
        }
    }
}

TEST(Mesh, SolidsAreClosedAndConsistentlyWound) {
    const std::map<std::string, double> volumes{
        {"cube", std::pow(2 / std::sqrt(3.0), 3)},
        {"dodecahedron", 2.785163863},            // of circumradius 1
        {"tetrahedron", 8 * std::sqrt(3.0) / 27}, // of circumradius 1, too
        {"octahedron", 4.0 / 3},
        {"icosahedron", 2.536150710},
        {"cylinder", M_PI / std::sqrt(2.0)}, // less what the chords cut off, as below
        {"cone", M_PI * 0.75 * 1.5 / 3},
        {"torus", 2 * M_PI * M_PI * 0.7 * 0.09}};
    const std::set<std::string> volumes_of_chords{"cylinder", "cone", "torus"};
    for (const auto& [name, expected] : volumes) {
        const Mesh mesh = builtinMesh(name);
        const Edges edges(mesh);
        EXPECT_TRUE(edges.consistent()) << name;
        EXPECT_EQ(edges.open(), 0u) << name;
        EXPECT_NEAR(volume(mesh) / expected, 1, volumes_of_chords.count(name) ? 3e-3 : 1e-6)
            << name;
        EXPECT_EQ(edges.euler(mesh), name == "torus" ? 0 : 2) << name;
    }
}

TEST(Mesh, TheFarthestPointInAnyDirectionLooksThere) {
    for (const char* name : {"cube", "dodecahedron", "torus", "teapot"}) {
        const Mesh mesh = builtinMesh(name);
        for (int k = 0; k < 300; ++k) { // spread by the golden angle
            const double y = 1 - (2 * k + 1) / 300.0, phi = k * 2.399963;
            const double r = std::sqrt(1 - y * y);
            const V3f d(V3d(r * std::cos(phi), y, r * std::sin(phi)));
            std::size_t farthest = 0;
            for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
                if (mesh.positions[i].dot(d) > mesh.positions[farthest].dot(d)) farthest = i;
            }
            ASSERT_GT(mesh.normals[farthest].dot(d), 0) << name << " " << d;
        }
    }
}

TEST(Mesh, TorusNormalsAreExact) {
    const Mesh mesh = makeTorus();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3d p(mesh.positions[i]);
        const V3d ring = V3d(p.x, p.y, 0).normalized() * 0.7;
        ASSERT_LT(((p - ring) / 0.3 - V3d(mesh.normals[i])).length(), 1e-6);
    }
}

TEST(Mesh, DodecahedronHasTwelveFlatPentagons) {
    const Mesh mesh = makeDodecahedron();
    EXPECT_EQ(mesh.positions.size(), 60u);
    EXPECT_EQ(mesh.indices.size(), 12u * 3 * 3);
    const double inradius = 0.794654472; // of circumradius 1
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        ASSERT_NEAR(mesh.positions[i].dot(mesh.normals[i]), inradius, 1e-6);
    }
}

TEST(Mesh, TeapotIsOpenOnlyWhereNewellsIs) {
    const Mesh mesh = makeTeapot();
    const Edges edges(mesh);
    EXPECT_TRUE(edges.consistent());
    // 24 segments a patch: the lid's and the rim's circle (4 patches each), and both ends of handle
    // and spout (2 patches each).
    EXPECT_EQ(edges.open(), 24u * (4 + 4 + 2 * 2 + 2 * 2));
    // Tips: knob and bottom look along the axis.
    int up = 0, down = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3f &p = mesh.positions[i], &n = mesh.normals[i];
        ASSERT_TRUE(std::isfinite(n.x + n.y + n.z));
        up += n == V3f(0, 1, 0) && p.y > 0;
        down += n == V3f(0, -1, 0) && p.y < 0;
    }
    EXPECT_GE(up, 4);
    EXPECT_GE(down, 4);
    const Box3f box = bounds({mesh});
    EXPECT_GT(box.max.x, box.max.y); // spout towards +X, wider than high
}

/// How a picture lies on a triangle: what its right and its up become there.
struct Lie {
    V3d right, up, normal;
    double area = 0;
};
Lie lieOf(const Mesh& mesh, std::size_t triangle) {
    const std::uint32_t* t = mesh.indices.data() + triangle;
    const V3d a(mesh.positions[t[0]]);
    const V3d p = V3d(mesh.positions[t[1]]) - a, q = V3d(mesh.positions[t[2]]) - a;
    const V2f uv_p = mesh.texcoords[t[1]] - mesh.texcoords[t[0]];
    const V2f uv_q = mesh.texcoords[t[2]] - mesh.texcoords[t[0]];
    const double d = double(uv_p.x) * uv_q.y - double(uv_p.y) * uv_q.x;
    Lie lie{(p * uv_q.y - q * uv_p.y) / d, (p * uv_q.x - q * uv_p.x) / d, p.cross(q), 0};
    lie.area = lie.normal.length() / 2;
    lie.normal.normalize();
    return lie;
}

TEST(Mesh, PicturesStandUprightAndAreNotMirrored) {
    for (const std::string_view name : builtinObjectNames()) {
        if (name == "sphere") continue;
        const bool is_torus = name == "torus", is_teapot = name == "teapot";
        const Mesh mesh = builtinMesh(name);
        double steep = 0, upright = 0;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const Lie lie = lieOf(mesh, i);
            const V3f& p = mesh.positions[mesh.indices[i]];
            ASSERT_GT(lie.right.cross(lie.up).dot(lie.normal), 0) << name << " " << i;
            if (is_torus && std::abs(lie.normal.z) > 0.5) { // outwards on the front
                ASSERT_GT((p.x * lie.up.x + p.y * lie.up.y) * lie.normal.z, 0);
            } else if (is_teapot && p.x > 0.7) {
                ASSERT_GT(lie.up.y, -0.1) << "spout";
            } else if (!is_torus && !is_teapot && std::abs(lie.normal.y) > 0.99) {
                ASSERT_LT(lie.up.z * lie.normal.y, 0) << name;
            }
            if (std::abs(lie.normal.y) > 0.95) continue;
            steep += lie.area;
            upright += lie.up.y > 0 ? lie.area : 0;
        }
        // The teapot's rim has an inner side, and its handle's upper part is level.
        const double least = is_torus ? 0 : is_teapot ? 0.9 : 1;
        EXPECT_GE(upright, least * steep) << name;
    }
}

} // namespace
} // namespace ibl
