// Materials against their formulas in double on the CPU.
#include "scene_support.h"

#include "core/error.h"
#include "render/probe_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>

namespace ibl {
namespace {

const Camera kCamera = orbitCamera(130, 25, 3, V3d(0), 50);

/// Relative RMSE of a frame of one sample a pixel against `seen(normal, unit ray)`, on the sphere
/// where n.v is above `least`.
double sphereError(const Image& frame, double least,
                   const std::function<V3d(const V3d&, const V3d&)>& seen) {
    const CameraRays rays = cameraRays(kCamera, frame.width, frame.height);
    double error = 0, norm = 0;
    int compared = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const V3d d = rays.direction(x + 0.5, y + 0.5).normalized();
            const auto n = meetSphere(rays.eye, d);
            if (!n || -n->dot(d) < least) continue;
            const V3d expected = seen(*n, d);
            error += (pixel(frame, x, y) - expected).length2();
            norm += expected.length2();
            ++compared;
        }
    }
    EXPECT_GT(compared, 300);
    return std::sqrt(error / norm);
}

Image draw(const Scene& scene, int samples = 1) {
    return Renderer(softwareContext(), scene, {64, 48, samples, {}}).render(kCamera);
}

/// Fresnel's equations by the two polarisations' amplitudes.
double reflectance(double cos_i, double ior) {
    const double sin_t = std::sqrt(1 - cos_i * cos_i) / ior, cos_t = std::sqrt(1 - sin_t * sin_t);
    const double s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t);
    const double p = (ior * cos_i - cos_t) / (ior * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

/// Snell's law; n on the side of the ray.
V3d refracted(const V3d& d, const V3d& n, double ratio) {
    const V3d along = (d - n * d.dot(n)) * ratio;
    return along - n * std::sqrt(1 - along.length2());
}

/// Two refractions of a ray that meets the unit sphere at n.
V3d throughSphere(const V3d& n, const V3d& d, double ior) {
    const V3d t = refracted(d, n, 1 / ior);
    const V3d out = n + t * (-2 * n.dot(t));
    return refracted(t, -out, ior);
}

Panorama smoothProbe() {
    Panorama probe{Layout::latlong, Image(256, 128)};
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            const V3d d = latlongDirection((x + 0.5) / 256, (y + 0.5) / 128);
            for (int c = 0; c < 3; ++c)
                probe.image.at(x, y)[c] = static_cast<float>(1 + 0.8 * std::sin(3 * d[c] + d.y));
        }
    }
    return probe;
}

/// What comes through the unit sphere where f is mirrored each time: the ray is followed inside,
/// and what is left at the last of four exits leaves there.
V3d radianceThrough(const Panorama& probe, const V3d& n, const V3d& d, double ior, double f) {
    V3d t = refracted(d, n, 1 / ior), at = n, sum(0);
    double left = 1;
    for (int exit = 1; exit <= 4; ++exit) {
        at -= t * (2 * at.dot(t));
        const double leaves = exit < 4 ? left * (1 - f) : left;
        sum += radianceAt(probe, refracted(t, -at, ior)) * leaves;
        left *= f;
        t = reflected(t, at);
    }
    return sum;
}

TEST(Materials, GlassSphereMirrorsInside) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    Scene scene;
    scene.probe = &probe;
    scene.material = Material(Shader::glass);
    scene.material[Parameter::baseColor] = {0.5, 1, 0.25};
    const auto error = [&](double ior, const std::function<double(double)>& fresnel) {
        scene.material[Parameter::ior] = V3d(ior);
        return sphereError(draw(scene), 0.05, [&](const V3d& n, const V3d& d) {
            const double f = fresnel(-n.dot(d));
            return radianceAt(probe, reflected(d, n)) * f +
                   V3d(0.5, 1, 0.25) * (1 - f) * radianceThrough(probe, n, d, ior, f);
        });
    };
    for (const double ior : {1.33, 1.5, 2.4})
        EXPECT_LT(error(ior, [&](double c) { return reflectance(c, ior); }), 1e-4) << ior;
    EXPECT_LT(error(1, [](double) { return 0.0; }), 1e-4);
    scene.material[Parameter::fresnel] = {0.2, 0.7, 3}; // both faces have it
    EXPECT_LT(error(1.5, [](double c) { return 0.2 + 0.7 * std::pow(1 - c, 3); }), 1e-4);
}

