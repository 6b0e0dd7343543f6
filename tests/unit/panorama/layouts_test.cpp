#include "panorama/layouts.h"

#include "unit/panorama/probes.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <functional>

namespace ibl {
namespace {

using test::kAllLayouts;

void expectDirection(const std::optional<V3d>& d, const V3d& expected) {
    ASSERT_TRUE(d);
    EXPECT_LT((*d - expected.normalized()).length(), 1e-14)
        << d->x << " " << d->y << " " << d->z << " is not " << expected.x << " " << expected.y
        << " " << expected.z;
}

TEST(Layouts, NamesGoBothWays) {
    for (Layout layout : kAllLayouts)
        EXPECT_EQ(layoutFromName(layoutName(layout)), layout);
    EXPECT_EQ(layoutName(Layout::exrCube), "exr-cube");
    EXPECT_FALSE(layoutFromName("Latlong"));
    EXPECT_FALSE(layoutFromName(""));
    EXPECT_EQ(layoutNames().size(), kAllLayouts.size());
}

TEST(Layouts, LatlongStandsAsTheConventionsSay) {
    expectDirection(texelDirection(Layout::latlong, 64, 32, 32, 16), {0, 0, 1});
    expectDirection(texelDirection(Layout::latlong, 64, 32, 16, 16), {1, 0, 0});
    expectDirection(texelDirection(Layout::latlong, 64, 32, 48, 16), {-1, 0, 0});
    expectDirection(texelDirection(Layout::latlong, 64, 32, 0, 16), {0, 0, -1});
    expectDirection(texelDirection(Layout::latlong, 64, 32, 5, 0), {0, 1, 0});
    expectDirection(texelDirection(Layout::latlong, 64, 32, 5, 32), {0, -1, 0});
}

// OpenEXR: pixel (0, 0) has latitude pi/2 and longitude pi, the last one -pi/2 and -pi; longitude
// pi/2 is +X (ImfEnvmap.h).
TEST(Layouts, ExrLatlongHasCentresOnPolesAndSeam) {
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 0.5, 1.5), {0, 0, -1});
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 1.5, 1.5), {1, 0, 0});
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 2.5, 1.5), {0, 0, 1});
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 4.5, 1.5), {0, 0, -1});
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 3.5, 0.5), {0, 1, 0});
    expectDirection(texelDirection(Layout::exrLatlong, 5, 3, 3.5, 2.5), {0, -1, 0});
}

/// OpenGL 4.6 core, table 8.19: face, sc, tc and ma of a direction; s = (sc / |ma| + 1) / 2.
CubePoint openGlPoint(const V3d& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x > y && x > z) {
        return d.x > 0 ? CubePoint{0, -d.z / x, -d.y / x} : CubePoint{1, d.z / x, -d.y / x};
    }
    if (y > z) return d.y > 0 ? CubePoint{2, d.x / y, d.z / y} : CubePoint{3, d.x / y, -d.z / y};
    return d.z > 0 ? CubePoint{4, d.x / z, -d.y / z} : CubePoint{5, -d.x / z, -d.y / z};
}

TEST(Layouts, FacesAndStripsAreWhatOpenGlSamples) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 1000; ++k) {
        const V3d d(normal(random), normal(random), normal(random));
        const CubePoint p = openGlPoint(d);
        const double u = 5 * (p.s + 1), v = 5 * (p.t + 1); // on a face of 10 x 10
        expectDirection(texelDirection(Layout::faces, 10, 60, u, v + 10 * p.face), d);
        expectDirection(texelDirection(Layout::vstrip, 10, 60, u, v + 10 * p.face), d);
        expectDirection(texelDirection(Layout::strip, 60, 10, u + 10 * p.face, v), d);
    }
}

