// Every layout of the table can be synthesised onto.
#include "convolve/prefilter.h"

#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/square_maps.h"
#include "unit/panorama/probes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

TEST(PrefilterLayouts, FurnaceIsOneInEveryLayout) {
    Image probe(32, 16);
    std::fill(probe.pixels.begin(), probe.pixels.end(), 0.7f);
    for (const std::string& name : layoutNames()) {
        const Layout layout = *layoutFromName(name);
        for (const Lobe& lobe :
             {Lobe{Kernel::ggx, 0}, Lobe{Kernel::ggx, 0.05}, Lobe{Kernel::ggx, 0.3},
              Lobe{Kernel::ggx, 1}, Lobe{Kernel::lambert, 0}}) {
            for (int size : {1, 4, 17}) {
                const PrefilterRequest request{lobe, layout, size};
                const auto results = prefilter({Layout::latlong, probe}, {&request, 1}, {});
                const Image& map = results[0].map.image;
                for (int y = 0; y < map.height; ++y) {
                    for (int x = 0; x < map.width; ++x) {
                        const bool seen =
                            texelDirection(layout, map.width, map.height, x + 0.5, y + 0.5)
                                .has_value();
                        ASSERT_NEAR(map.at(x, y)[1], seen ? 0.7f : 0, 0.7e-6)
                            << name << " " << lobe.parameter << " " << size << " at " << x << " "
                            << y;
                    }
                }
            }
        }
    }
}

/// A sun where ball maps have their rim, where the octahedral map has its corners, at the pole of
/// lat-longs and where faces meet; one a channel.
TEST(PrefilterLayouts, NarrowLobesKeepALoneSunsEnergyInEveryLayout) {
    constexpr int kHeight = 24;
    constexpr std::array<std::array<V2i, 3>, 2> kSuns{
        {{V2i(0, 12), V2i(47, 11), V2i(19, 23)}, {V2i(3, 0), V2i(18, 16), V2i(33, 8)}}};
    for (const std::array<V2i, 3>& suns : kSuns) {
        Image probe(2 * kHeight, kHeight);
        std::ranges::fill(probe.pixels, 0.0f);
        for (int c = 0; c < 3; ++c)
            probe.at(suns[c].x, suns[c].y)[c] = 1e9f;
        for (const std::string& name : layoutNames()) {
            const Layout layout = *layoutFromName(name);
            for (const auto& [roughness, size] : {std::pair{0.001, 8}, {0.06, 8}, {0.06, 1}}) {
                const PrefilterRequest request{{Kernel::ggx, roughness}, layout, size};
                const Image map =
                    prefilter({Layout::latlong, probe}, {&request, 1}, {})[0].map.image;
                double energy[3] = {0, 0, 0};
                for (int y = 0; y < map.height; ++y) {
                    for (int x = 0; x < map.width; ++x) {
                        const double area = texelSolidAngle(layout, map.width, map.height, x, y);
                        for (int c = 0; c < 3; ++c) {
                            EXPECT_GE(map.at(x, y)[c], 0);
                            energy[c] += map.at(x, y)[c] * area;
                        }
                    }
                }
                for (int c = 0; c < 3; ++c) {
                    const double total =
                        1e9 * latlongPixelSolidAngle(2 * kHeight, kHeight, suns[c].y);
                    EXPECT_NEAR(energy[c] / total, 1, isSquareMap(layout) ? 4e-4 : 1e-5)
                        << name << " " << roughness << " size " << size << " sun at " << suns[c].x
                        << " " << suns[c].y;
                }
            }
        }
    }
}

/// A request's map beside its reference.
struct Compared {
    double error; ///< relative RMSE
    double bound; ///< as told
};

Compared compareToReference(const Image& probe, const PrefilterRequest& request, double max_error) {
    PrefilterOptions options, reference;
    options.max_error = max_error;
    reference.reference = true;
    const Panorama latlong{Layout::latlong, probe};
    const PrefilterResult result = prefilter(latlong, {&request, 1}, options)[0];
    const Image& map = result.map.image;
    const Image exact = prefilter(latlong, {&request, 1}, reference)[0].map.image;
    double error = 0, norm = 0;
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const double weight = texelSolidAngle(request.layout, map.width, map.height, x, y);
            for (int c = 0; c < 3; ++c) {
                const double a = map.at(x, y)[c], b = exact.at(x, y)[c];
                error += weight * (a - b) * (a - b);
                norm += weight * b * b;
            }
        }
    }
    return {std::sqrt(error / norm), result.error_bound};
}