// Nothing is lost or won inside: 1 - F comes through, however many exits are followed.
TEST(Materials, GlassSphereIsWhiteUnderAUniformProbe) {
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    for (const Shader shader : {Shader::glass, Shader::dispersion}) {
        for (const double bias : {-1.0, 0.0, 0.5, 1.0}) {
            scene.material = Material(shader);
            if (bias >= 0) scene.material[Parameter::fresnel] = {bias, 1, 2};
            for (const float v : draw(scene).pixels)
                ASSERT_NEAR(v, 1, 1e-6) << bias;
        }
    }
}

TEST(Materials, DispersionIsGlassOfEachChannelsIndex) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    const V3d ior(1.3, 1.5, 1.8);
    Scene scene;
    scene.probe = &probe;
    scene.material = Material(Shader::dispersion);
    scene.material[Parameter::iorRgb] = ior;
    EXPECT_LT(sphereError(draw(scene), 0.05,
                          [&](const V3d& n, const V3d& d) {
                              V3d sum;
                              for (int c = 0; c < 3; ++c) {
                                  const double f = reflectance(-n.dot(d), ior[c]);
                                  sum[c] = radianceAt(probe, reflected(d, n))[c] * f +
                                           radianceThrough(probe, n, d, ior[c], f)[c] * (1 - f);
                              }
                              return sum;
                          }),
              1e-4);
}

TEST(Materials, CoatMirrorsByFresnelOrByBiasScaleAndPower) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    const Panorama diffuse = noiseProbe(Layout::faces, 4, 24);
    Scene scene;
    scene.probe = &probe;
    scene.diffuse = &diffuse;
    scene.material = Material(Shader::coat);
    scene.material[Parameter::baseColor] = {0.5, 0.25, 1};
    scene.material[Parameter::ior] = V3d(1.8);
    const auto error = [&](const std::function<double(double)>& fresnel) {
        return sphereError(draw(scene), 0.05, [&](const V3d& n, const V3d& d) {
            const double f = fresnel(-n.dot(d));
            return radianceAt(probe, reflected(d, n)) * f +
                   V3d(0.5, 0.25, 1) * radianceAt(diffuse, n) * (1 - f);
        });
    };
    EXPECT_LT(error([](double c) { return reflectance(c, 1.8); }), 1e-4);
    scene.material[Parameter::fresnel] = {0.1, 0.7, 3};
    EXPECT_LT(error([](double c) { return 0.1 + 0.7 * std::pow(1 - c, 3); }), 1e-4);
    scene.material[Parameter::fresnel] = {0.5, 4, 1}; // beyond 1 is 1
    EXPECT_LT(error([](double c) { return std::min(1.0, 0.5 + 4 * (1 - c)); }), 1e-4);
}

/// Sphere of triangles, for what is approximate on meshes.
Mesh sphereMesh(int columns, int rows) {
    Mesh mesh;
    for (int y = 0; y <= rows; ++y) {
        for (int x = 0; x <= columns; ++x) {
            const double theta = kPi * y / rows, phi = 2 * kPi * x / columns;
            const V3d p(std::sin(theta) * std::sin(phi), std::cos(theta),
                        std::sin(theta) * std::cos(phi));
            mesh.positions.emplace_back(p);
            mesh.normals.emplace_back(p);
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x), b = a + 1,
                       c = a + static_cast<std::uint32_t>(columns) + 1, d = c + 1;
            if (y > 0) mesh.indices.insert(mesh.indices.end(), {a, c, b});
            if (y < rows - 1) mesh.indices.insert(mesh.indices.end(), {b, c, d});
        }
    }
    return mesh;
}

TEST(Materials, GlassMeshIsNearlyTheExactFirstExit) {
    const Panorama probe = smoothProbe();
    Scene scene;
    scene.probe = &probe;
    scene.material = Material(Shader::glass);
    scene.object.mesh = sphereMesh(256, 128);
    const Image frame = Renderer(softwareContext(), scene, {256, 192, 1, {}}).render(kCamera);
    const auto expected = [&](const V3d& n, const V3d& d) {
        const double f = reflectance(-n.dot(d), 1.5);
        return radianceAt(probe, reflected(d, n)) * f +
               radianceAt(probe, throughSphere(n, d, 1.5)) * (1 - f);
    };
    const double inner = sphereError(frame, 0.5, expected);
    const double all = sphereError(frame, 0.1, expected);
    std::printf("glass mesh against exact first exit: %.2e, to the silhouette %.2e\n", inner, all);
    EXPECT_LT(inner, 0.01);
    EXPECT_LT(all, 0.03);
}

