#include "convolve/row_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ibl {
namespace {

TEST(RowGeometry, PointsAreThoseOfEveryDirection) {
    std::vector<V3d> directions;
    for (const double x : {-1.0, -0.0, 0.0, 1.0})
        for (const double y : {-1.0, -0.0, 0.0, 1.0})
            for (const double z : {-1.0, -0.0, 0.0, 1.0})
                if (x != 0 || y != 0 || z != 0) directions.push_back(V3d(x, y, z).normalized());
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 10001; ++i) { // more than a vector's worth left, and near axes and planes
        const V3d d(any(random), any(random), any(random));
        directions.push_back(
            (i % 3 == 0 ? V3d(d.x * 1e-9, d.y, d.z * (i % 2 == 0 ? 1e-12 : 1)) : d).normalized());
    }
    std::vector<double> u(directions.size()), v(directions.size());
    latlongPoints(directions.data(), directions.size(), u.data(), v.data());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const V3d& p = directions[i]; // polar: the pole along +Z
        const V2d expected = latlongPoint(V3d(p.y, p.z, 0.0 - p.x));
        EXPECT_NEAR(std::remainder(u[i] - expected.x, 1), 0, 4e-16) << p;
        EXPECT_NEAR(v[i], expected.y, 4e-16) << p;
        EXPECT_TRUE(u[i] >= 0 && u[i] <= 1) << p;
    }
}

TEST(RowGeometry, SolidAnglesAreThoseOfTexels) {
    for (const int edge : {1, 2, 7, 64, 300, 4096}) {
        std::vector<double> row(static_cast<std::size_t>(edge));
        for (const int j : {0, edge / 3, edge - 1}) {
            faceRowSolidAngles(edge, j, row.data());
            for (int i = 0; i < edge; ++i) {
                const double exact = cubeTexelSolidAngle(i, j, edge);
                // What is left of sums that cancel to an area.
                EXPECT_NEAR(row[static_cast<std::size_t>(i)], exact, 1e-14 * exact + 1e-15)
                    << edge << " " << i << " " << j;
            }
        }
    }
}

} // namespace
} // namespace ibl
