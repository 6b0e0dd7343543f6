// Turns, placements, and that drawing with them is a change of frame.
#include "scene_support.h"

#include "core/error.h"
#include "panorama/turn.h"
#include "render/placement.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

V3d about(int axis, double degrees, const V3d& v) {
    const double a = degrees * kPi / 180, c = std::cos(a), s = std::sin(a);
    if (axis == 0) return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
    if (axis == 1) return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
    return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

TEST(Turn, QuarterTurnsAreExact) {
    EXPECT_EQ(V3d(0, 0, 1) * turnMatrix({90, 0, 0, false}), V3d(1, 0, 0));
    EXPECT_EQ(V3d(0, 0, 1) * turnMatrix({-270, 0, 0, false}), V3d(1, 0, 0));
    EXPECT_EQ(V3d(0, 0, 1) * turnMatrix({180, 0, 0, false}), V3d(0, 0, -1));
    EXPECT_EQ(V3d(0, 1, 0) * turnMatrix({0, 90, 0, false}), V3d(0, 0, 1));
    EXPECT_EQ(V3d(1, 0, 0) * turnMatrix({0, 0, 90, false}), V3d(0, 1, 0));
    EXPECT_EQ(V3d(1, 2, 3) * turnMatrix({0, 0, 0, true}), V3d(-1, 2, 3));
    EXPECT_EQ(V3d(1, 2, 3) * turnMatrix({720, 0, -360, false}), V3d(1, 2, 3));
}

TEST(Turn, IsRollThenPitchThenYaw) {
    const V3d d(0.3, -0.5, 0.8);
    for (const bool mirror : {false, true}) {
        const V3d first = mirror ? V3d(-d.x, d.y, d.z) : d;
        const V3d expected = about(1, 25, about(0, -40, about(2, 70, first)));
        EXPECT_LT((d * turnMatrix({25, -40, 70, mirror}) - expected).length(), 1e-14);
    }
}

TEST(Placement, FitBringsTheFarthestPointOntoTheUnitSphere) {
    Object object;
    object.mesh.emplace();
    object.mesh->positions = {{2, 0, 0}, {6, 0, 0}, {4, 1, 0}, {4, -1, 0}};
    const Placement placement{{0, 3, 0}, {90, 0, 0, false}, 2, true};
    const Similarity s = similarityOf(placement, extentOf(object));
    EXPECT_LT((s.point({6, 0, 0}) - V3d(0, 3, -2)).length(), 1e-12); // +X goes to -Z
    EXPECT_LT((s.point({4, 0, 0}) - V3d(0, 3, 0)).length(), 1e-12);
    const Similarity sphere = similarityOf({{}, {}, 1, true}, extentOf({}));
    EXPECT_EQ(sphere.scale, 1);
    EXPECT_THROW(similarityOf({{}, {}, 0, false}, extentOf(object)), Error);
    EXPECT_THROW(similarityOf({{NAN, 0, 0}, {}, 1, false}, extentOf(object)), Error);
}

Image draw(const Scene& scene, const Camera& camera) {
    return Renderer(softwareContext(), scene, {48, 36, 1, {}}).render(camera);
}

double difference(const Image& a, const Image& b) {
    double sum = 0, of_a = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        sum += std::pow(a.pixels[i] - b.pixels[i], 2);
        of_a += std::pow(a.pixels[i], 2);
    }
    return std::sqrt(sum / of_a);
}

// Everything turned together looks the same; the camera is turned by plain formulas.
TEST(Turn, ProbeObjectAndCameraTurnedTogetherLookTheSame) {
    const Panorama probe = noiseProbe(Layout::latlong, 16, 8);
    for (const char* name : {"sphere", "teapot"}) {
        Scene scene;
        scene.probe = &probe;
        scene.object = *builtinObject(name);
        const Camera camera{{1, 2, 4}, {0, 0.2, 0}, {0, 1, 0}, 40};
        const Image before = draw(scene, camera);
        scene.turn = {35, 20, -50, false};
        scene.placement.turn = scene.turn;
        const auto turned = [](const V3d& v) {
            return about(1, 35, about(0, 20, about(2, -50, v)));
        };
        const Image after =
            draw(scene, {turned(camera.eye), turned(camera.target), turned(camera.up), 40});
        EXPECT_LT(difference(before, after), 0.02) << name;
        scene.placement = {}; // the probe alone is turned
        EXPECT_GT(difference(before, draw(scene, camera)), 0.1) << name; // it does see turns
    }
}

