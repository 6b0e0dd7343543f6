// Pictures against the same pictures worked out in double on the CPU.
#include "scene_support.h"

#include "panorama/builtin.h"
#include "render/sample_pattern.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace ibl {
namespace {

const std::vector<Camera> kCameras{
    orbitCamera(0.3, 0.2, 4, V3d(0), 40),           // no ray on a face's diagonal
    orbitCamera(130, 25, 3, V3d(0), 50),            //
    {{-2, -3, 1}, {0.4, 0.1, -0.3}, {0, 0, 1}, 35}, // off centre, rolled
    {{0, 0, -1.2}, {0.3, 0, 0}, {0, 1, 0}, 120},    // close and wide
    orbitCamera(-60, 88, 400, V3d(0), 0.35),        // far and narrow
};

// The mean over a frame's samples of what `seen` gives for (eye, unit ray), against the frame.
// Relative RMSE; pixels with a sample that grazes the sphere are left out when `skip_outline`.
double frameError(const Image& frame, const Camera& camera, int samples, bool skip_outline,
                  const std::function<V3d(const V3d&, const V3d&)>& seen) {
    const CameraRays rays = cameraRays(camera, frame.width, frame.height);
    const auto points = samplePattern(samples);
    double error = 0, reference = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            V3d expected(0);
            bool outline = false;
            for (const V2d& p : points) {
                const V3d d = rays.direction(x + p.x, y + p.y).normalized();
                const double passing = rays.eye.cross(d).length();
                outline = outline || std::abs(passing - 1) < 0.02;
                expected += seen(rays.eye, d) / samples;
            }
            if (skip_outline && outline) continue;
            error += (pixel(frame, x, y) - expected).length2();
            reference += expected.length2();
        }
    }
    EXPECT_GT(reference, 0);
    return std::sqrt(error / reference);
}

Image drawSphere(const Scene& scene, const Camera& camera, int width, int height, int samples) {
    return Renderer(softwareContext(), scene, {width, height, samples, {}}).render(camera);
}

V3d mirrorScene(const Panorama& probe, const V3d& eye, const V3d& ray) {
    const auto hit = meetSphere(eye, ray);
    return radianceAt(probe, hit ? reflected(ray, *hit) : ray);
}

TEST(Shading, MirrorSphereAndBackgroundAreTheProbeLookedUp) {
    const std::vector<Panorama> probes{
        noiseProbe(Layout::latlong, 64, 32),    noiseProbe(Layout::latlong, 37, 11),
        noiseProbe(Layout::latlong, 1, 1),      noiseProbe(Layout::latlong, 2, 1),
        noiseProbe(Layout::exrLatlong, 40, 21), noiseProbe(Layout::faces, 12, 72),
        noiseProbe(Layout::faces, 1, 6),        noiseProbe(Layout::vcross, 15, 20),
        noiseProbe(Layout::hcross, 16, 12),     noiseProbe(Layout::strip, 24, 4),
        noiseProbe(Layout::exrCube, 9, 54)};
    for (const Panorama& probe : probes) {
        Scene scene;
        scene.probe = &probe;
        Renderer renderer(softwareContext(), scene, {64, 48, 1, {}});
        for (const Camera& camera : kCameras) {
            const double error =
                frameError(renderer.render(camera), camera, 1, true,
                           [&](const V3d& e, const V3d& d) { return mirrorScene(probe, e, d); });
            EXPECT_LT(error, 1e-4)
                << layoutName(probe.layout) << " " << probe.image.width << " from " << camera.eye;
        }
    }
}

TEST(Shading, SamplesAreAveragedOutlineIncluded) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    Scene scene;
    scene.probe = &probe;
    for (const int samples : {2, 9, 16}) {
        const Image frame = drawSphere(scene, kCameras[1], 40, 30, samples);
        EXPECT_LT(frameError(frame, kCameras[1], samples, false,
                             [&](const V3d& e, const V3d& d) { return mirrorScene(probe, e, d); }),
                  2e-3); // a sample that only just misses the sphere may hit it in floats
    }
}

TEST(Shading, SunsKeepTheirPlaceAndStrength) {
    Panorama probe{Layout::latlong, Image(64, 32)};
    for (float& v : probe.image.pixels)
        v = 1e-3f;
    for (int c = 0; c < 3; ++c)
        probe.image.at(20, 9)[c] = 1e9f;
    Scene scene;
    scene.probe = &probe;
    const Image frame = drawSphere(scene, {}, 64, 64, 1);
    EXPECT_LT(frameError(frame, {}, 1, true,
                         [&](const V3d& e, const V3d& d) { return mirrorScene(probe, e, d); }),
              1e-4);
}