/// The directional albedo of GGX without Fresnel, and its part with (1 - v.h)^5: the midpoint rule
/// over directions of light, n.l dl / pi weighted.
V2d bruteAlbedo(double mu, double alpha, Masking masking) {
    const V3d v(std::sqrt(1 - mu * mu), 0, mu);
    const auto lambda = [&](double c) {
        return 0.5 * (std::sqrt(1 + alpha * alpha * (1 / (c * c) - 1)) - 1);
    };
    V2d sum(0, 0);
    const int count = 1000;
    for (int i = 0; i < count; ++i) {
        const double z = (i + 0.5) / count, r = std::sqrt(1 - z * z);
        for (int j = 0; j < count; ++j) {
            const double phi = kPi * (j + 0.5) / count;
            const V3d l(r * std::cos(phi), r * std::sin(phi), z), h = (l + v).normalized();
            const double t = h.z * h.z * (alpha * alpha - 1) + 1;
            const double d = alpha * alpha / (kPi * t * t);
            const double g = masking == Masking::separable
                                 ? 1 / ((1 + lambda(z)) * (1 + lambda(mu)))
                                 : 1 / (1 + lambda(z) + lambda(mu));
            const double f = d * g / (4 * mu) * 2 * kPi / (double(count) * count);
            sum += V2d(std::pow(1 - v.dot(h), 5) * f, f);
        }
    }
    return sum;
}

TEST(Materials, SplitSumOfEitherMaskingIsTheIntegral) {
    for (const Masking masking : {Masking::correlated, Masking::separable}) {
        for (const double roughness : {0.5, 1.0}) {
            for (const double mu : {0.2, 0.8}) {
                const V2d brute = bruteAlbedo(mu, roughness * roughness, masking);
                const SplitSum sum = ggxSplitSum(mu, roughness, 1, masking);
                EXPECT_NEAR(sum.bias, brute.x, 1e-4 * brute.y);
                EXPECT_NEAR(sum.total, brute.y, 1e-4 * brute.y) << roughness << " " << mu;
            }
        }
    }
}

TEST(Materials, SampledLobeReflectsTheIntegralOfAConstantProbe) {
    const std::vector<Panorama> levels = probeLevels(constantProbe(2), 1);
    const Panorama diffuse = constantProbe(3);
    Scene scene;
    scene.diffuse = &diffuse;
    scene.probe_levels = &levels;
    scene.background = NoBackground{};
    scene.material = Material(Shader::ggx);
    scene.material[Parameter::baseColor] = {1, 0.5, 0.1};
    for (const Masking masking : {Masking::correlated, Masking::separable}) {
        for (const double roughness : {0.5, 1.0}) {
            scene.material.specular = {1024, false, masking};
            scene.material[Parameter::roughness] = V3d(roughness);
            // F0 of an index of 2 is 1/9.
            scene.material[Parameter::ior] = V3d(2);
            for (const double metallic : {0.0, 0.4, 1.0}) {
                scene.material[Parameter::metallic] = V3d(metallic);
                const double error = sphereError(draw(scene), 0.2, [&](const V3d& n, const V3d& d) {
                    const SplitSum e = ggxSplitSum(-n.dot(d), roughness, 1, masking);
                    const V3d base(1, 0.5, 0.1), one(e.bias);
                    const double coat = (e.total - e.bias) / 9 + e.bias;
                    return (V3d(2 * coat) + base * (3 * (1 - coat))) * (1 - metallic) +
                           (base * (e.total - e.bias) + one) * (2 * metallic);
                });
                EXPECT_LT(error, 3e-3) << roughness << " " << metallic;
            }
        }
    }
}

