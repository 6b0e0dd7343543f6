#include "lights/cut_lights.h"
#include "lights/irradiance_error.h"
#include "lights/matched_places.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace ibl {
namespace {

LightSet lightsOfProbe(const Image& image, LightMethod method, int count, LightPlacement placement,
                       int threads = 2) {
    LightRequest request;
    request.method = method;
    request.count = count;
    request.placement = placement;
    return cutLights(image, request, threads);
}

/// Coloured lights all over the sphere, some at the poles, each of the same radius.
std::vector<Light> scattered(int count, double radius) {
    std::mt19937 random(71);
    std::uniform_real_distribution<double> number(0, 1);
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        const double y = i < 2 ? 1 - 2 * i : 2 * number(random) - 1;
        const double turn = 2 * kPi * number(random), s = std::sqrt(1 - y * y);
        Light light;
        light.direction = {s * std::cos(turn), y, s * std::sin(turn)};
        light.irradiance = {number(random), number(random), number(random)};
        light.radius = radius;
        lights.push_back(light);
    }
    return lights;
}

/// Root of the sum of squares of what the lights' harmonics of degree 1, 2 and 4 lack.
double lack(const std::vector<Light>& lights, const LightHarmonics& probe) {
    LightHarmonics difference = probe;
    difference -= lightHarmonics(lights, probe.degree, 1);
    double sum = 0;
    const auto add = [&](const LightHarmonics::Parts& parts) {
        for (const double part : parts)
            sum += part * part;
    };
    for (const auto& parts : difference.even)
        add(parts);
    for (const auto& parts : difference.first)
        add(parts);
    return std::sqrt(sum);
}

TEST(MatchedPlaces, LightsThatAreTheProbeStay) {
    const std::vector<Light> lights = scattered(40, 0.3);
    std::vector<Light> matched = lights;
    matchPlaces(matched, lightHarmonics(lights, 8, 1), 2);
    for (std::size_t i = 0; i < lights.size(); ++i)
        EXPECT_LT((matched[i].direction - lights[i].direction).length(), 1e-12);
}

TEST(MatchedPlaces, TheProbesHarmonicsComeNear) {
    std::vector<Light> lights = scattered(200, 0.3), turned = lights;
    for (Light& light : turned) { // two degrees about an axis askew
        const V3d axis = V3d(1, 2, 2) / 3.0;
        light.direction = (light.direction + 0.035 * axis.cross(light.direction)).normalized();
    }
    const LightHarmonics probe = lightHarmonics(turned, 4, 1);
    const double before = lack(lights, probe);
    matchPlaces(lights, probe, 2);
    EXPECT_LT(lack(lights, probe), 0.2 * before);
}

/// The coefficients of degree l, one order after the other.
std::vector<LightHarmonics::Parts*> degreeOf(LightHarmonics& harmonics, int l) {
    if (l == 1) return {&harmonics.first[0], &harmonics.first[1]};
    std::vector<LightHarmonics::Parts*> parts;
    for (int m = 0; m <= l; ++m)
        parts.push_back(
            &harmonics.even[harmonics.column(m) + static_cast<std::size_t>(l - m - m % 2) / 2]);
    return parts;
}

// One light, and a probe that is this light but for one degree, in which it stands at w from there.
// The move nearest to all degrees, in irradiance, is w times the part that this degree has in
//
//     sum over l of A_l^2 sum over m of |grad Y_lm|^2,   the inner sum l (l + 1) (2l + 1) / (4 pi).
TEST(MatchedPlaces, DegreesWeighAsInIrradiance) {
    const std::pair<int, double> kernel[] = {{1, 2 * kPi / 3}, {2, kPi / 4}, {4, -kPi / 24}};
    double whole = 0;
    for (const auto& [l, a] : kernel)
        whole += a * a * l * (l + 1) * (2 * l + 1);
    Light light;
    light.direction = V3d(2, 3, 6) / 7.0;
    light.irradiance = V3d(1, 0.5, 0.7);
    light.radius = 0.5;
    Light aside = light;
    const V3d tangent = V3d(3, -2, 0) / std::sqrt(13.0);
    aside.direction = (light.direction + 0.01 * tangent).normalized();
    for (const auto& [l, a] : kernel) {
        LightHarmonics probe = lightHarmonics({light}, 4, 1);
        LightHarmonics other = lightHarmonics({aside}, 4, 1);
        const auto to = degreeOf(probe, l), from = degreeOf(other, l);
        for (std::size_t i = 0; i < to.size(); ++i)
            *to[i] = *from[i];
        std::vector<Light> lights{light};
        matchPlaces(lights, probe, 1);
        const V3d move = (lights[0].direction - light.direction) / 0.01;
        const double part = a * a * l * (l + 1) * (2 * l + 1) / whole;
        EXPECT_NEAR(move.dot(tangent), part, 0.02 * part) << l;
        EXPECT_LT((move - move.dot(tangent) * tangent).length(), 0.02 * part + 0.01) << l;
    }
}