TEST(Shading, DiffuseSphereIsTheOraclesIrradiance) {
    const Panorama probe = noiseProbe(Layout::latlong, 16, 8);
    const int edge = 16;
    std::vector<oracle::Direction> directions;
    for (int face = 0; face < 6; ++face) {
        for (int k = 0; k < edge * edge; ++k) {
            const V3d d = cubeTexelDirection(face, k % edge, k / edge, edge).normalized();
            directions.push_back({d.x, d.y, d.z});
        }
    }
    const auto irradiance = oracle::convolve(probe.image, oracle::lambert(), directions, 1e-4);
    Panorama diffuse{Layout::faces, Image(edge, 6 * edge)};
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            diffuse.image.pixels[3 * i + c] = static_cast<float>(irradiance[i][c]);
        }
    }
    Scene scene;
    scene.diffuse = &diffuse;
    scene.material.shader = Shader::diffuse;
    scene.material[Parameter::baseColor] = {0.5, 1, 0.25};
    scene.background = ColorBackground(1, 2, 3);
    const Camera camera = kCameras[2];
    const Image frame = drawSphere(scene, camera, 24, 16, 1);

    // Each pixel's own oracle, not the map's.
    const CameraRays rays = cameraRays(camera, frame.width, frame.height);
    std::vector<oracle::Direction> normals;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const V3d n = meetSphere(rays.eye, rays.direction(x + 0.5, y + 0.5)).value_or(V3d(0));
            if (n.length() > 0) normals.push_back({n.x, n.y, n.z});
        }
    }
    ASSERT_GT(normals.size(), 60u);
    const auto expected = oracle::convolve(probe.image, oracle::lambert(), normals, 1e-4);
    std::size_t next = 0;
    const double error = frameError(frame, camera, 1, true, [&](const V3d& eye, const V3d& ray) {
        if (!meetSphere(eye, ray)) return V3d(1, 2, 3);
        const auto& e = expected[next++];
        return V3d(0.5 * e[0], e[1], 0.25 * e[2]);
    });
    EXPECT_LT(error, 1e-3); // of which the map's interpolation at 16 texels a face is nearly all
}

TEST(Shading, MirrorDiffuseIsTheirMixture) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    const Panorama diffuse = noiseProbe(Layout::faces, 4, 24);
    Scene scene;
    scene.probe = &probe;
    scene.diffuse = &diffuse;
    scene.material = Material(Shader::mirrorDiffuse);
    scene.material[Parameter::baseColor] = {0.5, 0.25, 1};
    scene.material[Parameter::reflectivity] = V3d(0.3);
    const Image frame = drawSphere(scene, kCameras[1], 40, 30, 1);
    EXPECT_LT(frameError(frame, kCameras[1], 1, true,
                         [&](const V3d& eye, const V3d& d) {
                             const auto n = meetSphere(eye, d);
                             if (!n) return radianceAt(probe, d);
                             return V3d(0.5, 0.25, 1) * radianceAt(diffuse, *n) * 0.7 +
                                    radianceAt(probe, reflected(d, *n)) * 0.3;
                         }),
              1e-4);
}

TEST(Shading, FurnaceIsConstantForEveryObjectAndShader) {
    const Panorama furnace = constantProbe(0.7f);
    SpecularMaps lobe;
    lobe.levels.push_back({Layout::faces, Image(2, 12)});
    std::ranges::fill(lobe.levels[0].image.pixels, 0.7f);
    const Image table = splitSumTable({32, true, false, 1}).image;
    for (const std::string_view name : builtinObjectNames()) {
        for (const ShaderInfo& info : shaderTable()) {
            if (info.lit) continue; // lights_test.cpp
            Scene scene;
            scene.probe = &furnace;
            scene.diffuse = &furnace;
            scene.specular = &lobe;
            scene.split_sum = &table;
            scene.object = *builtinObject(name);
            scene.material.shader = info.shader;
            for (const int samples : {1, 5}) {
                const Image frame = drawSphere(scene, kCameras[1], 33, 21, samples);
                for (const float v : frame.pixels) {
                    ASSERT_NEAR(v, 0.7f, 4e-7f) << name << " " << info.name;
                }
            }
        }
    }
}

