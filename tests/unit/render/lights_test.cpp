// Which lights are drawn, how they add up, and what their maps hold.
#include "lights_support.h"

#include "core/error.h"
#include "render/shadow_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace ibl {
namespace {

TEST(Lights, BatchesAddUp) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<SceneLight> lights;
    for (int i = 0; i < 300; ++i)
        lights.push_back(
            sunlight({normal(random), normal(random), normal(random)}, V3d(0.01, 0.02, 0.03)));
    const Camera camera = orbitCamera(35, 28, 4, V3d(0), 40);
    for (const int samples : {1, 3}) {
        const auto part = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
            Scene scene = litScene({lights.begin() + from, lights.begin() + to});
            scene.background = NoBackground{};
            return draw(scene, camera, 24, samples);
        };
        const Image all = part(0, 300), one = part(0, 150), other = part(150, 300);
        for (int i = 0; i < 24 * 24; ++i) {
            const std::size_t k = static_cast<std::size_t>(i) * 4;
            ASSERT_NEAR(all.pixels[k], one.pixels[k] + other.pixels[k], 1e-5);
            ASSERT_EQ(all.pixels[k + 3], one.pixels[k + 3]); // no alpha from later batches
        }
    }
}

// A square in the plane z = 0 that faces +Z.
Mesh squareMesh() {
    return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
            std::vector<V3f>(4, V3f(0, 0, 1)),
            {},
            {0, 1, 2, 0, 2, 3}};
}

TEST(Lights, ThoseThatChangeNoPixelAreNotDrawn) {
    const Camera camera = orbitCamera(0, 0, 4, V3d(0), 40);
    for (const bool mesh : {false, true}) {
        Scene scene = litScene({sunlight({0, 0, 1}, V3d(1)), sunlight({0, 1, 0}, V3d(0)),
                                sunlight({0.1, 0, -1}, V3d(1)), sunlight({1, 0, 0.1}, V3d(1))});
        if (mesh) scene.object.mesh = squareMesh();
        Renderer renderer(softwareContext(), scene, {32, 32, 1, {}});
        const Image chosen = renderer.render(camera);
        const LightCounts counts = renderer.lightCounts();
        EXPECT_EQ(counts.given, 4);
        EXPECT_EQ(counts.black, 1);
        EXPECT_EQ(counts.unseen, 1);
        EXPECT_EQ(counts.drawn, 2);
        Scene fewer = litScene({scene.lights[0], scene.lights[3]}, scene.object.mesh);
        EXPECT_EQ(chosen.pixels, draw(fewer, camera, 32, 1).pixels);
    }
}

TEST(Lights, MapsHoldAllOfTheCaster) {
    const Mesh mesh = *builtinObject("teapot")->mesh;
    const Caster caster = casterOf(mesh.positions);
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 40; ++i) {
        const V3d d(normal(random), normal(random), normal(random));
        const SceneLight light = i % 2 ? sunlight(d, V3d(1)) : lamp(d.normalized() * 2.5, V3d(1));
        const auto views = shadowViews(light, caster, 128);
        ASSERT_EQ(views.size(), 1u);
        V2d least(1e9), most(-1e9);
        for (const V3f& p : mesh.positions) {
            V3d place;
            views[0].map_from_world.multVecMatrix(V3d(p), place);
            ASSERT_TRUE(place.z > 0 && place.z < 1) << place;
            least = {std::min(least.x, place.x), std::min(least.y, place.y)};
            most = {std::max(most.x, place.x), std::max(most.y, place.y)};
        }
        EXPECT_GE(std::min(least.x, least.y), 1.99);
        EXPECT_LE(std::max(most.x, most.y), 126.01);
        EXPECT_GT(std::max(most.x - least.x, most.y - least.y), i % 2 ? 123.9 : 100);
    }
}

TEST(Lights, WhatCannotBeDrawnIsRefused) {
    const auto refused = [](const Scene& scene, const Camera& camera, const std::string& said) {
        try {
            draw(scene, camera, 8, 1);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
            return error.code();
        }
        return ExitCode::done;
    };
    EXPECT_EQ(refused(litScene({}), {}, "give lights"), ExitCode::usage);
    Scene cut = litScene({sunlight({0, 1, 0}, V3d(1))});
    cut.ground = Ground{-0.5, std::nullopt};
    EXPECT_EQ(refused(cut, {}, "cuts the object"), ExitCode::usage);
    cut.ground->height = -1;
    EXPECT_EQ(refused(cut, orbitCamera(0, -30, 4, V3d(0), 40), "below the ground"),
              ExitCode::usage);
    EXPECT_EQ(refused(litScene(std::vector(300, lamp({0, 3, 0}, V3d(1)))), {}, "fewer"),
              ExitCode::input);
}

} // namespace
} // namespace ibl
