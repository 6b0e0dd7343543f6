// Shadows against rays traced in double on the CPU.
#include "lights_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace ibl {
namespace {

// The unit sphere as a mesh.
Mesh ballMesh(int rings) {
    Mesh mesh;
    const int spokes = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        for (int k = 0; k <= spokes; ++k) {
            const double t = kPi * i / rings, p = 2 * kPi * k / spokes;
            const V3d n(std::sin(t) * std::sin(p), std::cos(t), std::sin(t) * std::cos(p));
            mesh.positions.emplace_back(n);
            mesh.normals.emplace_back(n);
        }
    }
    const auto corner = [&](int i, int k) {
        return static_cast<std::uint32_t>(i * (spokes + 1) + k);
    };
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < spokes; ++k) {
            mesh.indices.insert(mesh.indices.end(),
                                {corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k),
                                 corner(i + 1, k + 1), corner(i, k + 1)});
        }
    }
    return mesh;
}

struct Hit {
    double way;
    V3d normal;
};

// The nearest hit with a mesh from `from` on; normals interpolated (Moeller and Trumbore 1997).
std::optional<Hit> trace(const Mesh& mesh, const V3d& from, const V3d& ray) {
    std::optional<Hit> nearest;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return V3d(mesh.positions[mesh.indices[i + k]]); };
        const auto normal = [&](std::size_t k) { return V3d(mesh.normals[mesh.indices[i + k]]); };
        const V3d a = at(0), e1 = at(1) - a, e2 = at(2) - a, q = ray.cross(e2);
        const double det = e1.dot(q);
        if (std::abs(det) < 1e-14) continue;
        const V3d s = from - a;
        const double u = s.dot(q) / det, v = ray.dot(s.cross(e1)) / det;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const double way = e2.dot(s.cross(e1)) / det;
        if (way < 1e-4 || (nearest && way >= nearest->way)) continue;
        const V3d n = (normal(0) * (1 - u - v) + normal(1) * u + normal(2) * v).normalized();
        nearest = Hit{way, det > 0 ? n : -n};
    }
    return nearest;
}

// Lit cosine of every pixel's centre; none where the background is seen.
std::vector<std::optional<double>> litCosines(const Mesh& mesh, const Camera& camera, int size,
                                              const V3d& light) {
    const CameraRays rays = cameraRays(camera, size, size);
    std::vector<std::optional<double>> cosines;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const V3d ray = rays.direction(x + 0.5, y + 0.5).normalized();
            const auto hit = trace(mesh, rays.eye, ray);
            if (!hit) {
                cosines.emplace_back();
                continue;
            }
            const V3d p = rays.eye + ray * hit->way;
            const double cosine = std::max(hit->normal.dot(light), 0.0);
            const bool free = cosine > 0 && !trace(mesh, p + hit->normal * 1e-4, light);
            cosines.emplace_back(free ? cosine : 0);
        }
    }
    return cosines;
}

// A pixel whose neighbours are, by ray tracing, lit or shadowed within `tolerance` of it must come
// out so: no acne on what is lit, and no light in what is shadowed.
int expectShadowsAsTraced(const Mesh& mesh, const V3d& towards, double tolerance,
                          const std::string& name) {
    const int size = 56;
    const V3d light = towards.normalized();
    const Camera camera = orbitCamera(35, 28, 3.2, V3d(0), 40);
    const auto expected = litCosines(mesh, camera, size, light);
    const Scene scene = litScene({sunlight(light, V3d(kPi))}, mesh);
    const Image frame = draw(scene, camera, size, 1, 512);
    int compared = 0, shadowed = 0;
    for (int y = 1; y + 1 < size; ++y) {
        for (int x = 1; x + 1 < size; ++x) {
            const auto& here = expected[static_cast<std::size_t>(y * size + x)];
            bool plain = here.has_value();
            for (int k = 0; k < 9 && plain; ++k) {
                const auto& near =
                    expected[static_cast<std::size_t>((y + k / 3 - 1) * size + x + k % 3 - 1)];
                plain = near && (*near > 0) == (*here > 0);
            }
            if (!plain) continue;
            ++compared;
            shadowed += *here == 0;
            EXPECT_NEAR(pixel(frame, x, y).x, *here, tolerance)
                << name << " at " << x << "," << y << " light " << light;
        }
    }
    EXPECT_GT(compared, 300) << name;
    return shadowed;
}

