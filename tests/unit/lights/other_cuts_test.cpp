#include "lights/cut_lights.h"
#include "lights/cutting.h"
#include "lights/moment_table.h"
#include "panorama/builtin.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <utility>

namespace ibl {
namespace {

LightSet lightsOfProbe(const Image& image, LightMethod method, int count, int threads = 2) {
    LightRequest request;
    request.method = method;
    request.count = count;
    return cutLights(image, request, threads);
}

/// sum of luminance times squared distance from the centroid, pixels divided into 8 x 8 points.
double bruteVariance(const Image& image, const PixelRegion& r) {
    constexpr int kPoints = 8;
    std::vector<std::pair<V3d, double>> points;
    V3d mean(0);
    double total = 0;
    for (int j = r.y; j < r.y + r.height; ++j) {
        for (int k = r.x; k < r.x + r.width; ++k) {
            const float* rgb = image.at(k % image.width, j);
            const double y = 0.2125 * rgb[0] + 0.7154 * rgb[1] + 0.0721 * rgb[2];
            for (int p = 0; p < kPoints * kPoints; ++p) {
                const double v = (j + (p / kPoints + 0.5) / kPoints) / image.height;
                const double u = (k + (p % kPoints + 0.5) / kPoints) / image.width;
                const V3d d = latlongDirection(u, v);
                const double w = y * std::sin(kPi * v);
                points.emplace_back(d, w);
                mean += d * w;
                total += w;
            }
        }
    }
    mean /= total;
    double sum = 0;
    for (const auto& [d, w] : points)
        sum += w * (d - mean).length2();
    return sum / total;
}

TEST(MomentTable, VarianceIsThatOfThePoints) {
    const Image image = noise(37, 19, 41);
    const MomentTable table(image, 0, 2);
    for (const PixelRegion r : {PixelRegion{0, 0, 37, 19}, PixelRegion{5, 3, 7, 9},
                                PixelRegion{30, 0, 20, 4}, PixelRegion{36, 18, 1, 1}}) {
        const double expected = bruteVariance(image, r);
        EXPECT_NEAR(table.variance(r) / static_cast<double>(table.energy(r)), expected,
                    0.01 * expected);
    }
}

TEST(MomentTable, BlocksHoldTheirPixels) {
    const Image image = noise(37, 19, 41);
    const MomentTable fine(image, 0, 2);
    for (const int shift : {1, 2, 3}) {
        const MomentTable coarse(image, shift, 2);
        const int width = coarse.width(), height = coarse.height();
        EXPECT_EQ(width, (37 + (1 << shift) - 1) >> shift);
        for (const PixelRegion blocks :
             {PixelRegion{0, 0, width, height}, PixelRegion{1, 1, 2, 1},
              PixelRegion{width - 1, 0, 3, height}, PixelRegion{width - 1, height - 1, 1, 1},
              PixelRegion{2, 0, width, 2}}) {
            const PixelRegion pixels = coarse.pixels(blocks);
            const double whole = static_cast<double>(fine.energy(pixels));
            EXPECT_NEAR(static_cast<double>(coarse.energy(blocks)), whole, 1e-12 * whole);
            EXPECT_NEAR(coarse.variance(blocks), fine.variance(pixels), 1e-12 * whole);
        }
    }
}

TEST(MomentTable, ADimRegionBesideASunIsNotLost) {
    Image image = filled(128, 64, 1e-3f);
    setPixel(image, 10, 5, 1e9f, 1e9f, 1e9f);
    const MomentTable table(image, 0, 2);
    const PixelRegion dim{100, 30, 8, 6};
    const double expected = bruteVariance(image, dim);
    EXPECT_NEAR(table.variance(dim) / static_cast<double>(table.energy(dim)), expected,
                0.02 * expected);
}

TEST(VarianceCut, EachCutMakesTheLargerVarianceLeast) {
    const MomentTable table(noise(24, 12, 42), 0, 1);
    const CutTree tree = varianceCut(table, 20);
    for (std::size_t k = 0; k < tree.cut.size(); ++k) {
        const PixelRegion& whole = tree.nodes[static_cast<std::size_t>(tree.cut[k])];
        const double larger =
            std::max(table.variance(tree.nodes[2 * k + 1]), table.variance(tree.nodes[2 * k + 2]));
        for (const bool longitude : {false, true}) {
            for (int first = 1; first < (longitude ? whole.width : whole.height); ++first) {
                const auto [a, b] = cutAt(table.width(), whole, longitude, first);
                EXPECT_LE(larger, std::max(table.variance(a), table.variance(b)) * (1 + 1e-9));
            }
        }
    }
}

/// A sky of 1 with a sun of 3 x 3 pixels, about as bright as all of it.
Image sunProbe() {
    Image image = filled(256, 128, 1.f);
    for (int y = 40; y < 43; ++y) {
        for (int x = 50; x < 53; ++x)
            setPixel(image, x, y, 2000.f, 1900.f, 1800.f);
    }
    return image;
}

TEST(VarianceCut, DoesNotCutThroughASun) {
    double sun = 0;
    for (int y = 40; y < 43; ++y)
        sun += 3 * 2000 * latlongPixelSolidAngle(256, 128, y);
    const Image image = sunProbe();
    EXPECT_GT(lightsOfProbe(image, LightMethod::variance, 16).lights[0].irradiance.x, 0.98 * sun);
    EXPECT_LT(lightsOfProbe(image, LightMethod::median, 16).lights[0].irradiance.x, 0.6 * sun);
}

void expectBetterThanMedian(const Image& image, std::initializer_list<int> counts) {
    for (const int count : counts) {
        EXPECT_LT(lightsOfProbe(image, LightMethod::variance, count).irradiance_error,
                  0.8 * lightsOfProbe(image, LightMethod::median, count).irradiance_error)
            << count;
    }
}

TEST(VarianceCut, IsBetterThanTheMedianWhereASourceDominates) {
    // In an even sky the median's first eight regions are octants, whose errors cancel one another
    // up to degree 3, so that at 16 it has the luck.
    expectBetterThanMedian(sunProbe(), {4, 64, 256});
    // In a sky brighter towards the horizon and the sun's side it has that luck at 4.
    Image image = sunProbe();
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            const V3d d = latlongDirection((x + 0.5) / 256, (y + 0.5) / 128);
            const float sky = static_cast<float>(std::exp(0.5 * d.x - 2 * std::abs(d.y)));
            if (image.at(x, y)[0] == 1.f) setPixel(image, x, y, sky, sky, sky);
        }
    }
    expectBetterThanMedian(image, {16, 64, 256});
}