double errorToReference(const Image& probe, const PrefilterRequest& request, double max_error) {
    return compareToReference(probe, request, max_error).error;
}

/// Lobes that end in a step or a ring, seen from the equator and the poles, where their horizons
/// run along pixels' edges: more than a random texel's error. The reference, too, has to see the
/// step (it was off by 1e-3 in maps of three rows).
TEST(PrefilterLayouts, BoundsHoldWhereHorizonsRunAlongEdges) {
    const Image probe = test::noise(Layout::latlong, 64, 32, 5).image;
    for (const PrefilterRequest request : {PrefilterRequest{{Kernel::phong, 0}, Layout::faces, 9},
                                           {{Kernel::phong, 0}, Layout::latlong, 3},
                                           {{Kernel::phong, 0.1}, Layout::latlong, 3},
                                           {{Kernel::charlie, 0.05}, Layout::octahedral, 6},
                                           {{Kernel::charlie, 0.1}, Layout::octahedral, 6}}) {
        // Beyond what harmonics prove few texels are summed.
        for (const double asked : {1e-3, 1e-4, 1e-5}) {
            const Compared compared = compareToReference(probe, request, asked);
            EXPECT_LT(compared.bound, asked);
            EXPECT_LT(compared.error, compared.bound)
                << layoutName(request.layout) << ' ' << request.lobe.parameter << ' ' << asked;
        }
    }
}

/// The octahedral map's directions have kinks where the octahedron has edges, on the equator, say.
TEST(PrefilterLayouts, OctahedralTexelsAcrossEdgesKeepTheAskedError) {
    Image probe(96, 48);
    std::ranges::fill(probe.pixels, 0.1f);
    for (const auto& [x, y] : {std::pair{10, 23}, {37, 24}, {60, 22}})
        std::fill_n(probe.at(x, y), 3, 1e4f);
    for (const int size : {12, 25}) {
        const PrefilterRequest request{{Kernel::phong, 200}, Layout::octahedral, size};
        EXPECT_LT(errorToReference(probe, request, 1e-4), 1e-4) << size;
    }
}

/// Points in texels, those cut by a rim included, against outlines and the area filter's polygons.
TEST(PrefilterLayouts, CoarseSquareMapsAreTheReferences) {
    Image probe(96, 48);
    for (int y = 0; y < probe.height; ++y)
        for (int x = 0; x < probe.width; ++x)
            std::fill_n(probe.at(x, y), 3, y < 15 ? 40.0f + static_cast<float>(x) : 1.0f);
    for (const Layout layout : {Layout::octahedral, Layout::angular, Layout::mirrorBall}) {
        for (const int size : {1, 2, 7}) {
            const PrefilterRequest request{{Kernel::phong, 200}, layout, size};
            EXPECT_LT(errorToReference(probe, request, 2e-6), 1e-6)
                << layoutName(layout) << ' ' << size;
        }
    }
}

/// A lone sun in maps of so few texels that the lobe's horizon crosses them.
TEST(PrefilterLayouts, FewLargeTexelsUnderASunAreTheReferences) {
    for (const auto& [column, row] : {std::pair{13, 9}, {40, 16}, {63, 27}}) {
        Image probe(64, 32);
        std::ranges::fill(probe.pixels, 0.0f);
        std::ranges::fill_n(probe.at(column, row), 3, 1e9f);
        for (const Lobe lobe : {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.7}}) {
            for (const Layout layout : {Layout::faces, Layout::latlong, Layout::exrLatlong,
                                        Layout::octahedral, Layout::angular}) {
                const PrefilterRequest request{lobe, layout, 1};
                EXPECT_LT(errorToReference(probe, request, 1e-5), 4e-6)
                    << layoutName(layout) << " kernel " << int(lobe.kernel) << " sun at " << column
                    << ' ' << row;
            }
        }
        const PrefilterRequest beside{{Kernel::ggx, 0.6}, Layout::faces, 2};
        EXPECT_LT(errorToReference(probe, beside, 1e-5), 4e-6) << "sun at " << column << ' ' << row;
    }
}

} // namespace
} // namespace ibl