// Levels of 1, 2 and 3 stand for roughness 0, 0.5 and 1; a metal of 1 gives all back.
TEST(Materials, SplitSumReadsTheLevelOfItsRoughness) {
    SpecularMaps maps;
    maps.last = 1;
    for (int k = 0; k < 3; ++k) {
        maps.levels.push_back({Layout::faces, Image(4 >> k, 6 * (4 >> k))});
        std::ranges::fill(maps.levels.back().image.pixels, static_cast<float>(k + 1));
    }
    const Image table = splitSumTable({32, true, false, 1}).image;
    Scene scene;
    scene.specular = &maps;
    scene.split_sum = &table;
    scene.background = NoBackground{};
    scene.material = Material(Shader::ggx);
    scene.material[Parameter::metallic] = V3d(1);
    for (const double roughness : {0.0, 0.25, 0.8, 1.0}) {
        scene.material[Parameter::roughness] = V3d(roughness);
        EXPECT_LT(sphereError(draw(scene), 0,
                              [&](const V3d&, const V3d&) { return V3d(1 + 2 * roughness); }),
                  1e-5);
    }
    // Without compensation what single scattering reflects, F0 = base colour.
    scene.material.specular.multiscatter = false;
    scene.material[Parameter::roughness] = V3d(0.5);
    scene.material[Parameter::baseColor] = {1, 0.5, 0};
    EXPECT_LT(sphereError(draw(scene), 0.1,
                          [&](const V3d& n, const V3d& d) {
                              const SplitSum e = ggxSplitSum(-n.dot(d), 0.5);
                              return (V3d(1, 0.5, 0) * (e.total - e.bias) + V3d(e.bias)) * 2.0;
                          }),
              2e-3);
}

TEST(Materials, NothingIsUndefinedAtTheEnds) {
    const Panorama probe = constantProbe(1);
    const std::vector<Panorama> levels = probeLevels(probe, 1);
    const SpecularMaps maps{{levels.back()}, 0, 0};
    const Image table = splitSumTable({16, true, false, 1}).image;
    Scene scene;
    scene.probe = scene.diffuse = &probe;
    scene.probe_levels = &levels;
    scene.specular = &maps;
    scene.split_sum = &table;
    for (const char* object : {"sphere", "torus"}) {
        scene.object = *builtinObject(object);
        for (const ShaderInfo& info : shaderTable()) {
            if (info.lit) continue; // brdf_test.cpp has these
            for (const double end : {0.0, 1.0}) {
                for (const int samples : {0, 1, 16}) {
                    if (samples > 0 && !info.reads_specular) continue;
                    scene.material = Material(info.shader);
                    scene.material[Parameter::roughness] = V3d(end);
                    scene.material[Parameter::metallic] = V3d(end);
                    scene.material[Parameter::reflectivity] = V3d(end);
                    scene.material[Parameter::ior] = V3d(1 + 3 * end);
                    scene.material[Parameter::iorRgb] = {1, 1 + 3 * end, 4};
                    scene.material.specular.samples = samples;
                    const Image frame = draw(scene, 4);
                    // A lobe of one sample may lie below the horizon.
                    const float least = samples == 1 ? -1e-5f : 1 - 1e-3f;
                    for (const float v : frame.pixels) {
                        ASSERT_GE(v, least) << info.name << " " << end << " " << samples;
                        ASSERT_LE(v, 1 + 1e-3f) << info.name << " " << end << " " << samples;
                    }
                }
            }
        }
    }
}

TEST(ProbeLevels, KeepAPointsPlaceAndEnergy) {
    Panorama probe{Layout::faces, Image(64, 6 * 64)};
    std::ranges::fill(probe.image.pixels, 0.f);
    probe.image.at(45, 5 * 64 - 40)[0] = 1000; // in face +Z, off its centre
    const V3d place = cubeTexelDirection(4, 45, 24, 64).normalized();
    const double energy = 1000 * cubeTexelSolidAngle(45, 24, 64);
    for (const Panorama& level : probeLevels(probe, 1)) {
        const int edge = level.image.width;
        V3d centroid(0);
        double sum = 0;
        for (int row = 0; row < 6 * edge; ++row) {
            for (int i = 0; i < edge; ++i) {
                const double w =
                    level.image.at(i, row)[0] * cubeTexelSolidAngle(i, row % edge, edge);
                centroid += cubeTexelDirection(row / edge, i, row % edge, edge).normalized() * w;
                sum += w;
            }
        }
        if (edge < 8) continue;
        EXPECT_NEAR(sum, energy, 0.05 * energy) << edge;
        EXPECT_GT(centroid.normalized().dot(place), std::cos(0.2 / edge)) << edge;
    }
}

} // namespace
} // namespace ibl