TEST(Shadows, OnTheObjectItselfAreAsTraced) {
    int ball = 0, cube = 0, torus = 0;
    for (const V3d& light :
         {V3d(1, 1, 0.3), V3d(-0.6, 0.2, 0.7), V3d(0.2, 2, -0.5), V3d(-1, 0.3, -0.4)}) {
        // What a facet's plane and its interpolated normals differ by at the terminator.
        ball += expectShadowsAsTraced(ballMesh(32), light, 0.05, "ball");
        cube += expectShadowsAsTraced(*builtinObject("cube")->mesh, light, 2e-3, "cube");
        torus += expectShadowsAsTraced(*builtinObject("torus")->mesh, light, 0.06, "torus");
    }
    EXPECT_GT(std::min({ball, cube, torus}), 100);
}

// Light that the ground keeps in each pixel, given a function of its points.
double groundError(const Image& frame, const Camera& camera, double height, double behind,
                   const std::function<std::optional<double>(const V3d&)>& lost,
                   const std::function<bool(const V3d&, const V3d&)>& covered) {
    const CameraRays rays = cameraRays(camera, frame.width, frame.height);
    double worst = 0;
    int shadowed = 0, compared = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const V3d ray = rays.direction(x + 0.5, y + 0.5);
            if (ray.y >= 0 || covered(rays.eye, ray)) continue;
            const auto expected = lost(rays.eye + ray * ((height - rays.eye.y) / ray.y));
            if (!expected) continue;
            worst = std::max(worst, std::abs(pixel(frame, x, y).x - (behind - *expected)));
            shadowed += *expected > 0;
            ++compared;
        }
    }
    EXPECT_GT(shadowed, 50);
    EXPECT_GT(compared, shadowed + 50);
    return worst;
}

bool sphereCovers(const V3d& eye, const V3d& ray) {
    return eye.cross(ray.normalized()).length() < 1.02;
}

// The outline of a sphere's shadow: an ellipse, |p x l| = 1. Pixels whose centre lies nearer to it
// than `blur` may be either.
TEST(Shadows, OfASphereIsItsEllipse) {
    const Camera camera = orbitCamera(-25, 40, 9, V3d(0, -0.5, 0), 45);
    const V3d light = V3d(0.7, 0.9, 0.4).normalized();
    const double albedo = 0.6, irradiance = 2, lost = albedo / kPi * irradiance * light.y;
    for (const bool exact : {true, false}) {
        Scene scene = litScene({sunlight(light, V3d(irradiance))});
        if (!exact) scene.object.mesh = ballMesh(64);
        scene.background = ColorBackground(1, 1, 1);
        scene.ground = Ground{-1.5, V3d(albedo)};
        const double blur = exact ? 1e-4 : 0.01; // texels of 1/256
        const Image frame = draw(scene, camera, 128, 1, 512);
        EXPECT_LT(groundError(
                      frame, camera, -1.5, 1,
                      [&](const V3d& p) -> std::optional<double> {
                          const double passing = p.cross(light).length();
                          if (std::abs(passing - 1) < blur) return std::nullopt;
                          return passing < 1 ? lost : 0;
                      },
                      sphereCovers),
                  1e-5)
            << exact;
    }
}

