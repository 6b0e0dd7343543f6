#include "panorama/lookup.h"

#include "panorama/square_maps.h"

#include "unit/panorama/probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

using test::filled;
using test::kAllLayouts;

V3d smooth(const V3d& d) {
    return {1 + 0.5 * d.x, 1 + 0.5 * d.y, 1 + 0.5 * d.z};
}

std::vector<V3d> directions() {
    std::vector<V3d> list{{1, 0, 0},       {-1, 0, 0}, {0, 1, 0},        {0, -1, 0},
                          {0, 0, 1},       {0, 0, -1}, {1, 1, 0},        {-1, 1, 1},
                          {1, -1, 1},      {1, 0, -1}, {1e-9, 1, -1e-9}, {-1e-12, 0.2, -1},
                          {1e-12, 0.2, -1}};
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 500; ++k)
        list.emplace_back(normal(random), normal(random), normal(random));
    return list;
}

TEST(Lookup, FindsAConstant) {
    for (Layout layout : kAllLayouts) {
        for (int size : {1, 2, 5}) {
            const V2i e = layoutExtent(layout, size);
            const Panorama p = filled(layout, e.x, e.y, [](const V3d&) { return V3d(0.7f); });
            for (const V3d& d : directions()) {
                EXPECT_NEAR(radianceAt(p, d).y, 0.7f, 1e-15) << layoutName(layout) << size;
            }
        }
    }
    const Panorama one = filled(Layout::latlong, 1, 1, [](const V3d&) { return V3d(3); });
    EXPECT_DOUBLE_EQ(radianceAt(one, {0.3, -0.2, 0.1}).x, 3);
}

// Everywhere, seams, poles, edges and corners among it, a smooth probe is found as it is, to the
// second order of the pitch; near the corners of a cube, where texels across an edge stand aside
// from the line of those before it, to the first.
TEST(Lookup, FollowsASmoothProbeAcrossAllSeams) {
    for (Layout layout : kAllLayouts) {
        for (int size : {16, 17, 64}) {
            const V2i e = layoutExtent(layout, size);
            const Panorama p = filled(layout, e.x, e.y, smooth);
            // The middle of an angular map is coarser, and past a ball map's rim the nearest texel
            // stands for the row beyond; an octahedron has creases; a mirror ball is singular at
            // -Z.
            double bound = 4.0 / (size * size) + (isCubeFamily(layout) ? 0.15 / size : 0);
            if (isSquareMap(layout)) bound = 8.0 / (size * size) + 1.2 / size;
            for (const V3d& d : directions()) {
                if (layout == Layout::mirrorBall && d.z < -0.6 * d.length()) continue;
                const V3d expected = smooth(d.normalized());
                EXPECT_LT((radianceAt(p, d) - expected).length(), bound)
                    << layoutName(layout) << " " << size << " at " << d.x << " " << d.y << " "
                    << d.z;
            }
        }
    }
}

TEST(Lookup, IsThePixelAtItsCentre) {
    for (Layout layout : kAllLayouts) {
        const V2i e = layoutExtent(layout, 6);
        const Panorama p = test::noise(layout, e.x, e.y, 5);
        for (int y = 1; y + 1 < e.y; ++y) {
            for (int x = 1; x + 1 < e.x; ++x) {
                const bool border = layout == Layout::exrCube;
                if (border && (x % 6 == 0 || x % 6 == 5 || y % 6 == 0 || y % 6 == 5)) continue;
                const auto d = texelDirection(layout, e.x, e.y, x + 0.5, y + 0.5);
                if (!d) continue;
                EXPECT_LT((radianceAt(p, *d) - test::pixel(p, x, y)).length(), 1e-13)
                    << layoutName(layout) << " " << x << " " << y;
            }
        }
    }
}

// Approached from either side, seams, poles and cube edges give one value, also of noise.
TEST(Lookup, IsContinuous) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (Layout layout : {Layout::latlong, Layout::faces, Layout::hcross, Layout::vcross}) {
        const V2i e = layoutExtent(layout, 8);
        const Panorama p = test::noise(layout, e.x, e.y, 7);
        for (int k = 0; k < 400; ++k) {
            V3d d(unit(random), unit(random), unit(random));
            if (k % 4 == 0) d = V3d(1, std::copysign(1, d.y), d.z); // a cube edge
            if (k % 4 == 1) d = V3d(0, d.y, -1);                    // the lat-long's seam
            if (k % 4 == 2) d = V3d(0, std::copysign(1, d.y), 0);   // a pole
            const V3d aside(1e-9 * unit(random), 1e-9 * unit(random), 1e-9 * unit(random));
            EXPECT_LT((radianceAt(p, d + aside) - radianceAt(p, d - aside)).length(), 1e-6)
                << layoutName(layout) << " at " << d.x << " " << d.y << " " << d.z;
        }
    }
}

TEST(Lookup, AveragesAlongTheParallelNearThePoles) {
    Panorama p = filled(Layout::latlong, 64, 32, [](const V3d&) { return V3d(0); });
    p.image.at(10, 0)[0] = 64; // a row mean of 1
    const Sampler sampler = makeSampler(p);
    const V3d near_pole = latlongDirection(0.7, 0.5 / 32);
    EXPECT_NEAR(radianceAt(sampler, near_pole, 0).x, 0, 1e-12);
    EXPECT_NEAR(radianceAt(sampler, near_pole, 1).x, 1, 1e-12);
    EXPECT_NEAR(radianceAt(sampler, {0, 1, 0}, 0).x, 1, 1e-12);
}

} // namespace
} // namespace ibl
