#include "panorama/census.h"

#include "panorama/builtin.h"
#include "panorama/resample.h"
#include "unit/panorama/probes.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ibl {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

using test::filled;

TEST(Census, CountsAndPlacesBadPixels) {
    Panorama p = filled(Layout::latlong, 32, 16, [](const V3d&) { return V3d(1); });
    p.image.at(5, 3)[0] = kNan;
    p.image.at(5, 3)[1] = kNan; // the same pixel
    p.image.at(9, 3)[2] = kNan;
    p.image.at(20, 7)[1] = -kInf;
    p.image.at(1, 2)[0] = -1;
    p.image.at(31, 15)[2] = -3894;
    const Census census = takeCensus(p);
    EXPECT_EQ(census.nan.count, 2);
    EXPECT_EQ(census.nan.first, V2i(5, 3));
    EXPECT_EQ(census.infinite.count, 1);
    EXPECT_EQ(census.infinite.first, V2i(20, 7));
    EXPECT_EQ(census.infinite.extreme, -kInf);
    EXPECT_EQ(census.negative.count, 2);
    EXPECT_EQ(census.negative.first, V2i(1, 2));
    EXPECT_EQ(census.negative.extreme, -3894);
    EXPECT_EQ(census.negative.extreme_at, V2i(31, 15));
    EXPECT_EQ(census.min, V3d(-1, 1, -3894));
    EXPECT_EQ(census.max, V3d(1, 1, 1));
}

TEST(Census, MeansAreOfWhatIsFinite) {
    for (const Layout layout : {Layout::latlong, Layout::vcross}) {
        const V2i e = layoutExtent(layout, 16);
        Panorama p = filled(layout, e.x, e.y, [](const V3d& d) { return V3d(2, 3, d.y < 0); });
        for (int x = 0; x < e.x; ++x)
            p.image.at(x, e.y / 3)[0] = kNan;
        const Census census = takeCensus(p);
        EXPECT_NEAR(census.mean.x, 2, 1e-12) << layoutName(layout);
        EXPECT_NEAR(census.mean.y, 3, 1e-12) << layoutName(layout);
        EXPECT_LT(census.energy.x, 8 * kPi - 0.1) << layoutName(layout);
    }
}

TEST(Census, EnergyIsRadianceTimesSolidAngle) {
    for (Layout layout : test::kAllLayouts) {
        const V2i e = layoutExtent(layout, 8);
        const Census census =
            takeCensus(filled(layout, e.x, e.y, [](const V3d&) { return V3d(1, 2, 3); }));
        EXPECT_NEAR(census.energy.y, 8 * kPi, 1e-10) << layoutName(layout);
        EXPECT_NEAR(census.mean.z, 3, 1e-11) << layoutName(layout);
        EXPECT_EQ(census.min, V3d(1, 2, 3)) << layoutName(layout); // not the cross's blank cells
    }
    // cos theta clamped, over the sphere: pi.
    const Panorama cosine =
        filled(Layout::latlong, 512, 256, [](const V3d& d) { return V3d(std::max(0.0, d.y)); });
    EXPECT_NEAR(takeCensus(cosine).energy.x, kPi, 1e-4);
}

TEST(Census, FindsTheSunInEveryLayout) {
    const Panorama sky = builtinProbe("builtin:sky", 256);
    const V3d sun = takeCensus(sky).sun_direction;
    EXPECT_LT((sun - V3d(0.383, 0.643, 0.663)).length(), 0.02);
    for (Layout layout : test::kAllLayouts) {
        const Census census = takeCensus(resample(sky, layout, 96));
        EXPECT_LT((census.sun_direction - sun).length(), 0.04) << layoutName(layout);
        EXPECT_GT(census.sun_radiance.x, 300) << layoutName(layout);
    }
}