// What is behind is darker than the ground of the albedo would be: it keeps its share of the light,
// as where no albedo is known, and is not black; where it is brighter, the albedo decides.
TEST(Shadows, OfAGroundDarkerThanItsAlbedoLeaveTheirShareOfIt) {
    const Camera camera = orbitCamera(-25, 40, 9, V3d(0, -0.5, 0), 45);
    const V3d light = V3d(0.7, 0.9, 0.4).normalized();
    const double sun = 2 * light.y, sky = 0.5, albedo = 0.6;
    Scene scene = litScene({sunlight(light, V3d(2)), sunlight({0, 1, 0}, V3d(sky))});
    scene.background = ColorBackground(1, 0.02f, 0.3f);
    scene.ground = Ground{-1.5, V3d(albedo)};
    const Image frame = draw(scene, camera, 128, 1);
    const CameraRays rays = cameraRays(camera, 128, 128);
    int compared = 0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            const V3d ray = rays.direction(x + 0.5, y + 0.5);
            if (ray.y >= 0 || sphereCovers(rays.eye, ray)) continue;
            const V3d p = rays.eye + ray * ((-1.5 - rays.eye.y) / ray.y);
            const bool in_sun = p.cross(light).length() > 1, in_sky = std::hypot(p.x, p.z) > 1;
            if (in_sun && in_sky) continue;
            ++compared;
            const double kept = (in_sun ? 0 : sun) + (in_sky ? 0 : sky);
            const V3d behind(1, 0.02, 0.3);
            for (int c = 0; c < 3; ++c) {
                const double without = std::min(behind[c], albedo / kPi * (sun + sky));
                ASSERT_NEAR(pixel(frame, x, y)[c], behind[c] - without * kept / (sun + sky), 1e-5);
            }
        }
    }
    EXPECT_GT(compared, 500);
}

TEST(Shadows, OfPointAndSpotLights) {
    const Camera camera = orbitCamera(-25, 50, 12, V3d(0, -0.5, 0), 45);
    const double albedo = 0.5, height = -1.5;
    const V3d q(0.8, 3, -0.4);
    SceneLight spot{LightType::spot, V3d(-0.2, -1, 0.1).normalized(), V3d(9), q, 0.2, 0.6};
    for (const bool exact : {true, false}) {
        for (const SceneLight& light : {lamp(q, V3d(9)), spot}) {
            Scene scene = litScene({light});
            if (!exact) scene.object.mesh = ballMesh(64);
            scene.background = ColorBackground(1, 1, 1);
            scene.ground = Ground{height, V3d(albedo)};
            const double blur = exact ? 1e-3 : 0.02;
            EXPECT_LT(groundError(
                          draw(scene, camera, 96, 1, 512), camera, height, 1,
                          [&](const V3d& p) -> std::optional<double> {
                              const V3d way = q - p, l = way.normalized();
                              const double passing = p.cross(l).length();
                              if (std::abs(passing - 1) < blur) return std::nullopt;
                              if (passing > 1 || p.dot(l) > 0) return 0;
                              double t = 1;
                              if (light.type == LightType::spot) {
                                  t = (-l.dot(light.direction) - std::cos(0.6)) /
                                      (std::cos(0.2) - std::cos(0.6));
                                  t = std::clamp(t, 0.0, 1.0);
                              }
                              return albedo / kPi * 9 * l.y / way.length2() * t * t;
                          },
                          sphereCovers),
                      2e-5)
                << exact;
        }
    }
}

// A roof over everything keeps all light of the lights above it: the sum of their irradiances.
TEST(Shadows, ARoofKeepsAllLightFromTheGround) {
    Mesh roof;
    for (const V3f& p :
         {V3f(-1e3, 1, -1e3), V3f(-1e3, 1, 1e3), V3f(1e3, 1, 1e3), V3f(1e3, 1, -1e3)}) {
        roof.positions.push_back(p);
        roof.normals.emplace_back(0, 1, 0);
    }
    roof.indices = {0, 1, 2, 0, 2, 3};
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    std::vector<SceneLight> lights;
    double sum = 0;
    for (int i = 0; i < 600; ++i) { // three batches
        const V3d d = V3d(normal(random), normal(random), normal(random)).normalized();
        if (std::abs(d.y) < 0.02) continue; // its map would reach beyond the roof
        lights.push_back(sunlight(d, V3d(0.01)));
        sum += 0.01 * std::max(d.y, 0.0);
    }
    Scene scene = litScene(lights, roof);
    scene.background = ColorBackground(2, 2, 2);
    scene.ground = Ground{0, V3d(0.5)};
    const Camera camera{{0, 0.5, 0}, {0, 0, 0.6}, {0, 1, 0}, 30};
    Renderer renderer(softwareContext(), scene, {8, 8, 3, {}, 64});
    const Image dark = renderer.render(camera);
    for (const float v : dark.pixels)
        ASSERT_NEAR(v, 2 - 0.5 / kPi * sum, 1e-5);
    EXPECT_EQ(renderer.lightCounts().given, static_cast<int>(lights.size()));
    scene.background = ColorBackground(0.01f, 0.01f, 0.01f); // less than the albedo would reflect
    for (const float v : draw(scene, camera, 4, 1).pixels)
        ASSERT_NEAR(v, 0, 1e-7);
    scene.background = ColorBackground(2, 2, 2);
    scene.ground->albedo.reset(); // it looks as bright as what is behind
    for (const float v : draw(scene, camera, 4, 1).pixels)
        ASSERT_NEAR(v, 0, 2e-5);
    scene.background = NoBackground{};
    const Image alpha = draw(scene, camera, 4, 1);
    EXPECT_NEAR(alpha.at(1, 1)[3], 1, 1e-5);
    EXPECT_EQ(alpha.at(1, 1)[0], 0);
}

