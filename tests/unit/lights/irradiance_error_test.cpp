// The error from harmonics against irradiance summed normal by normal.
#include "lights/cut_lights.h"
#include "lights/irradiance_error.h"

#include "core/error.h"
#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace ibl {
namespace {

struct Source {
    V3d direction;
    V3d power;
};

/// The probe as points: n x n to a pixel, each with its share of the solid angle.
std::vector<Source> points(const Image& probe, int n) {
    std::vector<Source> sources;
    for (int j = 0; j < probe.height; ++j) {
        for (int k = 0; k < n; ++k) {
            const double v = (j + (k + 0.5) / n) / probe.height;
            const double omega = 2 * kPi / probe.width / n * std::sin(kPi * v) * 2 *
                                 std::sin(0.5 * kPi / probe.height / n);
            for (int i = 0; i < probe.width * n; ++i) {
                const float* rgb = probe.at(i / n, j);
                sources.push_back({latlongDirection((i + 0.5) / (probe.width * n), v),
                                   V3d(rgb[0], rgb[1], rgb[2]) * omega});
            }
        }
    }
    return sources;
}

V3d irradianceAt(const V3d& normal, const std::vector<Source>& sources) {
    V3d sum(0);
    for (const Source& s : sources)
        sum += s.power * std::max(0.0, normal.dot(s.direction));
    return sum;
}

/// Relative RMSE over `normals` directions of a Fibonacci spiral.
double bruteError(const std::vector<Source>& probe, const std::vector<Light>& lights, int normals) {
    std::vector<Source> sources;
    for (const Light& light : lights)
        sources.push_back({light.direction, light.irradiance});
    double error = 0, norm = 0;
    for (int i = 0; i < normals; ++i) {
        const double y = 1 - (2 * i + 1.0) / normals, turn = i * kPi * (3 - std::sqrt(5.0));
        const double s = std::sqrt(1 - y * y);
        const V3d normal(s * std::cos(turn), y, s * std::sin(turn));
        const V3d exact = irradianceAt(normal, probe);
        error += (irradianceAt(normal, sources) - exact).length2();
        norm += exact.length2();
    }
    return std::sqrt(error / norm);
}

LightSet lightsOfProbe(const Image& image, LightMethod method, int count,
                       LightPlacement placement = LightPlacement::centroid) {
    LightRequest request;
    request.method = method;
    request.count = count;
    request.placement = placement;
    return cutLights(image, request, 2);
}

TEST(IrradianceError, IsThatOfTheSumOverNormals) {
    Image image = noise(32, 16, 31);
    setPixel(image, 31, 3, 900.f, 700.f, 500.f);
    const std::vector<Source> probe = points(image, 6);
    for (const LightMethod method :
         {LightMethod::median, LightMethod::variance, LightMethod::importance}) {
        for (const int count : {1, 6, 40}) {
            const LightSet set = lightsOfProbe(image, method, count);
            const double exact = bruteError(probe, set.lights, 2000);
            EXPECT_NEAR(set.irradiance_error, exact, 0.03 * exact)
                << methodName(method) << " " << count;
        }
    }
}

TEST(IrradianceError, SeesASunAtAPoleAndAcrossTheSeam) {
    for (const auto& [x, y] : {std::pair{0, 0}, {63, 31}, {63, 14}, {0, 17}}) {
        Image image = filled(64, 32, 0.01f);
        setPixel(image, x, y, 3000.f, 2000.f, 1000.f);
        const LightSet set = lightsOfProbe(image, LightMethod::median, 5);
        const double exact = bruteError(points(image, 4), set.lights, 2000);
        EXPECT_NEAR(set.irradiance_error, exact, 0.03 * exact) << x << " " << y;
    }
}

TEST(IrradianceError, OneLightOfAnEvenSkyIsAlwaysAsWrong) {
    // A cosine against a constant: E_exact = pi, the light's is 4 pi max(0, cos). The mean square
    // of the difference is pi^2 + 16 pi^2 / 6 - 8 pi^2 / 4 = (5/3) pi^2.
    const LightSet set = lightsOfProbe(filled(256, 128, 1.f), LightMethod::median, 1);
    EXPECT_NEAR(set.irradiance_error, std::sqrt(5.0 / 3), 1e-4);
}

TEST(IrradianceError, CentroidsAreBetterThanCentres) {
    const Image image = noise(128, 64, 32);
    EXPECT_LT(
        1.5 * lightsOfProbe(image, LightMethod::median, 64).irradiance_error,
        lightsOfProbe(image, LightMethod::median, 64, LightPlacement::centre).irradiance_error);
}

TEST(IrradianceError, OfALightThatIsTheProbe) {
    Image image = filled(256, 128, 0.f);
    setPixel(image, 100, 40, 1e9f, 1e9f, 1e9f);
    EXPECT_LT(lightsOfProbe(image, LightMethod::median, 4).irradiance_error, 1e-3);
    EXPECT_EQ(lightsOfProbe(filled(8, 4, 0.f), LightMethod::median, 4).irradiance_error, 0);
}

TEST(IrradiancePower, OfAFewLightsIsThatOfTheirHarmonics) {
    Image image = noise(32, 16, 35);
    setPixel(image, 0, 0, 90.f, -20.f, 5.f);
    const std::vector<Light> lights = lightsOfProbe(image, LightMethod::median, 5).lights;
    for (const int degree : {2, 16, 64}) {
        const IrradianceWeights weights = irradianceWeights(degree);
        const double expected = irradiancePower(lightHarmonics(lights, degree, 1), weights);
        EXPECT_NEAR(irradiancePower(lights, weights), expected, 1e-12 * expected) << degree;
    }
}

TEST(IrradiancePower, BeyondADegreeIsTheSumOverHigherOnes) {
    const std::vector<double> weights = irradianceWeights(40000).even;
    for (const double radius : {1e-3, 5e-3, 0.02, 0.1, 0.8}) {
        Light light;
        light.irradiance = {2, 1, 0.5};
        light.radius = radius;
        for (const int degree : {64, 256}) {
            double sum = 0;
            for (std::size_t i = static_cast<std::size_t>(degree) / 2 + 1; i < weights.size();
                 ++i) {
                const double l = 2.0 * static_cast<double>(i);
                const double part = 1 - std::exp(-l * l * radius * radius / 4);
                sum += weights[i] * (2 * l + 1) / (4 * kPi) * 5.25 * part * part;
            }
            EXPECT_NEAR(powerBeyond(degree, light), sum, 0.02 * sum) << radius << " " << degree;
        }
    }
}

TEST(IrradianceError, SeesThatASmallSunIsNoPoint) {
    // Of one pixel, whose light differs from it only where normals have it on their horizon.
    Image image = filled(256, 128, 0.f);
    setPixel(image, 60, 40, 1.f, 1.f, 1.f);
    const LightSet set = lightsOfProbe(image, LightMethod::median, 1);
    std::vector<Source> sun = points(image, 10);
    std::erase_if(sun, [](const Source& s) { return s.power.x == 0; });
    EXPECT_EQ(sun.size(), 100u);
    const double exact = bruteError(sun, set.lights, 200000);
    EXPECT_NEAR(set.irradiance_error, exact, 0.05 * exact);
}

TEST(MaxError, NoSmallerCountOfTheCutsKeepsIt) {
    // Few lights, where hardly a count can be skipped, and more than the first 64 cuts have.
    const Image image = noise(32, 16, 33);
    for (const LightMethod method : {LightMethod::median, LightMethod::variance}) {
        for (const double wanted : {0.1, 0.01}) {
            LightRequest request;
            request.method = method;
            request.max_error = wanted;
            const LightSet set = cutLights(image, request, 2);
            const int found = static_cast<int>(set.lights.size());
            ASSERT_GT(found, wanted == 0.1 ? 4 : 64);
            EXPECT_LE(set.irradiance_error, wanted);
            EXPECT_NEAR(lightsOfProbe(image, method, found).irradiance_error, set.irradiance_error,
                        1e-9);
            for (int count = 1; count < found; ++count) {
                EXPECT_GT(lightsOfProbe(image, method, count).irradiance_error, wanted)
                    << methodName(method) << " " << count << " of " << found;
            }
        }
    }
}

TEST(MaxError, TellsHowFarTheSearchHasCome) {
    const Image image = noise(256, 128, 33);
    std::vector<double> told;
    LightRequest request;
    request.max_error =
        0.98 * lightsOfProbe(image, LightMethod::median, kMostLights).irradiance_error;
    request.progress = [&](double done) { told.push_back(done); };
    EXPECT_THROW(cutLights(image, request, 2), Error);
    ASSERT_GT(told.size(), 20u);
    EXPECT_TRUE(std::ranges::is_sorted(told, std::less_equal())); // each is told once
    EXPECT_LT(told[0], 0.1);
    EXPECT_EQ(told.back(), 1); // wipes the line
}

TEST(MaxError, ThatPixelsCannotGiveIsRefused) {
    LightRequest request;
    request.max_error = 1e-6;
    EXPECT_THROW(cutLights(noise(4, 2, 34), request, 1), Error);
    EXPECT_TRUE(cutLights(filled(4, 2, 0.f), request, 1).lights.empty());
}

} // namespace
} // namespace ibl
