#include "panorama/square_maps.h"

#include "panorama/lookup.h"
#include "panorama/resample.h"
#include "unit/panorama/probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

constexpr std::array<Layout, 3> kSquareMaps{Layout::angular, Layout::mirrorBall,
                                            Layout::octahedral};

void expectAt(Layout layout, double u, double v, const V3d& expected) {
    const auto d = squareMapDirection(layout, u, v);
    ASSERT_TRUE(d) << layoutName(layout) << " " << u << " " << v;
    EXPECT_LT((*d - expected.normalized()).length(), 1e-12)
        << layoutName(layout) << " " << u << " " << v << ": " << d->x << " " << d->y << " " << d->z;
}

// Left of the middle of an angular map, seen from inside, is +X; of the photograph of a ball it is
// -X.
TEST(SquareMaps, MarkedPoints) {
    expectAt(Layout::angular, 0.5, 0.5, {0, 0, 1});
    expectAt(Layout::angular, 0.25, 0.5, {1, 0, 0});
    expectAt(Layout::angular, 0.75, 0.5, {-1, 0, 0});
    expectAt(Layout::angular, 0.5, 0.25, {0, 1, 0});
    expectAt(Layout::angular, 0.5, 0.75, {0, -1, 0});
    expectAt(Layout::angular, 0.625, 0.5, {-1, 0, 1});
    const double r = std::sqrt(0.125); // rho = sqrt(1/2)
    expectAt(Layout::mirrorBall, 0.5, 0.5, {0, 0, 1});
    expectAt(Layout::mirrorBall, 0.5 + r, 0.5, {1, 0, 0});
    expectAt(Layout::mirrorBall, 0.5 - r, 0.5, {-1, 0, 0});
    expectAt(Layout::mirrorBall, 0.5, 0.5 - r, {0, 1, 0});
    expectAt(Layout::mirrorBall, 0.5, 0.5 + r, {0, -1, 0});
    expectAt(Layout::mirrorBall, 1, 0.5, {0, 0, -1});
    expectAt(Layout::octahedral, 0.5, 0.5, {0, 1, 0});
    expectAt(Layout::octahedral, 1, 0.5, {1, 0, 0});
    expectAt(Layout::octahedral, 0, 0.5, {-1, 0, 0});
    expectAt(Layout::octahedral, 0.5, 1, {0, 0, 1});
    expectAt(Layout::octahedral, 0.5, 0, {0, 0, -1});
    for (double u : {0.0, 1.0})
        for (double v : {0.0, 1.0})
            expectAt(Layout::octahedral, u, v, {0, -1, 0});
    expectAt(Layout::octahedral, 0.75, 0.875, {1, -1, 2}); // p = (0.5, 0.75) is folded to (.25, .5)
    EXPECT_FALSE(squareMapDirection(Layout::angular, 0.01, 0.01));
    EXPECT_FALSE(squareMapDirection(Layout::mirrorBall, 0.99, 0.2));
}

// Against the midpoint rule on the definition: what a texel owns, a point each.
TEST(SquareMaps, SolidAnglesAreWhatTheDensityIntegratesTo) {
    for (Layout layout : kSquareMaps) {
        for (int n : {1, 2, 3, 6, 9, 16}) {
            const int points = 400;
            std::vector<double> expected(static_cast<std::size_t>(n) * n, 0.0);
            double density_sum = 0;
            for (int k = 0; k < n * n * points; ++k) {
                // A rank-one lattice over the square.
                const double u = (k + 0.5) / (n * n * points), g = k * 0.6180339887498949;
                const double v = g - std::floor(g);
                const auto d = squareMapDirection(layout, u, v);
                if (!d) continue;
                const auto at =
                    owningTexel(layout, n, static_cast<int>(u * n), static_cast<int>(v * n));
                ASSERT_TRUE(at);
                const double weight = solidAngleDensity(layout, *d);
                expected[static_cast<std::size_t>(at->y) * n + at->x] += weight;
                density_sum += weight;
            }
            double sum = 0, worst = 0;
            for (int y = 0; y < n; ++y) {
                for (int x = 0; x < n; ++x) {
                    const double w = squareMapSolidAngle(layout, n, x, y);
                    sum += w;
                    const double e = expected[static_cast<std::size_t>(y) * n + x];
                    worst = std::max(worst, std::abs(w - e / density_sum * 4 * kPi));
                }
            }
            EXPECT_NEAR(sum, 4 * kPi, 1e-9) << layoutName(layout) << " " << n;
            EXPECT_LT(worst * n * n / (4 * kPi), 0.05) << layoutName(layout) << " " << n;
        }
    }
}

