#include "render/camera.h"

#include "core/error.h"
#include "render/sample_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace ibl {
namespace {

constexpr double kDegree = M_PI / 180;

void expectNear(const V3d& a, const V3d& b, double tolerance = 1e-12) {
    EXPECT_LT((a - b).length(), tolerance) << a << " is not " << b;
}

TEST(Camera, OrbitIsTheFormulaOfTheConventions) {
    const V3d target(1, -2, 3);
    for (const double azimuth : {-170.0, 0.0, 30.0, 90.0}) {
        for (const double elevation : {-80.0, 0.0, 25.0}) {
            const Camera camera = orbitCamera(azimuth, elevation, 5, target, 50);
            const double az = azimuth * kDegree, el = elevation * kDegree;
            expectNear(camera.eye, target + 5.0 * V3d(std::cos(el) * std::sin(az), std::sin(el),
                                                      std::cos(el) * std::cos(az)));
            // The same picture as with +Y up.
            const CameraRays orbit = cameraRays(camera, 8, 6);
            const CameraRays plain = cameraRays({camera.eye, target, {0, 1, 0}, 50}, 8, 6);
            expectNear(orbit.step_x, plain.step_x);
            expectNear(orbit.step_y, plain.step_y);
        }
    }
}

TEST(Camera, OrbitGoesOverThePolesWithoutAStep) {
    const CameraRays before = cameraRays(orbitCamera(40, 89.999, 4, V3d(0), 40), 10, 10);
    const CameraRays at = cameraRays(orbitCamera(40, 90, 4, V3d(0), 40), 10, 10);
    expectNear(at.step_x, before.step_x, 1e-4);
    expectNear(at.step_y, before.step_y, 1e-4);
}

TEST(Camera, RaysMeetTheFramesEdgesAtTheFieldOfView) {
    const CameraRays rays = cameraRays({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 60}, 40, 20);
    const double half = std::tan(30 * kDegree);
    // From +Z looking along -Z, +X is on the right and +Y above.
    expectNear(rays.direction(20, 0), V3d(0, half, -1));
    expectNear(rays.direction(20, 20), V3d(0, -half, -1));
    expectNear(rays.direction(40, 10), V3d(2 * half, 0, -1));
    expectNear(rays.direction(0, 10), V3d(-2 * half, 0, -1));
}

TEST(Camera, DegenerateCamerasAreRefused) {
    const auto refused = [](const Camera& camera) {
        try {
            cameraRays(camera, 4, 4);
        } catch (const Error& error) {
            return error.code() == ExitCode::usage;
        }
        return false;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(refused({}));
    EXPECT_TRUE(refused({{1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 40}));
    EXPECT_TRUE(refused({{0, 4, 0}, {0, 0, 0}, {0, 1, 0}, 40}));
    EXPECT_TRUE(refused({{0, 0, 4}, {0, 0, 0}, {0, 0, 0}, 40}));
    EXPECT_TRUE(refused({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0}));
    EXPECT_TRUE(refused({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 180}));
    EXPECT_TRUE(refused({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, nan}));
    EXPECT_TRUE(refused({{0, nan, 4}, {0, 0, 0}, {0, 1, 0}, 40}));
    EXPECT_TRUE(refused(orbitCamera(0, 0, 0, V3d(0), 40)));
}

bool meetsUnitSphere(const CameraRays& rays, double x, double y) {
    const V3d d = rays.direction(x, y).normalized();
    return rays.eye.cross(d).length() < 1 && rays.eye.dot(d) < 0;
}

TEST(Camera, SphereRectangleHoldsTheSphereAndLittleElse) {
    for (const Camera& camera : {Camera{}, Camera{{3, 2, 1}, {0.5, 0.2, 0}, {0, 1, 0}, 30},
                                 Camera{{0, 0, 1.5}, {1, 0, 0}, {0, 1, 0}, 100},
                                 Camera{{0, 9, 9}, {1, 0, 2}, {1, 0, 0}, 20}}) {
        const int width = 97, height = 60;
        const CameraRays rays = cameraRays(camera, width, height);
        const PixelRect rect = unitSphereRect(rays, width, height);
        PixelRect seen{{width, height}, {0, 0}};
        for (int y = 0; y < 4 * height; ++y) {
            for (int x = 0; x < 4 * width; ++x) {
                if (!meetsUnitSphere(rays, (x + 0.5) / 4, (y + 0.5) / 4)) continue;
                seen.min = {std::min(seen.min.x, x / 4), std::min(seen.min.y, y / 4)};
                seen.max = {std::max(seen.max.x, x / 4 + 1), std::max(seen.max.y, y / 4 + 1)};
            }
        }
        for (int axis = 0; axis < 2; ++axis) {
            EXPECT_LE(rect.min[axis], seen.min[axis]);
            EXPECT_GE(rect.max[axis], seen.max[axis]);
            EXPECT_GE(rect.min[axis] + 3, seen.min[axis]);
            EXPECT_LE(rect.max[axis] - 3, seen.max[axis]);
        }
    }
    const PixelRect behind =
        unitSphereRect(cameraRays({{0, 0, 4}, {0, 0, 8}, {0, 1, 0}, 40}, 8, 8), 8, 8);
    EXPECT_LE(behind.max.x, behind.min.x);
}

TEST(SamplePattern, IsALatinSquareAboutTheCentre) {
    for (const int count : {1, 2, 3, 16, 37, 256}) {
        std::set<int> columns, rows;
        V2d sum(0);
        for (const V2d& p : samplePattern(count)) {
            columns.insert(static_cast<int>(p.x * count));
            rows.insert(static_cast<int>(p.y * count));
            sum += p;
        }
        EXPECT_EQ(columns.size(), static_cast<std::size_t>(count));
        EXPECT_EQ(rows.size(), static_cast<std::size_t>(count));
        EXPECT_LT((sum / count - V2d(0.5)).length(), 1e-12);
    }
}

} // namespace
} // namespace ibl
