#include "lights/cut_lights.h"
#include "lights/lamp.h"

#include "core/error.h"
#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

/// A disc of radiance over a sky, each pixel the mean of 8 x 8 points.
Image discProbe(const V3d& axis, double radius, float disc, float sky, int height = 180) {
    Image image(2 * height, height, 3);
    constexpr int kPoints = 8;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            int inside = 0;
            for (int p = 0; p < kPoints * kPoints; ++p) {
                const V3d d = latlongDirection((x + (p % kPoints + 0.5) / kPoints) / (2 * height),
                                               (y + (p / kPoints + 0.5) / kPoints) / height);
                if ((d - axis).length() < 2 * std::sin(radius / 2)) ++inside;
            }
            const float share = static_cast<float>(inside) / (kPoints * kPoints);
            const float value = sky + share * (disc - sky);
            setPixel(image, x, y, value, 0.9f * value, 0.5f * value);
        }
    }
    return image;
}

TEST(Lamp, ADiscIsFoundWholeWhereverItStands) {
    const double radius = 2.5 * kPi / 180;
    const double solid_angle = 2 * kPi * (1 - std::cos(radius));
    // In the open, across the seam, over either pole.
    for (const V3d& axis :
         {V3d(0.6, 0.5, 0.62), V3d(0.01, 0.2, -1), V3d(0.01, 1, 0.01), V3d(0.02, -1, -0.01)}) {
        const V3d towards = axis.normalized();
        const Image image = discProbe(towards, radius, 5000.f, 1.f);
        const Lamp lamp = findLamp(image, "x");
        EXPECT_LT((lamp.light.direction - towards).length(), 0.05 * kPi / 180);
        const double above = static_cast<double>(integral(image)[0]) - 4 * kPi;
        EXPECT_NEAR(above, 4999 * solid_angle, 0.03 * 4999 * solid_angle);
        EXPECT_NEAR(lamp.light.irradiance.x, above, 1e-4 * above);
        EXPECT_NEAR(*lamp.light.angular_radius, radius, 0.05 * radius);
        for (const float value : lamp.residual.pixels)
            EXPECT_LE(value, 1.f);
    }
}

TEST(Lamp, LampAndResidualAddUpToTheProbe) {
    Image image = discProbe(V3d(0.6, 0.5, 0.62).normalized(), 0.02, 1e9f, 1e-3f, 64);
    setPixel(image, 20, 20, -5.f, -3.f, 0.f);
    const Lamp lamp = findLamp(image, "x");
    const auto whole = integral(image), rest = integral(lamp.residual);
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(c);
        EXPECT_NEAR(static_cast<double>((rest[i] + lamp.light.irradiance[c]) / whole[i]), 1, 1e-12);
    }
    EXPECT_EQ(lamp.residual.at(20, 20)[0], -5.f);
}

TEST(Lamp, ErrorOfLampAndResidualIsSmall) {
    const Image image = discProbe(V3d(0.6, 0.5, 0.62).normalized(), 0.02, 1e4f, 1.f);
    const Lamp lamp = findLamp(image, "x");
    EXPECT_LT(lampError(image, lamp.residual, lamp.light, 2), 1e-3);
    Light aside = lamp.light;
    aside.direction = V3d(0.6, 0.4, 0.62).normalized();
    EXPECT_GT(lampError(image, lamp.residual, aside, 2), 1e-2);
}

TEST(Lamp, RefusedWhereThereIsNone) {
    EXPECT_THROW(findLamp(filled(64, 32, 1.f), "x"), Error);
    EXPECT_THROW(findLamp(filled(64, 32, 0.f), "x"), Error);
    EXPECT_THROW(findLamp(filled(1, 1, 9.f), "x"), Error);
    // As wide as a window.
    EXPECT_THROW(findLamp(discProbe(V3d(0, 0, 1), 0.6, 500.f, 1.f, 64), "x"), Error);
}

TEST(Lamp, OnePixelInABlackSky) {
    Image image = filled(64, 32, 0.f);
    setPixel(image, 0, 0, 1e9f, 1e9f, 1e9f);
    const Lamp lamp = findLamp(image, "x");
    EXPECT_NEAR(lamp.light.solid_angle, latlongPixelSolidAngle(64, 32, 0), 1e-12);
    for (const float value : lamp.residual.pixels)
        EXPECT_EQ(value, 0.f);
}

} // namespace
} // namespace ibl