TEST(Census, SurvivesNothingFinite) {
    const Census census =
        takeCensus(filled(Layout::latlong, 2, 1, [](const V3d&) { return V3d(kNan); }));
    EXPECT_EQ(census.nan.count, 2);
    EXPECT_TRUE(std::isnan(census.mean.x) && std::isnan(census.min.y) && std::isnan(census.max.z));
    EXPECT_EQ(census.energy, V3d(0));
    EXPECT_EQ(census.sun_at, V2i(-1, -1));
}

TEST(Census, DoesNotDependOnThreads) {
    const Panorama p = test::noise(Layout::latlong, 67, 41, 21);
    EXPECT_EQ(takeCensus(p, 1).energy, takeCensus(p, 6).energy);
}

TEST(Repair, MendsEachKindInItsOwnWay) {
    Panorama p = filled(Layout::latlong, 16, 8, [](const V3d&) { return V3d(2); });
    p.image.at(4, 4)[0] = kNan;
    p.image.at(0, 3)[1] = kInf; // its neighbours reach around the seam
    p.image.at(15, 3)[1] = 50;
    p.image.at(8, 6)[2] = -5;
    p.image.at(8, 6)[1] = kNan; // the same pixel
    p.image.at(11, 1)[0] = -kInf;
    EXPECT_EQ(repair("p", p), 4);
    EXPECT_EQ(p.image.at(4, 4)[0], 2);
    EXPECT_EQ(p.image.at(4, 4)[1], 2);
    EXPECT_EQ(p.image.at(0, 3)[1], 50);
    EXPECT_EQ(p.image.at(8, 6)[2], 0);
    EXPECT_EQ(p.image.at(8, 6)[1], 2);
    EXPECT_EQ(p.image.at(11, 1)[0], 2);
    EXPECT_EQ(repair("p", p), 0);
}

TEST(Repair, FillsPatchesFromTheirRim) {
    Panorama p = filled(Layout::latlong, 64, 32, [](const V3d&) { return V3d(1); });
    for (int y = 4; y < 28; ++y) {
        for (int x = 10; x < 50; ++x)
            p.image.at(x, y)[1] = kNan;
    }
    EXPECT_EQ(repair("p", p), 24 * 40);
    for (float v : p.image.pixels)
        ASSERT_EQ(v, 1);
}

TEST(Repair, LeavesFacesApart) {
    Panorama p =
        filled(Layout::faces, 4, 24, [](const V3d& d) { return V3d(d.y > 0.65 ? 100 : 1); });
    p.image.at(2, 4)[0] = kNan;  // top row of -X, in the file under +X
    p.image.at(2, 12)[0] = kNan; // top row of -Y, in the file under +Y
    for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i)
            p.image.at(i, 20 + j)[0] = kNan; // all of -Z
    }
    EXPECT_EQ(repair("p", p), 18);
    EXPECT_EQ(p.image.at(2, 4)[0], 1);
    EXPECT_EQ(p.image.at(2, 12)[0], 1);
    // Nothing to go by on the face: the mean of all others.
    EXPECT_NEAR(p.image.at(1, 21)[0], (62.0f * 1 + 16 * 100) / 78, 1e-5);
}

TEST(Repair, LeavesFacesApartSideBySideToo) {
    Panorama p =
        filled(Layout::strip, 24, 4, [](const V3d& d) { return V3d(d.x < -0.6 ? 100 : 1); });
    p.image.at(3, 1)[0] = kNan; // right column of +X, beside -X
    p.image.at(3, 2)[1] = kInf;
    EXPECT_EQ(repair("p", p), 2);
    EXPECT_EQ(p.image.at(3, 1)[0], 1);
    EXPECT_EQ(p.image.at(3, 2)[1], 1);
}

TEST(Repair, RefusesWhenNothingIsLeft) {
    Panorama p = filled(Layout::latlong, 4, 2, [](const V3d&) { return V3d(1, kNan, 1); });
    EXPECT_THROW(repair("p", p), Error);
}

} // namespace
} // namespace ibl