// A flat face, where the reflected ray is known: the cube's front at z = 1/sqrt(3).
TEST(Shading, CubesFrontMirrorsAsAPlane) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    Scene scene;
    scene.probe = &probe;
    scene.object = *builtinObject("cube");
    const Camera camera{{0.3, 0.2, 3}, {0, 0, 0}, {0, 1, 0}, 20};
    const CameraRays rays = cameraRays(camera, 48, 48);
    const Image frame = drawSphere(scene, camera, 48, 48, 1);
    const double half = 1 / std::sqrt(3.0);
    int compared = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const V3d d = rays.direction(x + 0.5, y + 0.5);
            const V3d hit = rays.eye + d * ((half - rays.eye.z) / d.z);
            if (std::max(std::abs(hit.x), std::abs(hit.y)) > half * 0.98) continue;
            const V3d expected = radianceAt(probe, {d.x, d.y, -d.z});
            ASSERT_LT((pixel(frame, x, y) - expected).length(), 1e-3 * expected.length());
            ++compared;
        }
    }
    EXPECT_GT(compared, 500);
}

// Red towards +X, green towards +Y, blue towards +Z, with their complements on the other side.
TEST(Shading, HandednessOfPictureAndReflection) {
    Panorama probe{Layout::faces, Image(1, 6)};
    for (int face = 0; face < 6; ++face) {
        for (int c = 0; c < 3; ++c)
            probe.image.at(0, face)[c] = face / 2 == c && face % 2 == 0;
    }
    Scene scene;
    scene.probe = &probe;
    const Image frame = drawSphere(scene, {{0, 0, -4}, {0, 0, 0}, {0, 1, 0}, 90}, 65, 65, 1);
    // Looking along +Z with +Y up, +X is on the left.
    EXPECT_GT(pixel(frame, 0, 32).x, 0.4);
    EXPECT_LT(pixel(frame, 64, 32).x, 0.01);
    EXPECT_GT(pixel(frame, 32, 0).y, 0.4);
    EXPECT_LT(pixel(frame, 32, 64).y, 0.01);
    // In the ball the sides are where they are in a mirror: what is to the left, on the left.
    const auto mirrored = [&](double nx, double ny) {
        const int x = static_cast<int>(32.5 + 8.1 * nx), y = static_cast<int>(32.5 - 8.1 * ny);
        return pixel(frame, x, y);
    };
    EXPECT_LT(mirrored(0, 0).z, 0.01); // towards the viewer, at -Z
    EXPECT_GT(mirrored(-0.7, 0).x, 0.9);
    EXPECT_LT(mirrored(0.7, 0).x, 0.1);
    EXPECT_GT(mirrored(0, 0.7).y, 0.9);
    EXPECT_LT(mirrored(0, -0.7).y, 0.1);
}

TEST(Shading, SphereIsSeenFromInsideAndNotBehindTheEye) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    Scene scene;
    scene.probe = &probe;
    const Camera away{{0, 0, 4}, {0, 0, 8}, {0, 1, 0}, 60};
    EXPECT_LT(frameError(drawSphere(scene, away, 32, 32, 1), away, 1, false,
                         [&](const V3d&, const V3d& d) { return radianceAt(probe, d); }),
              1e-4);
    const Camera inside{{0.2, 0.1, 0.3}, {0, 0, 8}, {0, 1, 0}, 100};
    EXPECT_LT(frameError(drawSphere(scene, inside, 32, 32, 1), inside, 1, false,
                         [&](const V3d& eye, const V3d& d) {
                             const double b = eye.dot(d);
                             const V3d hit =
                                 eye + d * (-b + std::sqrt(b * b - (eye.length2() - 1)));
                             return radianceAt(probe, reflected(d, hit));
                         }),
              1e-4);
}

TEST(Shading, TilesMeet) {
    const Panorama probe = noiseProbe(Layout::latlong, 32, 16);
    Scene scene;
    scene.probe = &probe;
    scene.background = ProbeBackground{};
    for (const auto& [width, height] : {std::pair(2100, 3), std::pair(3, 2100)}) {
        const Camera camera{{0, 0, 2}, {0, 0, 0}, {0, 1, 0}, height == 3 ? 0.2 : 90.0};
        const Image frame = drawSphere(scene, camera, width, height, 1);
        EXPECT_LT(frameError(frame, camera, 1, true,
                             [&](const V3d& e, const V3d& d) { return mirrorScene(probe, e, d); }),
                  1e-4);
    }
}

} // namespace
} // namespace ibl