// Interpolation is continuous across the octahedron's folds and past a ball map's rim.
TEST(SquareMaps, LookupsHaveNoSeam) {
    const auto scene = [](const V3d& d) { return V3d(1 + d.x, 1 + d.y, 1 + d.x * d.z); };
    for (Layout layout : {Layout::angular, Layout::octahedral}) {
        const Panorama map = test::filled(layout, 64, 64, scene);
        for (int k = 0; k < 2000; ++k) {
            const double phi = 0.1 * k, z = 1 - 2 * (k + 0.5) / 2000;
            const double r = std::sqrt(1 - z * z);
            const V3d d(r * std::cos(phi), r * std::sin(phi), z);
            EXPECT_LT((radianceAt(map, d) - scene(d)).length(), 0.06)
                << layoutName(layout) << " " << d.x << " " << d.y << " " << d.z;
        }
    }
    const Panorama map = test::noise(Layout::octahedral, 8, 8, 3);
    for (double angle = 0; angle < 6.28; angle += 0.1) {
        // Either side of the map's border: the lower half's meridians of the axes.
        for (const V3d& across : {V3d(1, 0, 0), V3d(0, 0, 1)}) {
            const V3d along = across.x > 0 ? V3d(0, 0, 1) : V3d(1, 0, 0);
            const V3d d = V3d(0, -1, 0) * std::abs(std::sin(angle)) + along * std::cos(angle);
            const V3d a = radianceAt(map, d + across * 1e-9),
                      b = radianceAt(map, d - across * 1e-9);
            EXPECT_LT((a - b).length(), 1e-6) << angle;
        }
    }
}

/// Of a sun in red and one in blue over a dark probe, by area everywhere; green has none.
V2d energyErrors(Panorama source, const V2i& red, const V2i& blue, Layout to, int size) {
    source.image.at(red.x, red.y)[0] = 1e6f;
    source.image.at(blue.x, blue.y)[2] = 1e6f;
    const V3d after = test::energy(resample(source, to, size, 2, Enlarging::hold));
    const V3d ratio = after / test::energy(source);
    EXPECT_NEAR(ratio.y, 1, 1e-6);
    return {std::abs(ratio.x - 1), std::abs(ratio.z - 1)};
}

TEST(SquareMaps, AreaFilterKeepsEnergyOfASunAnywhere) {
    const auto dark = [](const V3d&) { return V3d(1e-3); };
    const auto in_latlong = [](int k) { return V2i((k * 29) % 64, (k * 13) % 32); };
    // From the middle out to the rim, or the corners; where there is a texel.
    const auto in_map = [](Layout layout, int k) {
        V2i at((k * 7) % 33, (k * 11 + 16) % 33);
        while (texelSolidAngle(layout, 33, 33, at.x, at.y) == 0)
            at.x = 16;
        return at;
    };
    const Panorama latlong = test::filled(Layout::latlong, 64, 32, dark);
    for (Layout layout : kSquareMaps) {
        const Panorama map = test::filled(layout, 33, 33, dark);
        for (int k = 0; k < 20; ++k) {
            const V2d e = energyErrors(latlong, in_latlong(k), in_latlong(k + 20), layout, 13);
            EXPECT_LT(std::max(e.x, e.y), 1e-5) << layoutName(layout) << " " << k;
            // Texels of odd sizes hold the poles in their middles.
            for (const auto& [to, size] : {std::pair{Layout::latlong, 6},
                                           {Layout::faces, 6},
                                           {Layout::faces, 5},
                                           {Layout::angular, 13},
                                           {Layout::mirrorBall, 13},
                                           {Layout::octahedral, 13}}) {
                const V2d f =
                    energyErrors(map, in_map(layout, k), in_map(layout, k + 20), to, size);
                EXPECT_LT(std::max(f.x, f.y), layout == Layout::octahedral ? 1e-5 : 2e-4)
                    << layoutName(layout) << " to " << layoutName(to) << " " << k;
            }
        }
    }
}

} // namespace
} // namespace ibl