// With a to the right and b up in a cell, seen from inside: where one cell's edge meets another's,
// directions agree, front is +Z and up is +Y.
TEST(Layouts, CrossCellsAreSeenFromInside) {
    using Cell = std::function<V3d(double, double)>;
    struct Case {
        Layout layout;
        int column, row;
        Cell direction;
    };
    const std::vector<Case> cases{
        {Layout::hcross, 1, 1, [](double a, double b) { return V3d(-a, b, 1); }},
        {Layout::hcross, 0, 1, [](double a, double b) { return V3d(1, b, a); }},
        {Layout::hcross, 2, 1, [](double a, double b) { return V3d(-1, b, -a); }},
        {Layout::hcross, 1, 0, [](double a, double b) { return V3d(-a, 1, -b); }},
        {Layout::hcross, 1, 2, [](double a, double b) { return V3d(-a, -1, b); }},
        {Layout::hcross, 3, 1, [](double a, double b) { return V3d(a, b, -1); }},
        {Layout::vcross, 1, 1, [](double a, double b) { return V3d(-a, b, 1); }},
        {Layout::vcross, 0, 1, [](double a, double b) { return V3d(1, b, a); }},
        {Layout::vcross, 2, 1, [](double a, double b) { return V3d(-1, b, -a); }},
        {Layout::vcross, 1, 0, [](double a, double b) { return V3d(-a, 1, -b); }},
        {Layout::vcross, 1, 2, [](double a, double b) { return V3d(-a, -1, b); }},
        {Layout::vcross, 1, 3, [](double a, double b) { return V3d(-a, -b, -1); }},
    };
    constexpr int kEdge = 8;
    for (const Case& c : cases) {
        const V2i extent = layoutExtent(c.layout, kEdge);
        for (double a : {-0.9, -0.2, 0.6}) {
            for (double b : {-0.7, 0.1, 0.8}) {
                const double x = (c.column + 0.5 * (a + 1)) * kEdge;
                const double y = (c.row + 0.5 * (1 - b)) * kEdge;
                expectDirection(texelDirection(c.layout, extent.x, extent.y, x, y),
                                c.direction(a, b));
            }
        }
    }
    for (int cell : {0, 2, 3}) {
        EXPECT_FALSE(texelDirection(Layout::hcross, 32, 24, 8 * cell + 4, 4));
        EXPECT_FALSE(texelDirection(Layout::hcross, 32, 24, 8 * cell + 4, 20));
    }
    for (int row : {0, 2, 3}) {
        EXPECT_FALSE(texelDirection(Layout::vcross, 24, 32, 4, 8 * row + 4));
        EXPECT_FALSE(texelDirection(Layout::vcross, 24, 32, 20, 8 * row + 4));
    }
}

// Neighbouring pixels of the middle row and column of a cross look in neighbouring directions,
// across cells too: so no cell is mirrored or turned wrongly.
TEST(Layouts, CrossesAreContinuousAcrossTheirFolds) {
    constexpr int kEdge = 16;
    const auto step = [](Layout layout, V2i from, V2i to) {
        const V2i e = layoutExtent(layout, kEdge);
        const auto a = texelDirection(layout, e.x, e.y, from.x + 0.5, from.y + 0.5);
        const auto b = texelDirection(layout, e.x, e.y, to.x + 0.5, to.y + 0.5);
        return (*a - *b).length();
    };
    for (int k = 0; k < kEdge; ++k) {
        for (int x = 0; x + 1 < 4 * kEdge; ++x) {
            EXPECT_LT(step(Layout::hcross, {x, kEdge + k}, {x + 1, kEdge + k}), 2.2 / kEdge);
        }
        for (int y = 0; y + 1 < 4 * kEdge; ++y) {
            EXPECT_LT(step(Layout::vcross, {kEdge + k, y}, {kEdge + k, y + 1}), 2.2 / kEdge);
        }
    }
}

TEST(Layouts, PointIsTheInverseOfDirection) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    for (Layout layout : kAllLayouts) {
        const V2i extent = layoutExtent(layout, 12);
        for (int k = 0; k < 200; ++k) {
            const V3d d(normal(random), normal(random), normal(random));
            const V2d p = texelPoint(layout, extent.x, extent.y, d);
            const auto back = texelDirection(layout, extent.x, extent.y, p.x, p.y);
            ASSERT_TRUE(back) << layoutName(layout);
            EXPECT_LT((*back - d.normalized()).length(), 1e-13) << layoutName(layout);
        }
    }
}

TEST(Layouts, PlacementAgreesWithDirections) {
    constexpr int kEdge = 5;
    for (Layout layout : kAllLayouts) {
        if (!isCubeFamily(layout)) continue;
        const V2i extent = layoutExtent(layout, kEdge);
        for (int face = 0; face < 6; ++face) {
            const FacePlacement place = facePlacement(layout, kEdge, face);
            for (int j = 0; j < kEdge; ++j) {
                for (int i = 0; i < kEdge; ++i) {
                    const V2i at = place.pixel(i, j);
                    expectDirection(
                        texelDirection(layout, extent.x, extent.y, at.x + 0.5, at.y + 0.5),
                        cubeTexelDirection(face, i, j, kEdge));
                }
            }
        }
    }
}

