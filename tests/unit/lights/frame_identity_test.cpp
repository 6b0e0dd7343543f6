#include "lights/cut_lights.h"
#include "lights/frame_identity.h"
#include "lights/lights_json.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

#include <set>

namespace ibl {
namespace {

Image changed(const Image& image, float most, unsigned seed) {
    Image other = image;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> factor(1 - most, 1 + most);
    for (float& value : other.pixels)
        value *= factor(random);
    return other;
}

LightSet next(const Image& image, const LightSet* previous, LightMethod method) {
    LightRequest request;
    request.method = method;
    request.count = 64;
    request.previous = previous;
    return cutLights(image, request, 2);
}

TEST(Frames, LightsMoveInProportionToTheProbesChange) {
    const Image image = noise(128, 64, 51);
    for (const LightMethod method : {LightMethod::median, LightMethod::variance}) {
        const LightSet first = next(image, nullptr, method);
        for (const float most : {0.f, 0.01f, 0.1f}) {
            const LightSet second = next(changed(image, most, 5), &first, method);
            ASSERT_TRUE(second.change);
            EXPECT_TRUE(second.change->same_regions);
            EXPECT_EQ(second.change->kept, 64);
            // Regions are some 25 degrees wide, of 32 pixels and more.
            EXPECT_LE(second.change->movement, 0.1 * most + 1e-12);
            EXPECT_LE(second.change->light_change, 0.5 * most + 1e-12);
            for (std::size_t i = 0; i < 64; ++i)
                EXPECT_EQ(second.lights[i].id, first.lights[i].id);
        }
    }
}

TEST(Frames, WithoutThePreviousFrameLightsJump) {
    const Image image = noise(128, 64, 51);
    LightSet first = next(image, nullptr, LightMethod::median);
    LightSet alone = next(changed(image, 0.1f, 5), nullptr, LightMethod::median);
    const FrameChange jumped = keepIdentity(alone.lights, first.lights);
    const LightSet second = next(changed(image, 0.1f, 5), &first, LightMethod::median);
    EXPECT_GT(jumped.movement, 3 * second.change->movement);
}

TEST(Frames, AnotherProbeIsCutAnewAndIdsStayUnique) {
    const LightSet first = next(noise(128, 64, 51), nullptr, LightMethod::median);
    Image other = filled(128, 64, 1e-3f);
    for (int x = 30; x < 50; ++x)
        setPixel(other, x, 20, 1000.f, 1000.f, 1000.f);
    const LightSet second = next(other, &first, LightMethod::median);
    EXPECT_FALSE(second.change->same_regions);
    EXPECT_GT(second.change->light_change, 0.5);
    std::set<int> ids;
    for (const Light& light : second.lights)
        ids.insert(light.id);
    EXPECT_EQ(ids.size(), second.lights.size());
    EXPECT_EQ(second.irradiance_error, next(other, nullptr, LightMethod::median).irradiance_error);
}

TEST(Frames, ThePreviousFrameMayComeFromItsFile) {
    const Image image = noise(64, 32, 52), later = changed(image, 0.05f, 6);
    const LightSet first = next(image, nullptr, LightMethod::median);
    const LightSet read = readLightsJson(lightsJson(first, 2), "x");
    EXPECT_EQ(lightsJson(next(later, &read, LightMethod::median), 2),
              lightsJson(next(later, &first, LightMethod::median), 1));
}

TEST(Frames, EveryRegionComesBackFromItsAngles) {
    for (const auto& [width, height] : {std::pair{64, 32}, {101, 53}, {1, 1}, {4096, 2048}}) {
        for (const PixelRegion r :
             {PixelRegion{0, 0, width, height}, PixelRegion{width - 1, 0, 1, 1},
              PixelRegion{width / 2, height / 2, (width + 1) / 2, 1},
              PixelRegion{width / 3, height - 1, width, 1}}) {
            const PixelRegion back = pixelRegion(angularRegion(r, width, height), width, height);
            EXPECT_EQ(back.x, r.x);
            EXPECT_EQ(back.y, r.y);
            EXPECT_EQ(back.width, r.width);
            EXPECT_EQ(back.height, r.height);
        }
    }
}

} // namespace
} // namespace ibl
