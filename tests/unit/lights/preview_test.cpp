#include "lights/cut_lights.h"
#include "lights/preview.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

std::array<int, 3> pixel(const Preview& picture, int x, int y) {
    const auto* rgb = &picture.bytes[3 * (static_cast<std::size_t>(y) * picture.width + x)];
    return {rgb[0], rgb[1], rgb[2]};
}

TEST(Preview, ADotStandsOnTheLamp) {
    Image image = filled(64, 32, 0.1f);
    setPixel(image, 40, 8, 5000.f, 5000.f, 5000.f);
    LightRequest request;
    request.count = 1;
    const Preview picture = drawPreview(image, cutLights(image, request, 1).lights);
    EXPECT_EQ(picture.width, 1024);
    EXPECT_EQ(picture.height, 512);
    // Sixteen to a pixel: the lamp's middle is (40.5, 8.5) * 16.
    EXPECT_EQ(pixel(picture, 648, 136), (std::array{255, 60, 30}));
    EXPECT_NE(pixel(picture, 660, 136), (std::array{255, 60, 30}));
}

TEST(Preview, AnySizeAndNoLights) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, {5000, 3}, {3, 5000}, {1025, 512}, {2048, 1024}}) {
        const Preview picture = drawPreview(filled(width, height, 0.f), {});
        EXPECT_EQ(picture.bytes.size(), 3u * picture.width * picture.height);
        EXPECT_GE(picture.width, 1);
        EXPECT_LE(picture.width, 1024);
        EXPECT_EQ(picture.bytes[0], 0);
    }
}

} // namespace
} // namespace ibl
