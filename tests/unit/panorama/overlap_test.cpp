#include "panorama/overlap.h"
#include "panorama/overlap_means.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

struct Case {
    int edge, width, height;
    bool border_cube, border_latlong;
};

double bandArea(const LatlongGrid& grid, int row) {
    const double a = grid.theta[static_cast<std::size_t>(row)];
    const double b = grid.theta[static_cast<std::size_t>(row) + 1];
    return 2 * kPi / grid.columns * 2 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
}

class Overlaps : public testing::TestWithParam<Case> {};

// The overlaps of a texel sum to its solid angle, those of a pixel to the pixel's.
TEST_P(Overlaps, PartitionTexelsAndPixels) {
    const Case c = GetParam();
    const CubeGrid cube = cubeGrid(c.edge, c.border_cube);
    const LatlongGrid grid = latlongGrid(c.width, c.height, c.border_latlong);
    const CubeLatlongOverlaps overlaps = cubeLatlongOverlaps(cube, grid, 0);
    std::vector<double> pixels(static_cast<std::size_t>(grid.columns) * grid.rows(), 0.0);
    for (int face = 0; face < 6; ++face) {
        for (int j = 0; j < c.edge; ++j) {
            for (int i = 0; i < c.edge; ++i) {
                double sum = 0;
                forEachOverlap(overlaps, face, i, j, [&](int x, int y, double area) {
                    ASSERT_TRUE(x >= 0 && x < grid.columns && y >= 0 && y < grid.rows());
                    ASSERT_GT(area, 0);
                    sum += area;
                    pixels[static_cast<std::size_t>(y) * grid.columns + x] += area;
                });
                const double exact = cubeRectangleSolidAngle(cube.lines[i], cube.lines[i + 1],
                                                             cube.lines[j], cube.lines[j + 1]);
                ASSERT_NEAR(sum, exact, 1e-11 * exact + 2e-15) << face << " " << i << " " << j;
            }
        }
    }
    for (int y = 0; y < grid.rows(); ++y) {
        const double exact = bandArea(grid, y);
        for (int x = 0; x < grid.columns; ++x) {
            ASSERT_NEAR(pixels[static_cast<std::size_t>(y) * grid.columns + x], exact,
                        1e-10 * exact + 2e-15)
                << x << " " << y;
        }
    }
}

// Which pixels: the direction of every overlapped pixel lies within reach of the texel.
TEST_P(Overlaps, AreWhereTexelAndPixelMeet) {
    const Case c = GetParam();
    const CubeGrid cube = cubeGrid(c.edge, c.border_cube);
    const LatlongGrid grid = latlongGrid(c.width, c.height, c.border_latlong);
    const CubeLatlongOverlaps overlaps = cubeLatlongOverlaps(cube, grid, 1);
    const double reach = kPi / grid.rows() + 2 * kPi / grid.columns + 2.9 / c.edge;
    if (reach > 1) return;
    for (int face = 0; face < 6; ++face) {
        for (int j = 0; j < c.edge; ++j) {
            for (int i = 0; i < c.edge; ++i) {
                const V3d d = cubeDirection({face, 0.5 * (cube.lines[i] + cube.lines[i + 1]),
                                             0.5 * (cube.lines[j] + cube.lines[j + 1])})
                                  .normalized();
                forEachOverlap(overlaps, face, i, j, [&](int x, int y, double) {
                    const double theta = 0.5 * (grid.theta[y] + grid.theta[y + 1]);
                    const V3d p =
                        latlongDirection((x + 0.5 + grid.first) / grid.columns, theta / kPi);
                    ASSERT_LT((p - d).length(), reach) << face << " " << i << " " << j;
                });
            }
        }
    }
}

// What octants share is summed texel by texel, all else octants side by side.
TEST_P(Overlaps, MeansAreThoseOfEveryTexelsParts) {
    const Case c = GetParam();
    const LatlongGrid grid = latlongGrid(c.width, c.height, c.border_latlong);
    const CubeLatlongOverlaps overlaps =
        cubeLatlongOverlaps(cubeGrid(c.edge, c.border_cube), grid, 0);
    Panorama source{c.border_latlong ? Layout::exrLatlong : Layout::latlong,
                    Image(c.width, c.height)};
    for (std::size_t k = 0; k < source.image.pixels.size(); ++k)
        source.image.pixels[k] = static_cast<float>((k * 7919) % 10007);
    const LatlongPixels pixels(source);
    const Layout layout = c.border_cube ? Layout::exrCube : Layout::hcross;
    const V2i extent = layoutExtent(layout, c.edge);
    Panorama result{layout, Image(extent.x, extent.y)};
    const CubePlacement place(result);
    overlapMeans(overlaps, pixels, place, result.image, 2);
    for (int face = 0; face < 6; ++face) {
        for (int j = 0; j < c.edge; ++j) {
            for (int i = 0; i < c.edge; ++i) {
                V3d sum(0);
                double all = 0;
                forEachOverlap(overlaps, face, i, j, [&](int x, int y, double area) {
                    const float* p = pixels.at(x, y);
                    sum += V3d(p[0], p[1], p[2]) * area;
                    all += area;
                });
                const V2i at = place.pixel(face, i, j);
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_NEAR(result.image.at(at.x, at.y)[channel], sum[channel] / all, 1e-3)
                        << face << " " << i << " " << j;
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, Overlaps,
    testing::Values(Case{1, 1, 1, false, false}, Case{1, 2, 1, false, false},
                    Case{2, 3, 2, false, false}, Case{3, 16, 8, false, false},
                    Case{8, 32, 16, false, false}, Case{16, 64, 32, false, false},
                    Case{5, 37, 19, false, false}, Case{64, 101, 57, false, false},
                    Case{7, 1, 101, false, false}, Case{4, 257, 3, false, false},
                    Case{31, 30, 64, false, false}, Case{64, 512, 256, false, false},
                    Case{16, 65, 33, false, true}, Case{9, 64, 32, true, false},
                    Case{8, 31, 15, true, true}, Case{2, 2, 2, true, true}));

} // namespace
} // namespace ibl