TEST(MatchedPlaces, MovesAreLessThanHalfTheRadius) {
    std::vector<Light> lights = scattered(12, 0.2);
    lights[5].radius = 0;
    lights[6].radius = 1e-3; // a sun
    const std::vector<Light> before = lights;
    std::vector<Light> other = scattered(30, 0);
    matchPlaces(lights, lightHarmonics({other.begin() + 12, other.end()}, 4, 1), 1);
    double farthest = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double move = (lights[i].direction - before[i].direction).length();
        EXPECT_LE(move, 0.5 * lights[i].radius) << i;
        EXPECT_NEAR(lights[i].direction.length(), 1, 1e-12);
        EXPECT_EQ(lights[i].irradiance, before[i].irradiance);
        farthest = std::max(farthest, move);
    }
    EXPECT_GT(farthest, 0.03);
    std::vector<Light> none;
    matchPlaces(none, LightHarmonics(4), 1);
    EXPECT_TRUE(none.empty());
}

/// A sky brighter towards +X, a sun and its glow.
Image sunProbe() {
    Image image(128, 64, 3);
    const V3d sun = V3d(0.5, 0.6, -0.6).normalized();
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 128; ++x) {
            const V3d d = latlongDirection((x + 0.5) / 128, (y + 0.5) / 64);
            const double near = d.dot(sun);
            const float glow = static_cast<float>(std::exp(d.x) + 20 * std::exp(30 * (near - 1)));
            const float disc = near > 0.999 ? 2000.f : 0.f;
            setPixel(image, x, y, disc + glow, disc + 0.8f * glow, 0.9f * disc + glow);
        }
    }
    return image;
}

TEST(MatchedPlaces, ErrorIsSmallerThanAtCentroids) {
    const Image probes[] = {sunProbe(), noise(128, 64, 72)};
    for (const Image& image : probes) {
        for (const LightMethod method : {LightMethod::median, LightMethod::variance}) {
            for (const int count : {16, 64, 256}) {
                const LightSet at = lightsOfProbe(image, method, count, LightPlacement::centroid);
                const LightSet set = lightsOfProbe(image, method, count, LightPlacement::matched);
                EXPECT_LT(set.irradiance_error, 0.9 * at.irradiance_error) << count;
                EXPECT_LT((totalIrradiance(set.lights) - totalIrradiance(at.lights)).length(),
                          1e-12 * totalIrradiance(at.lights).length());
            }
        }
    }
}

TEST(MatchedPlaces, TheSunStaysWhereItIs) {
    const Image image = sunProbe();
    const LightSet at = lightsOfProbe(image, LightMethod::variance, 64, LightPlacement::centroid);
    const LightSet set = lightsOfProbe(image, LightMethod::variance, 64, LightPlacement::matched);
    EXPECT_EQ(set.lights[0].irradiance, at.lights[0].irradiance);
    EXPECT_LT((set.lights[0].direction - at.lights[0].direction).length(), 0.2 * kPi / 180);
}

TEST(MatchedPlaces, SameForAnyThreadCountAndSteadyFromFrameToFrame) {
    const Image image = noise(64, 32, 73);
    LightRequest request;
    request.count = 1500;
    request.placement = LightPlacement::matched;
    const LightSet one = cutLights(image, request, 1), five = cutLights(image, request, 5);
    for (std::size_t i = 0; i < one.lights.size(); ++i)
        EXPECT_EQ(one.lights[i].direction, five.lights[i].direction);
    request.count = 64;
    const LightSet first = cutLights(image, request, 1);
    request.previous = &first;
    Image later = image;
    for (float& value : later.pixels)
        value *= 1.01f;
    EXPECT_LT(cutLights(later, request, 1).change->movement, 1e-6);
    for (std::size_t i = 0; i < later.pixels.size(); i += 2)
        later.pixels[i] *= 0.99f;
    const LightSet second = cutLights(later, request, 1);
    EXPECT_TRUE(second.change->same_regions);
    EXPECT_LT(second.change->movement, 1e-3);
}

} // namespace
} // namespace ibl