// A light inside a closed object, whose shadow takes maps on six sides.
TEST(Shadows, OfALightInsideTheObjectAreEverywhere) {
    Scene scene =
        litScene({lamp(V3d(0.1, 0.05, -0.1), V3d(4))}, *builtinObject("dodecahedron")->mesh);
    scene.background = ColorBackground(1, 1, 1);
    scene.ground = Ground{-1.2, std::nullopt};
    const Camera camera = orbitCamera(20, 35, 8, V3d(0), 60);
    const Image frame = draw(scene, camera, 64, 1);
    const CameraRays rays = cameraRays(camera, 64, 64);
    int ground = 0, wrong = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (rays.direction(x + 0.5, y + 0.5).y > -0.01) continue;
            ++ground; // or the object, which is unlit
            wrong += std::abs(pixel(frame, x, y).x) > 2e-6;
        }
    }
    EXPECT_GT(ground, 1000);
    EXPECT_LE(wrong, 8); // where two maps meet
}

// Over nothing the shadow is alpha: composited over a colour it is the picture before that colour.
TEST(Shadows, AlphaCompositesToThePictureBeforeAColour) {
    Scene scene = litScene({sunlight({1, 1, 0}, V3d(1)), sunlight({-1, 2, 1}, V3d(0.5))},
                           *builtinObject("torus")->mesh);
    scene.material[Parameter::ambient] = V3d(0.25);
    scene.ground = Ground{-1.1, std::nullopt};
    const Camera camera = orbitCamera(10, 35, 6, V3d(0), 40);
    scene.background = NoBackground{};
    const Image cut = draw(scene, camera, 48, 4);
    scene.background = ColorBackground(0.5, 2, 0.25);
    const Image whole = draw(scene, camera, 48, 4);
    int partial = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const double alpha = cut.at(x, y)[3];
            partial += alpha > 0.01 && alpha < 0.99;
            const V3d over = pixel(cut, x, y) + V3d(0.5, 2, 0.25) * (1 - alpha);
            ASSERT_LT((over - pixel(whole, x, y)).length(), 1e-5);
        }
    }
    EXPECT_GT(partial, 100);
}

// Object, ground and camera brought elsewhere, and the lights turned with the probe as the object
// is turned, make the same picture.
TEST(Shadows, GoWithTheObject) {
    for (const char* name : {"sphere", "torus"}) {
        Scene scene = litScene({sunlight({1, 1.2, 0.2}, V3d(1)), sunlight({-1, 2, 1}, V3d(0.5))},
                               builtinObject(name)->mesh);
        scene.material = Material(Shader::ward);
        scene.background = ColorBackground(1, 1, 1);
        scene.ground = Ground{-1.1, std::nullopt};
        Camera camera = orbitCamera(10, 35, 6, V3d(0), 40);
        const Image here = draw(scene, camera, 40, 4);
        const V3d shift(3, 0.5, -2);
        scene.placement.translate = shift;
        scene.placement.scale = 2;
        scene.placement.turn.yaw = scene.turn.yaw = 90;
        scene.ground->height = -2.2 + shift.y;
        camera = orbitCamera(100, 35, 12, shift, 40);
        const Image there = draw(scene, camera, 40, 4);
        double error = 0;
        for (std::size_t i = 0; i < here.pixels.size(); ++i)
            error += std::pow(here.pixels[i] - there.pixels[i], 2);
        EXPECT_LT(std::sqrt(error / static_cast<double>(here.pixels.size())), 0.01) << name;
    }
}

} // namespace
} // namespace ibl
