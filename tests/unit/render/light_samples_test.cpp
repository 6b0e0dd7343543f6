// Lights spread over the samples of a pixel.
#include "scene_support.h"

#include "render/light_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace ibl {
namespace {

std::vector<SceneLight> skyLights(std::size_t count, double brightest) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<SceneLight> lights(count);
    for (SceneLight& light : lights) {
        const V3d d(normal(random), std::abs(normal(random)) + 0.2, normal(random));
        light.direction = d.normalized();
        light.strength = V3d(1, 2, 1.5) / static_cast<double>(count);
    }
    lights.back().strength *= brightest;
    return lights;
}

TEST(LightSamples, EveryLightCountsAsOneInSmallSteps) {
    for (const int samples : {1, 3, 7, 16, 100}) {
        for (const std::size_t count : {1u, 5u, 64u, 1000u}) {
            std::vector<SceneLight> lights = skyLights(count, 50);
            lights[0].type = count > 1 ? LightType::point : LightType::directional;
            double total = 0;
            for (const SceneLight& light : lights)
                total += light.strength.x;
            const auto lists = spreadLights(lights, samples, 1.0 / 256);
            ASSERT_EQ(lists.size(), static_cast<std::size_t>(samples));
            std::vector<double> sum(count, 0);
            std::vector<int> times(count, 0);
            for (const auto& list : lists) {
                for (std::size_t k = 0; k < list.size(); ++k) {
                    ASSERT_TRUE(k == 0 || list[k - 1].light < list[k].light);
                    sum[list[k].light] += list[k].weight / samples;
                    ++times[list[k].light];
                }
            }
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_NEAR(sum[i], 1, 1e-12) << i;
                const double step = lights[i].strength.x / total / times[i];
                ASSERT_TRUE(times[i] == samples || step <= 1.0 / 256) << i;
            }
            EXPECT_EQ(times[0], samples);
            EXPECT_EQ(times[count - 1], samples < 13 || count < 1000 ? samples : 13); // 50 / 1049
        }
    }
}

TEST(LightSamples, AreOfOneNumberAndFromAllOverTheList) {
    const auto lists = spreadLights(skyLights(256, 1), 16, 1.0 / 256);
    for (const auto& list : lists) {
        EXPECT_NEAR(static_cast<double>(list.size()), 16, 3);
        const auto early =
            std::ranges::count_if(list, [](const SampledLight& l) { return l.light < 128; });
        EXPECT_NEAR(static_cast<double>(early), 8, 2);
    }
}

class GroundUnderLights : public testing::Test {
protected:
    GroundUnderLights() {
        scene_.probe = &probe_;
        scene_.object = *builtinObject("torus");
        scene_.background = ColorBackground(1, 1, 1);
        scene_.ground = Ground{-1, V3d(0.3)};
    }

    Renderer renderer() { return {softwareContext(), scene_, {48, 48, 16, {}}}; }

    Scene scene_;
    Camera camera_ = orbitCamera(30, 30, 5, V3d(0), 40);

private:
    Panorama probe_ = constantProbe(1);
};

// Sixteen lights of one strength are in every sample, and their shadows add up.
TEST_F(GroundUnderLights, SpreadLightsGiveTheSumOfThoseThatAreNot) {
    const std::vector<SceneLight> lights = skyLights(256, 1);
    scene_.lights = lights;
    const Image spread = renderer().render(camera_);
    std::vector<double> kept(spread.pixels.size(), 0);
    for (std::size_t first = 0; first < lights.size(); first += 16) {
        scene_.lights.assign(lights.begin() + static_cast<std::ptrdiff_t>(first),
                             lights.begin() + static_cast<std::ptrdiff_t>(first + 16));
        const Image some = renderer().render(camera_);
        for (std::size_t i = 0; i < kept.size(); ++i)
            kept[i] += 1 - some.pixels[i];
    }
    double error = 0, norm = 0, darkest = 1;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        error += std::pow(kept[i] - (1 - spread.pixels[i]), 2);
        norm += std::pow(1 - kept[i], 2);
        darkest = std::min(darkest, 1 - kept[i]);
    }
    EXPECT_LT(std::sqrt(error / norm), 2e-3);
    EXPECT_LT(darkest, 0.95); // there is a shadow
    std::printf("256 lights over 16 samples: relative RMSE %.1e\n", std::sqrt(error / norm));
}

// A lobe sees few of the lights, and an outline has few of a pixel's samples: with the samples of a
// light that a surface without a lobe has, this is nearly three times as far off.
TEST(LightSamples, OutlinesOfMaterialsWithALobeDoNotSparkle) {
    const std::vector<SceneLight> lights = skyLights(256, 1);
    Scene scene;
    scene.object = *builtinObject("teapot");
    scene.background = NoBackground{};
    scene.material = Material(Shader::ward);
    const Camera camera = orbitCamera(30, 20, 4, V3d(0), 40);
    const auto draw = [&](std::size_t from, std::size_t to) {
        scene.lights.assign(lights.begin() + static_cast<std::ptrdiff_t>(from),
                            lights.begin() + static_cast<std::ptrdiff_t>(to));
        return Renderer(softwareContext(), scene, {64, 64, 16, {}, 256}).render(camera);
    };
    const Image spread = draw(0, lights.size());
    std::vector<double> all(spread.pixels.size(), 0); // every light in every sample
    for (std::size_t first = 0; first < lights.size(); first += 64) {
        const Image some = draw(first, first + 64);
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] += some.pixels[i];
    }
    double error = 0, norm = 0, worst = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i % 4 == 3) continue;
        const double d = std::abs(all[i] - spread.pixels[i]);
        error += d * d;
        norm += all[i] * all[i];
        worst = std::max(worst, d);
    }
    std::printf("256 lights on Ward's teapot: relative RMSE %.1e, worst %.1e\n",
                std::sqrt(error / norm), worst);
    EXPECT_LT(std::sqrt(error / norm), 1.2e-2); // 8.1e-3 and 2.2e-2
}

TEST_F(GroundUnderLights, ShadowsThatAreKeptAreThoseOfTheFrame) {
    scene_.lights = skyLights(40, 1);
    Renderer kept = renderer();
    kept.render(camera_);
    const Camera other = orbitCamera(80, 20, 6, V3d(0), 40);
    kept.change(scene_.material, scene_.turn, scene_.placement);
    EXPECT_EQ(kept.render(other).pixels, renderer().render(other).pixels);
    scene_.placement.turn.yaw = 50;
    kept.change(scene_.material, scene_.turn, scene_.placement);
    EXPECT_EQ(kept.render(other).pixels, renderer().render(other).pixels);
    scene_.turn.yaw = 70;
    kept.change(scene_.material, scene_.turn, scene_.placement);
    EXPECT_EQ(kept.render(other).pixels, renderer().render(other).pixels);
}

} // namespace
} // namespace ibl