TEST(Layouts, SolidAnglesSumToTheSphere) {
    const auto sum = [](Layout layout, int width, int height) {
        double total = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x)
                total += texelSolidAngle(layout, width, height, x, y);
        }
        return total;
    };
    for (Layout layout : kAllLayouts) {
        for (int size : {1, 2, 3, 8, 17, 31}) {
            const V2i e = layoutExtent(layout, size);
            EXPECT_NEAR(sum(layout, e.x, e.y), 4 * kPi, 1e-12) << layoutName(layout) << " " << size;
        }
    }
    for (Layout layout : {Layout::latlong, Layout::exrLatlong}) {
        for (V2i e : {V2i(1, 1), V2i(2, 1), V2i(3, 2), V2i(16, 8), V2i(37, 101), V2i(1, 5)}) {
            EXPECT_NEAR(sum(layout, e.x, e.y), 4 * kPi, 1e-12) << e.x << "x" << e.y;
        }
    }
}

TEST(Layouts, ToldFromShape) {
    const auto told = [](int w, int h, std::string_view envmap = "") {
        return detectLayout("probe", w, h, envmap);
    };
    EXPECT_EQ(told(1024, 512), Layout::latlong);
    EXPECT_EQ(told(252, 127), Layout::latlong); // |W - 2H| = 2
    EXPECT_EQ(told(256, 127), Layout::latlong);
    EXPECT_EQ(told(2, 1), Layout::latlong);
    EXPECT_EQ(told(3, 2), Layout::latlong);
    EXPECT_EQ(told(4, 3), Layout::latlong); // rather than a cross of single pixels
    EXPECT_EQ(told(768, 1024), Layout::vcross);
    EXPECT_EQ(told(1024, 768), Layout::hcross);
    EXPECT_EQ(told(384, 64), Layout::strip);
    EXPECT_EQ(told(64, 384), Layout::vstrip);
    EXPECT_EQ(told(1024, 512, "latlong"), Layout::exrLatlong);
    EXPECT_EQ(told(64, 384, "cube"), Layout::exrCube);
}

TEST(Layouts, WrongShapesAreRefused) {
    const auto refused = [](int w, int h, std::string_view envmap = "") {
        try {
            detectLayout("some.hdr", w, h, envmap);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::input);
            EXPECT_EQ(std::string(e.what()).find("some.hdr: "), 0u) << e.what();
            return true;
        }
        return false;
    };
    EXPECT_TRUE(refused(1, 1));
    EXPECT_TRUE(refused(2, 2));
    EXPECT_TRUE(refused(1, 2));
    EXPECT_TRUE(refused(100, 100));
    EXPECT_TRUE(refused(640, 360));
    EXPECT_TRUE(refused(1025, 511)); // |W - 2H| = 3
    EXPECT_TRUE(refused(1024, 510)); // |W - 2H| = 4
    EXPECT_TRUE(refused(1026, 768)); // nearly a cross
    EXPECT_TRUE(refused(512, 1024));
    EXPECT_TRUE(refused(1024, 512, "cube"));
    EXPECT_THROW(requireLayoutExtent("p", Layout::vcross, 31, 40), Error);
    EXPECT_THROW(requireLayoutExtent("p", Layout::strip, 60, 11), Error);
    EXPECT_NO_THROW(requireLayoutExtent("p", Layout::vcross, 30, 40));
    EXPECT_NO_THROW(requireLayoutExtent("p", Layout::latlong, 1, 1));
}

TEST(Layouts, CrossCornersMustBeOfOneValue) {
    Panorama cross = test::noise(Layout::hcross, 16, 12, 3);
    EXPECT_TRUE(crossCellsBlank(cross));
    cross.image.at(1, 1)[2] = 0.5f;
    EXPECT_FALSE(crossCellsBlank(cross));
    EXPECT_TRUE(crossCellsBlank(test::noise(Layout::latlong, 16, 12, 3)));
}

} // namespace
} // namespace ibl