TEST(VarianceCut, IsBetterThanTheMedianUnderACloudlessSky) {
    const Image sky = builtinProbe("builtin:sky", 512, 0).image;
    for (const int count : {64, 128, 256, 512, 1024, 2048, 4096}) {
        EXPECT_LT(lightsOfProbe(sky, LightMethod::variance, count).irradiance_error,
                  lightsOfProbe(sky, LightMethod::median, count).irradiance_error)
            << count;
    }
}

TEST(MomentTable, ColoursAreDisplacedWhereTheirCentroidsDiffer) {
    Image image = filled(16, 8, 0.f);
    setPixel(image, 2, 3, 4.f, 1.f, 1.f);
    setPixel(image, 9, 5, 1.f, 2.f, 8.f);
    const MomentTable table(image, 0, 1);
    constexpr int kPoints = 32;
    std::array<double, 3> energy{};
    std::array<V3d, 3> moment{V3d(0), V3d(0), V3d(0)};
    for (const auto& [x, y] : {std::pair(2, 3), {9, 5}}) {
        for (int p = 0; p < kPoints * kPoints; ++p) {
            const double v = (y + (p / kPoints + 0.5) / kPoints) / image.height;
            const V3d d = latlongDirection((x + (p % kPoints + 0.5) / kPoints) / image.width, v);
            for (int c = 0; c < 3; ++c) {
                const double value = image.at(x, y)[c] * std::sin(kPi * v);
                energy[c] += value;
                moment[c] += d * value;
            }
        }
    }
    const V3d weights(0.2125, 0.7154, 0.0721);
    V3d whole(0);
    double lit = 0, squares = 0;
    for (int c = 0; c < 3; ++c) {
        whole += moment[c] * weights[c];
        lit += energy[c] * weights[c];
    }
    for (int c = 0; c < 3; ++c)
        squares += (moment[c] - whole * (energy[c] / lit)).length2();
    const PixelRegion all{0, 0, 16, 8};
    EXPECT_NEAR(table.colourDisplacement(all) / static_cast<double>(table.energy(all)),
                std::sqrt(squares / 3) / lit, 1e-3);
    // One colour alone is where its luminance is.
    EXPECT_NEAR(MomentTable(filled(16, 8, 3.f), 0, 1).colourDisplacement(all) /
                    static_cast<double>(table.energy(all)),
                0, 1e-12);
}

TEST(VarianceCut, RingingBesideASunDoesNotStallIt) {
    // A codec's undershoot: about the sun, pixels far below zero.
    Image ringing = sunProbe();
    for (int y = 37; y < 46; ++y) {
        for (int x = 47; x < 56; ++x) {
            if (ringing.at(x, y)[0] == 1.f && (x + y) % 2 == 0)
                setPixel(ringing, x, y, -300.f, -300.f, -300.f);
        }
    }
    const double error = lightsOfProbe(ringing, LightMethod::variance, 1024).irradiance_error;
    EXPECT_LT(error, 2 * lightsOfProbe(sunProbe(), LightMethod::variance, 1024).irradiance_error);
    EXPECT_LT(error, lightsOfProbe(ringing, LightMethod::median, 1024).irradiance_error);
}

