// Probes of other layouts read into lat-longs that keep their energy and first moments.
#include "panorama/latlong_moments.h"

#include "panorama/builtin.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ibl {
namespace {

/// Integrals of the radiance (red) over the sphere.
struct Integrals {
    double energy = 0;
    double smooth = 0; ///< of the radiance times a smooth function

    double mean() const { return smooth / energy; }
};

double smooth(const V3d& d) {
    return std::pow(d.x + 2 * d.y - d.z, 3);
}

Integrals integrate(const Panorama& p, int parts) {
    Integrals sums;
    for (int y = 0; y < p.image.height; ++y) {
        for (int x = 0; x < p.image.width; ++x) {
            const double area = texelSolidAngle(p.layout, p.image.width, p.image.height, x, y);
            double mean = 0, weights = 0;
            for (int k = 0; k < parts * parts; ++k) {
                const auto d =
                    texelDirection(p.layout, p.image.width, p.image.height,
                                   x + (k % parts + 0.5) / parts, y + (k / parts + 0.5) / parts);
                if (!d) continue;
                const double weight = p.layout == Layout::latlong ? std::sqrt(1 - d->y * d->y)
                                                                  : solidAngleDensity(p.layout, *d);
                mean += weight * smooth(*d);
                weights += weight;
            }
            if (weights == 0) continue;
            sums.energy += area * p.image.at(x, y)[0];
            sums.smooth += area * p.image.at(x, y)[0] * mean / weights;
        }
    }
    return sums;
}

/// A lone bright texel on grey, of a size that shares no edges with the lat-long's rows.
Panorama spotted(Layout layout, int size) {
    const V2i extent = layoutExtent(layout, size);
    Panorama p{layout, Image(extent.x, extent.y)};
    for (float& value : p.image.pixels)
        value = 0.01F;
    for (const V2i& at : {V2i(extent.x / 3, extent.y / 3), V2i(extent.x / 2, 2 * extent.y / 3)})
        std::fill_n(p.image.at(at.x, at.y), 3, 1000.0F);
    return p;
}

/// A blur by half a pixel at texels' edges shows in a smooth function's integral: means alone are
/// off by the square of a row's height, moments by its third power.
TEST(LatlongMoments, KeepWhatSmoothLobesSee) {
    constexpr int kRows = 96;
    for (const auto& [layout, size] :
         {std::pair{Layout::faces, 7}, {Layout::octahedral, 11}, {Layout::faces, 10}}) {
        const Panorama probe = spotted(layout, size);
        const Integrals exact = integrate(probe, 64);
        const Integrals kept = integrate(latlongOfMoments(probe, kRows, 2), 4);
        const Integrals means =
            integrate(resample(probe, Layout::latlong, kRows, 2, Enlarging::hold), 4);
        EXPECT_NEAR(kept.energy / exact.energy, 1, 1e-6) << layoutName(layout) << size;
        const double error = std::abs(kept.mean() / exact.mean() - 1);
        EXPECT_LT(error, 0.1 * std::abs(means.mean() / exact.mean() - 1))
            << layoutName(layout) << size;
        EXPECT_LT(error, 1e-4) << layoutName(layout) << size;
    }
}

/// Halved, a lat-long has the moments that it had.
TEST(LatlongMoments, StayWhenALatlongIsHalved) {
    const Panorama probe = spotted(Layout::faces, 7);
    const Panorama fine = latlongOfMoments(probe, 192, 2);
    const Panorama half{Layout::latlong, halveKeepingMoments(fine.image, 2)};
    ASSERT_EQ(half.image.height, 96);
    EXPECT_NEAR(integrate(half, 4).mean() / integrate(probe, 64).mean(), 1, 1e-4);
}

TEST(LatlongMoments, ConstantStaysConstant) {
    for (const Layout layout : {Layout::vcross, Layout::angular, Layout::mirrorBall,
                                Layout::octahedral, Layout::exrLatlong, Layout::exrCube}) {
        const V2i extent = layoutExtent(layout, 9);
        Panorama probe{layout, Image(extent.x, extent.y)};
        std::ranges::fill(probe.image.pixels, 3.0F);
        for (const int rows : {4, 64}) {
            for (const float value : latlongOfMoments(probe, rows, 2).image.pixels)
                ASSERT_NEAR(value, 3, 3e-6) << layoutName(layout) << " " << rows;
        }
    }
}

} // namespace
} // namespace ibl