TEST(Turn, ProbeIsLookedUpTurned) {
    const Panorama probe = noiseProbe(Layout::faces, 4, 24);
    Scene scene;
    scene.probe = &probe;
    scene.turn = {35, 20, -50, true};
    const Camera away{{0, 0, 4}, {0, 0, 8}, {0, 1, 0}, 60}; // the background alone
    const Image frame = draw(scene, away);
    const CameraRays rays = cameraRays(away, 48, 36);
    const M33d back = turnMatrix(scene.turn).transposed();
    for (int y = 0; y < 36; y += 5) {
        for (int x = 0; x < 48; x += 5) {
            const V3d expected = radianceAt(probe, rays.direction(x + 0.5, y + 0.5) * back);
            ASSERT_LT((pixel(frame, x, y) - expected).length(), 0.03) << x << " " << y;
        }
    }
}

// A larger sphere farther away, and the same mesh scaled by hand.
TEST(Placement, ScaledAndMovedObjectsAreSeenWhereTheyStand) {
    const Panorama probe = noiseProbe(Layout::latlong, 16, 8);
    Scene scene;
    scene.probe = &probe;
    scene.background = NoBackground{};
    scene.placement = {{3, -1, 2}, {}, 2.5, false};
    const Camera camera{{9, 4, 12}, {3, -1, 2}, {0, 1, 0}, 40};
    const Image frame = draw(scene, camera);
    const CameraRays rays = cameraRays(camera, 48, 36);
    int wrong = 0, inside = 0;
    for (int y = 0; y < 36; ++y) {
        for (int x = 0; x < 48; ++x) {
            const V3d eye = (camera.eye - V3d(3, -1, 2)) / 2.5;
            const bool hit = meetSphere(eye, rays.direction(x + 0.5, y + 0.5)).has_value();
            inside += hit;
            wrong += hit != (frame.at(x, y)[3] > 0.5F);
        }
    }
    EXPECT_GT(inside, 100);
    EXPECT_EQ(wrong, 0);

    scene.object = *builtinObject("cube");
    scene.placement.turn = {30, 0, 10, false};
    const Image placed = draw(scene, camera);
    for (V3f& p : scene.object.mesh->positions)
        p = V3f(about(1, 30, about(2, 10, V3d(p))) * 2.5 + V3d(3, -1, 2));
    for (V3f& n : scene.object.mesh->normals)
        n = V3f(about(1, 30, about(2, 10, V3d(n))));
    scene.placement = {};
    EXPECT_LT(difference(placed, draw(scene, camera)), 1e-3);
}

TEST(Aovs, AreOfThePixelsCentre) {
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    scene.placement = {{1, 0, 0}, {}, 0.5, false};
    const Camera camera{{1, 2, 4}, {1, 0, 0}, {0, 1, 0}, 20};
    const CameraRays rays = cameraRays(camera, 48, 36);
    for (const bool as_mesh : {false, true}) {
        if (as_mesh) scene.object = *builtinObject("cube");
        Renderer renderer(softwareContext(), scene, {48, 36, 4, {}});
        const FrameAovs aovs = renderer.renderAovs(camera);
        int hits = 0;
        for (int y = 0; y < 36; ++y) {
            for (int x = 0; x < 48; ++x) {
                const std::size_t i = static_cast<std::size_t>(48 * y + x);
                if (aovs.id[i] == 0) {
                    EXPECT_EQ(aovs.depth[i], kNoDepth);
                    EXPECT_EQ(pixel(aovs.normal, x, y), V3d(0));
                    continue;
                }
                ++hits;
                EXPECT_EQ(aovs.id[i], 1);
                // The point that depth and ray give lies on the surface of that normal.
                const V3d point =
                    camera.eye + rays.direction(x + 0.5, y + 0.5) * double(aovs.depth[i]);
                const V3d local = (point - V3d(1, 0, 0)) / 0.5, n = pixel(aovs.normal, x, y);
                ASSERT_NEAR(n.length(), 1, 1e-5);
                ASSERT_NEAR(local.dot(n), as_mesh ? 1 / std::sqrt(3.0) : 1, 1e-4) << x << " " << y;
            }
        }
        EXPECT_GT(hits, 100);
    }
}

} // namespace
} // namespace ibl
