#include "convolve/near_own_texels.h"
#include "panorama/latlong_moments.h"
#include "panorama/resample.h"
#include "unit/panorama/probes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace ibl {
namespace {

PrefilterResult convolved(const Panorama& latlong, const Panorama* source,
                          const PrefilterRequest& request, double max_error) {
    PrefilterOptions options;
    options.max_error = max_error;
    options.source = source;
    return std::move(prefilter(latlong, {&request, 1}, options)[0]);
}

/// Relative RMSE.
double difference(const Panorama& a, const Panorama& b) {
    double error = 0, norm = 0;
    for (int y = 0; y < a.image.height; ++y) {
        for (int x = 0; x < a.image.width; ++x) {
            const double area = texelSolidAngle(a.layout, a.image.width, a.image.height, x, y);
            for (int c = 0; c < 3; ++c) {
                error += area * std::pow(a.image.at(x, y)[c] - b.image.at(x, y)[c], 2);
                norm += area * std::pow(b.image.at(x, y)[c], 2);
            }
        }
    }
    return std::sqrt(error / norm);
}

V3d energyOf(const Panorama& map) {
    V3d energy(0);
    for (int y = 0; y < map.image.height; ++y) {
        for (int x = 0; x < map.image.width; ++x) {
            const float* p = map.image.at(x, y);
            energy += V3d(p[0], p[1], p[2]) *
                      texelSolidAngle(map.layout, map.image.width, map.image.height, x, y);
        }
    }
    return energy;
}

const Lobe kLobes[] = {{Kernel::ggx, 0.1},
                       {Kernel::ggx, 0.03},
                       {Kernel::ggx, 0.003},
                       {Kernel::phong, 3000},
                       {Kernel::blinnPhong, 1e5}};

TEST(NearOwnTexels, IsForNarrowLobesOfCoarseProbes) {
    const Panorama cube = test::noise(Layout::vcross, 3 * 64, 4 * 64, 3);
    EXPECT_TRUE(seesOwnTexels(cube, {Kernel::ggx, 0.1}));
    EXPECT_FALSE(seesOwnTexels(cube, {Kernel::ggx, 0.2}));
    EXPECT_FALSE(seesOwnTexels(cube, {Kernel::charlie, 0.05}));
    EXPECT_TRUE(seesOwnTexels(test::noise(Layout::octahedral, 64, 64, 3), {Kernel::ggx, 0.1}));
    EXPECT_FALSE(seesOwnTexels(test::noise(Layout::octahedral, 2048, 2048, 3), {Kernel::ggx, 0.1}));
    EXPECT_FALSE(seesOwnTexels(test::noise(Layout::latlong, 64, 32, 3), {Kernel::ggx, 0.05}));
    EXPECT_FALSE(seesOwnTexels(test::noise(Layout::exrCube, 3, 18, 3), {Kernel::ggx, 0.05}));
}

// The same of probes that are coarse, so that little is lost in a fine lat-long: their values at
// its pixels, with what borders share.
Panorama noiseOf(Layout layout, int size) {
    const V2i extent = layoutExtent(layout, size);
    Panorama noise = test::noise(layout, extent.x, extent.y, 3);
    mergeBorder(noise);
    return noise;
}

// Of lobes wide beside the rows of a lat-long, of which little is lost then, and of one that is
// narrow beside all texels, which leaves the area filter's means.
TEST(NearOwnTexels, AreWhatAFineLatlongGives) {
    struct Case {
        Layout layout;
        int size;
        Layout to;
        int to_size;
    };
    for (const Case& c : {Case{Layout::hcross, 12, Layout::vstrip, 7},
                          {Layout::hcross, 12, Layout::mirrorBall, 6},
                          {Layout::hcross, 12, Layout::exrCube, 4},
                          {Layout::exrCube, 13, Layout::latlong, 6},
                          {Layout::exrLatlong, 16, Layout::octahedral, 5},
                          {Layout::octahedral, 24, Layout::exrLatlong, 4},
                          {Layout::octahedral, 15, Layout::octahedral, 5},
                          {Layout::octahedral, 16, Layout::latlong, 24},
                          {Layout::angular, 24, Layout::vstrip, 5},
                          {Layout::mirrorBall, 25, Layout::octahedral, 6}}) {
        const Panorama probe = noiseOf(c.layout, c.size);
        const Panorama latlong = latlongOfMoments(probe, 512, 0);
        PrefilterOptions reference;
        reference.reference = true;
        reference.source = &probe;
        for (const Lobe& lobe : {kLobes[0], kLobes[3]}) {
            const PrefilterRequest request{lobe, c.to, c.to_size};
            const PrefilterResult own = convolved(latlong, &probe, request, 1e-5);
            const PrefilterResult fine = convolved(latlong, nullptr, request, 1e-5);
            const std::string title = std::string(layoutName(c.layout)) + " to " +
                                      std::string(layoutName(c.to)) + " " +
                                      std::to_string(lobe.parameter);
            EXPECT_LT(difference(own.map, fine.map), 2e-5) << title;
            EXPECT_LT(own.error_bound, 1.5e-5) << title; // 512 rows are few
            EXPECT_LT(difference(own.map, prefilter(latlong, {&request, 1}, reference)[0].map),
                      5e-6)
                << title;
        }
        const PrefilterRequest narrow{kLobes[2], Layout::faces, 7};
        const Panorama means = resample(probe, Layout::faces, 7, 0, Enlarging::hold);
        EXPECT_LT(difference(convolved(latlong, &probe, narrow, 1e-5).map, means), 1e-3)
            << layoutName(c.layout);
    }
}

// Where texels are their centres' values too.
TEST(NearOwnTexels, AreTheReferencesAtCentres) {
    const Panorama cube = noiseOf(Layout::hcross, 12);
    const PrefilterRequest fine{kLobes[0], Layout::faces, 100};
    PrefilterOptions reference;
    reference.reference = true;
    reference.source = &cube;
    const Panorama latlong = latlongOfMoments(cube, 256, 0);
    EXPECT_LT(difference(convolved(latlong, &cube, fine, 1e-5).map,
                         prefilter(latlong, {&fine, 1}, reference)[0].map),
              2e-5);
}

// Odd edges, edges of one texel, and texels smaller and larger than the map's.
TEST(NearOwnTexels, SunsKeepTheirEnergyAndConstantsStay) {
    for (const int edge : {1, 5, 33}) {
        const V2i extent = layoutExtent(Layout::faces, edge);
        Panorama sun{Layout::faces, Image(extent.x, extent.y)};
        std::ranges::fill(sun.image.pixels, 0.0f);
        sun.image.at(edge / 3, edge)[0] = 1e9f;            // at the left edge of -X
        sun.image.at(edge - 1, 3 * edge - 1)[1] = 65504.f; // in a corner of +Y
        sun.image.at(edge / 2, 4 * edge + edge / 2)[2] = 1e-3f;
        Panorama even{Layout::faces, Image(extent.x, extent.y)};
        std::ranges::fill(even.image.pixels, 0.7f);
        const Panorama sun_latlong = latlongOfMoments(sun, 256, 0);
        const Panorama even_latlong = latlongOfMoments(even, 256, 0);
        const V3d energy = energyOf(sun);
        for (const Lobe& lobe : kLobes) {
            for (const int size : {3, 24}) {
                const PrefilterRequest request{lobe, Layout::faces, size};
                const PrefilterResult map = convolved(sun_latlong, &sun, request, 1e-4);
                for (const float value : map.map.image.pixels)
                    ASSERT_GE(value, 0);
                const V3d kept = energyOf(map.map);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(kept[c] / energy[c], 1, 1e-5)
                        << edge << " " << size << " " << lobe.parameter << " " << c;
                for (const float value :
                     convolved(even_latlong, &even, request, 1e-4).map.image.pixels)
                    ASSERT_NEAR(value / 0.7, 1, 1e-6) << edge << " " << lobe.parameter;
            }
        }
    }
}

} // namespace
} // namespace ibl