TEST(VarianceCut, ALargeProbesBlocksDoNotHideItsFewLitPixels) {
    // 2048 x 1024 pixels are cut in blocks of four; here only these pixels are lit.
    Image image = filled(2048, 1024, 0.f);
    for (int k = 0; k < 6; ++k)
        setPixel(image, 1000 + k % 3, 500 + k / 3, 1.f, 1.f, 1.f);
    EXPECT_EQ(lightsOfProbe(image, LightMethod::variance, 6).lights.size(), 6u);
    for (int x = 0; x < 2048; ++x)
        setPixel(image, x, 300, 1e-3f, 1e-3f, 1e-3f);
    const LightSet set = lightsOfProbe(image, LightMethod::variance, 9);
    EXPECT_EQ(set.lights.size(), 9u);
    const auto expected = integral(image);
    EXPECT_NEAR(totalIrradiance(set.lights).x, static_cast<double>(expected[0]),
                1e-12 * static_cast<double>(expected[0]));
}

TEST(AllMethods, KeepEnergyAndGiveTheCountAsked) {
    Image image = noise(64, 32, 44);
    setPixel(image, 3, 3, 1e9f, 1e8f, 1e7f);
    setPixel(image, 20, 16, -100.f, 5.f, -10.f);
    const auto expected = integral(image);
    for (const LightMethod method :
         {LightMethod::median, LightMethod::variance, LightMethod::importance}) {
        for (const int count : {1, 2, 7, 64, 500}) {
            const std::vector<Light> lights = lightsOfProbe(image, method, count).lights;
            EXPECT_EQ(lights.size(), static_cast<std::size_t>(count));
            const V3d total = totalIrradiance(lights);
            for (int c = 0; c < 3; ++c) {
                const double exact = static_cast<double>(expected[static_cast<std::size_t>(c)]);
                EXPECT_NEAR(total[c], exact, 1e-9 * std::abs(exact)) << methodName(method);
            }
        }
    }
}

TEST(AllMethods, OnePixelAndMoreLightsThanPixels) {
    for (const LightMethod method : {LightMethod::median, LightMethod::variance}) {
        EXPECT_EQ(lightsOfProbe(filled(1, 1, 2.f), method, 8).lights.size(), 1u);
        EXPECT_EQ(lightsOfProbe(filled(3, 2, 2.f), method, 65536).lights.size(), 6u);
    }
    EXPECT_EQ(lightsOfProbe(filled(1, 1, 2.f), LightMethod::importance, 65536).lights.size(),
              65536u);
}

TEST(AllMethods, BlackAndNegativeProbesHaveNone) {
    for (const LightMethod method :
         {LightMethod::median, LightMethod::variance, LightMethod::importance}) {
        for (const float value : {0.f, -1.f})
            EXPECT_TRUE(lightsOfProbe(filled(16, 8, value), method, 8).lights.empty());
    }
}

TEST(AllMethods, ASunOverAPoleIsOneDirection) {
    // Rows 0 and 1 of 64, i.e. 5.6 degrees about the pole, all of their columns.
    for (const bool south : {false, true}) {
        Image image = filled(128, 64, 1e-3f);
        for (int x = 0; x < 128; ++x) {
            for (const int y : {0, 1})
                setPixel(image, x, south ? 63 - y : y, 1e6f, 1e6f, 1e6f);
        }
        for (const LightMethod method :
             {LightMethod::median, LightMethod::variance, LightMethod::importance}) {
            for (const int count : {1, 5, 64}) {
                const LightSet set = lightsOfProbe(image, method, count);
                for (const Light& light : set.lights) {
                    if (light.irradiance.x < 1) continue;
                    EXPECT_GT((south ? -1 : 1) * light.direction.y, std::cos(5.7 * kPi / 180))
                        << methodName(method) << " " << count;
                }
                const double most = method == LightMethod::importance ? 0.1 : 0.01;
                EXPECT_LT(set.irradiance_error, most) << methodName(method) << " " << count;
            }
        }
    }
}

TEST(Importance, AnyPrefixOfTheSphereGetsItsShareOfLights) {
    const Image image = noise(64, 32, 45);
    const std::vector<Light> lights = lightsOfProbe(image, LightMethod::importance, 4096).lights;
    const SummedAreaTable table(image, 0, 1);
    const double total = static_cast<double>(table.energy({0, 0, 64, 32}));
    for (const PixelRegion r :
         {PixelRegion{0, 0, 32, 32}, PixelRegion{0, 0, 64, 9}, PixelRegion{10, 5, 30, 20}}) {
        const auto inside = std::count_if(lights.begin(), lights.end(), [&](const Light& light) {
            const V2d at = latlongPoint(light.direction);
            return at.x * 64 >= r.x && at.x * 64 < r.x + r.width && at.y * 32 >= r.y &&
                   at.y * 32 < r.y + r.height;
        });
        EXPECT_NEAR(static_cast<double>(inside) / 4096,
                    static_cast<double>(table.energy(r)) / total, 0.01);
    }
}

} // namespace
} // namespace ibl
