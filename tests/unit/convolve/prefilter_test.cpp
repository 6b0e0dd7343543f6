#include "convolve/prefilter.h"

#include "core/error.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace ibl {
namespace {

oracle::LobeFunction functionOf(const Lobe& lobe) {
    switch (lobe.kernel) {
    case Kernel::ggx:
        return oracle::ggx(lobe.parameter);
    case Kernel::phong:
        return oracle::phong(lobe.parameter);
    case Kernel::blinnPhong:
        return oracle::blinnPhong(lobe.parameter);
    case Kernel::charlie:
        return oracle::charlie(lobe.parameter);
    default:
        return oracle::lambert();
    }
}

PrefilterResult filter(const Image& probe, const Lobe& lobe, Layout layout, int size,
                       const PrefilterOptions& options = {}) {
    const PrefilterRequest request{lobe, layout, size};
    return prefilter({Layout::latlong, probe}, std::span(&request, 1), options)[0];
}

Image constant(int width, int height, float value) {
    Image probe(width, height);
    std::ranges::fill(probe.pixels, value);
    return probe;
}

/// A sky, a ground, a bright strip and noise: energy in every degree.
Image scene(int width, int height) {
    Image probe(width, height);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0.5f, 1.5f);
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const float sky = j < height / 2 ? 1.0f : 0.2f;
            const float strip = i > width / 3 && i < width / 2 && j > height / 4 && j < height / 3;
            for (int c = 0; c < 3; ++c) {
                probe.at(i, j)[c] = (sky + 5 * strip) * uniform(random) * (1 + 0.3f * float(c));
            }
        }
    }
    return probe;
}

/// The same piecewise-constant probe with its pixels divided n x n in longitude and equal steps of
/// colatitude: what the oracle, whose points go by the pixel, needs of coarse probes.
Image divided(const Image& probe, int n) {
    Image fine(probe.width * n, probe.height * n);
    for (int j = 0; j < fine.height; ++j) {
        for (int i = 0; i < fine.width; ++i)
            std::copy_n(probe.at(i / n, j / n), 3, fine.at(i, j));
    }
    return fine;
}

struct Difference {
    double rmse = 0;  ///< relative
    double worst = 0; ///< of |a - b| / max(|b|, mean |b|)
};

/// About `count` of a map's texels, evenly.
struct Sample {
    std::vector<int> texels;
    std::vector<double> weights;
    std::vector<oracle::Direction> directions;
};

Sample sampleOf(Layout layout, int size, int count) {
    const V2i extent = layoutExtent(layout, size);
    const int texels = extent.x * extent.y, step = std::max(1, texels / count) | 1;
    Sample sample;
    for (int t = 0; t < texels; t += step) {
        const int x = t % extent.x, y = t / extent.x;
        const auto d = texelDirection(layout, extent.x, extent.y, x + 0.5, y + 0.5);
        if (!d) continue;
        const V3d n = d->normalized();
        sample.directions.push_back({n.x, n.y, n.z});
        sample.texels.push_back(t);
        sample.weights.push_back(texelSolidAngle(layout, extent.x, extent.y, x, y));
    }
    return sample;
}

using Expected = std::vector<std::array<double, 3>>;

Expected expectedAt(const Sample& sample, const Image& probe, const Lobe& lobe) {
    return oracle::convolve(probe, functionOf(lobe), sample.directions, 1e-7);
}

/// A result against the oracle at some of its texels; the norms that errors are relative to are the
/// whole map's.
Difference compare(const PrefilterResult& result, const Sample& sample, const Expected& expected) {
    const Image& map = result.map.image;
    double mean = 0, norm = 0, share = 0, error = 0;
    for (int t = 0; t < map.width * map.height; ++t) {
        const int x = t % map.width, y = t / map.width;
        const double w = texelSolidAngle(result.map.layout, map.width, map.height, x, y);
        for (int c = 0; c < 3; ++c) {
            const double value = map.at(x, y)[c];
            mean += w * std::abs(value) / (12 * kPi);
            norm += w * value * value;
        }
    }
    Difference difference;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        share += sample.weights[i] / (4 * kPi);
        for (int c = 0; c < 3; ++c) {
            const double a = map.pixels[std::size_t{3} * sample.texels[i] + c], b = expected[i][c];
            error += sample.weights[i] * (a - b) * (a - b);
            difference.worst =
                std::max(difference.worst, std::abs(a - b) / std::max(std::abs(b), mean));
        }
    }
    difference.rmse = std::sqrt(error / share / norm);
    return difference;
}

Difference compare(const PrefilterResult& result, const Image& probe, const Lobe& lobe, int count) {
    const Panorama& map = result.map;
    const int size = *layoutSize(map.layout, map.image.width, map.image.height);
    const Sample sample = sampleOf(map.layout, size, count);
    return compare(result, sample, expectedAt(sample, probe, lobe));
}

const Lobe kWideLobes[] = {{Kernel::lambert, 0},     {Kernel::ggx, 0.25},   {Kernel::ggx, 0.5},
                           {Kernel::ggx, 1},         {Kernel::phong, 5},    {Kernel::phong, 100},
                           {Kernel::blinnPhong, 60}, {Kernel::charlie, 0.5}};

TEST(Prefilter, KeepsTheAskedErrorAndSaysItsOwn) {
    const Image probe = scene(48, 24);
    for (const Lobe& lobe : kWideLobes) {
        const Sample sample = sampleOf(Layout::faces, 24, 30);
        const Expected expected = expectedAt(sample, divided(probe, 2), lobe);
        for (const double asked : {1e-3, 1e-4, 1e-5}) {
            const PrefilterResult result =
                filter(probe, lobe, Layout::faces, 24, {asked, false, 0});
            const Difference d = compare(result, sample, expected);
            const std::string what = "kernel " + std::to_string(int(lobe.kernel)) + " " +
                                     std::to_string(lobe.parameter) + " asked " +
                                     std::to_string(asked);
            EXPECT_LE(d.rmse, asked) << what;
            EXPECT_LE(d.worst, 10 * asked) << what;
            EXPECT_LE(result.error_bound, asked) << what;
            EXPECT_LE(d.rmse, result.error_bound) << what;
            EXPECT_LE(d.worst, result.worst_bound.value()) << what;
            EXPECT_LE(d.rmse, 3 * result.error_estimate) << what;
            EXPECT_GE(d.rmse, result.error_estimate / 3) << what;
        }
    }
}

TEST(Prefilter, EveryLayoutLooksTheSameWay) {
    const Image probe = scene(40, 20);
    for (const Layout layout : {Layout::latlong, Layout::faces, Layout::vcross, Layout::hcross,
                                Layout::strip, Layout::vstrip}) {
        const PrefilterResult result = filter(probe, {Kernel::phong, 20}, layout, 16);
        EXPECT_LE(compare(result, probe, {Kernel::phong, 20}, 24).rmse, 1e-4) << layoutName(layout);
    }
}

TEST(Prefilter, OddSizedProbes) {
    for (const auto& [w, h] :
         {std::pair{1, 1}, {2, 1}, {3, 2}, {16, 8}, {67, 3}, {5, 31}, {101, 50}}) {
        const Image probe = scene(w, h);
        const Image fine = divided(probe, std::max(1, 48 / std::max(w, h)));
        for (const Lobe lobe : {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.5}}) {
            const PrefilterResult result = filter(probe, lobe, Layout::faces, 16);
            EXPECT_LE(compare(result, fine, lobe, 40).rmse, 1e-4) << w << "x" << h;
        }
    }
}

TEST(Prefilter, FurnaceForEveryKernelRoughnessAndSize) {
    std::vector<Lobe> lobes(std::begin(kWideLobes), std::end(kWideLobes));
    for (const double r : {0.0, 0.001, 0.01, 0.05, 0.1, 0.125})
        lobes.push_back({Kernel::ggx, r});
    for (const double n : {0.0, 1e4, 1e6}) {
        lobes.push_back({Kernel::phong, n});
        lobes.push_back({Kernel::blinnPhong, n});
    }
    for (const double r : {0.05, 0.125})
        lobes.push_back({Kernel::charlie, r});
    for (const auto& [w, h] : {std::pair{1, 1}, {7, 5}, {32, 16}}) {
        const Image probe = constant(w, h, 0.7f);
        for (const Lobe& lobe : lobes) {
            for (const int size : {1, 8}) {
                const PrefilterResult result = filter(probe, lobe, Layout::faces, size);
                for (const float value : result.map.image.pixels) {
                    ASSERT_NEAR(value / 0.7, 1, 1e-6)
                        << w << " kernel " << int(lobe.kernel) << " " << lobe.parameter;
                }
            }
        }
    }
}

TEST(Prefilter, LoneSunIsTheKernelItself) {
    // At the pole, on the seam, on the equator at a face's edge; of any brightness.
    for (const float sun : {1e9f, 65504.0f, 3e38f}) {
        for (const auto& [i, j] : {std::pair{0, 0}, {127, 20}, {48, 32}, {70, 63}}) {
            Image probe = constant(128, 64, 0);
            probe.at(i, j)[1] = sun;
            for (const Lobe lobe : {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.3}}) {
                const PrefilterResult result = filter(probe, lobe, Layout::faces, 16);
                for (std::size_t t = 0; t < result.map.image.pixels.size(); t += 3) {
                    const float* texel = &result.map.image.pixels[t];
                    EXPECT_TRUE(texel[0] == 0 && texel[1] >= 0 && texel[2] == 0);
                }
                const Difference d = compare(result, probe, lobe, 60);
                EXPECT_LE(d.rmse, 1e-4) << sun << " at " << i << " " << j;
                EXPECT_LE(d.worst, 1e-3) << sun << " at " << i << " " << j;
            }
        }
    }
}

TEST(Prefilter, ScaleOfTheSunDoesNotMatterToAnyKernel) {
    // A result in proportion to its probe, from the least sun to the largest float.
    for (const Lobe& lobe : kWideLobes) {
        for (const auto& [i, j] : {std::pair{0, 0}, {47, 10}, {6, 12}}) {
            Image probe = constant(48, 24, 0);
            const auto under = [&](float sun) {
                std::ranges::fill_n(probe.at(i, j), 3, sun);
                return filter(probe, lobe, Layout::faces, 8).map.image;
            };
            const Image unit = under(1);
            const float brightest = *std::ranges::max_element(unit.pixels);
            ASSERT_GT(brightest, 0);
            for (const float sun : {1e-30f, 65504.0f, 1e9f, std::numeric_limits<float>::max()}) {
                const Image map = under(sun);
                for (std::size_t t = 0; t < unit.pixels.size(); ++t) {
                    ASSERT_TRUE(std::isfinite(map.pixels[t]) && map.pixels[t] >= 0) << sun;
                    ASSERT_NEAR(map.pixels[t] / sun, unit.pixels[t], 1e-6 * brightest)
                        << sun << " kernel " << int(lobe.kernel);
                }
            }
        }
    }
}

TEST(Prefilter, SizesFrom1To4096) {
    const Image probe = scene(16, 8);
    const Image fine = divided(probe, 3);
    const Lobe lobe{Kernel::lambert, 0};
    for (const int size : {2, 3, 7, 31, 256}) {
        const PrefilterResult result = filter(probe, lobe, Layout::faces, size);
        EXPECT_LE(compare(result, fine, lobe, 12).rmse, 1e-4) << size;
    }
    // The layout with the fewest texels at that size.
    const PrefilterResult largest = filter(probe, lobe, Layout::octahedral, 4096);
    EXPECT_EQ(largest.map.image.width, 4096);
    EXPECT_LE(compare(largest, fine, lobe, 12).rmse, 1e-4);
}

TEST(Prefilter, DenormalsAreKept) {
    const PrefilterResult result =
        filter(constant(128, 64, 1e-40f), {Kernel::ggx, 0.3}, Layout::faces, 16);
    for (const float value : result.map.image.pixels)
        EXPECT_NEAR(value / 1e-40f, 1, 2e-5);
}

TEST(Prefilter, SunInASceneKeepsTheErrorEverywhere) {
    Image probe = scene(128, 64);
    probe.at(30, 20)[0] = probe.at(30, 20)[1] = probe.at(30, 20)[2] = 1e6f;
    for (const Lobe& lobe : kWideLobes) {
        const PrefilterResult result = filter(probe, lobe, Layout::faces, 24);
        const Difference d = compare(result, probe, lobe, 60);
        EXPECT_LE(d.rmse, 1e-4) << lobe.parameter;
        EXPECT_LE(d.worst, 1e-3) << lobe.parameter;
        EXPECT_LE(d.rmse, result.error_bound) << lobe.parameter;
        EXPECT_GE(*std::ranges::min_element(result.map.image.pixels), 0);
    }
}

/// What the error is relative to is reckoned before the work; spots of lobes smaller than a pixel
/// are no brighter than the pixel.
TEST(Prefilter, BoundIsKeptWherePixelsAreLargerThanTheLobe) {
    Image probe = constant(256, 128, 0.0f);
    for (int j = 0; j < 128; ++j)
        for (int i = j % 5; i < 256; i += 5)
            for (int c = 0; c < 3; ++c)
                probe.at(i, j)[c] = 5;
    const PrefilterResult result =
        filter(probe, {Kernel::phong, 1e5}, Layout::faces, 16, {1e-4, false, 0});
    EXPECT_LE(result.error_bound, 1e-4);
    EXPECT_GT(result.band_limit, 0);
}

/// Phong 0 has a horizon that needs a thousand peaks; a chain's larger levels are not to pay for
/// it.
TEST(Prefilter, PeaksOfOneLobeAreNotThoseOfAll) {
    Image probe = constant(256, 128, 0.0f);
    std::mt19937 random(5);
    std::uniform_int_distribution<int> place(0, 256 * 128 - 1);
    for (int k = 0; k < 90; ++k)
        for (int c = 0; c < 3; ++c)
            probe.pixels[3 * std::size_t(place(random)) + std::size_t(c)] = float(1 + k % 7);
    const PrefilterRequest requests[] = {{{Kernel::phong, 30}, Layout::faces, 32},
                                         {{Kernel::phong, 0}, Layout::faces, 8}};
    const auto together = prefilter({Layout::latlong, probe}, requests, {});
    EXPECT_LE(together[0].peaks_split, 64);
    EXPECT_GT(together[1].peaks_split, 64);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(
            together[i].map.image.pixels,
            prefilter({Layout::latlong, probe}, std::span(&requests[i], 1), {})[0].map.image.pixels)
            << i;
}

TEST(Prefilter, NegativePixelsKeepTheirEnergy) {
    Image probe = scene(64, 32);
    for (int i = 0; i < 64; i += 5)
        probe.at(i, i / 2)[1] = -4000.0f;
    const PrefilterResult result = filter(probe, {Kernel::ggx, 0.5}, Layout::faces, 16);
    EXPECT_LE(compare(result, probe, {Kernel::ggx, 0.5}, 60).rmse, 1e-4);
    EXPECT_LT(*std::ranges::min_element(result.map.image.pixels), 0);
}

TEST(Prefilter, BlackStaysBlack) {
    for (const Lobe& lobe : {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.02}}) {
        const PrefilterResult result = filter(constant(8, 4, 0), lobe, Layout::faces, 4);
        for (const float value : result.map.image.pixels)
            EXPECT_EQ(value, 0);
        EXPECT_EQ(result.error_bound, 0);
    }
}

TEST(Prefilter, SameBytesForAnyNumberOfThreads) {
    Image probe = scene(40, 20);
    probe.at(3, 3)[0] = 1e5f;
    std::vector<PrefilterRequest> requests;
    for (const double r : {0.0, 0.08, 0.25, 1.0}) {
        requests.push_back({{Kernel::ggx, r}, Layout::faces, 2});
    }
    const auto one = prefilter({Layout::latlong, probe}, requests, {1e-4, false, 1});
    const auto five = prefilter({Layout::latlong, probe}, requests, {1e-4, false, 5});
    for (std::size_t i = 0; i < requests.size(); ++i) {
        EXPECT_EQ(one[i].map.image.pixels, five[i].map.image.pixels) << i;
        EXPECT_EQ(one[i].error_estimate, five[i].error_estimate);
    }
}

TEST(Prefilter, ReferenceIsTheOracle) {
    const Image probe = scene(24, 12);
    for (const Lobe lobe : {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.4}}) {
        const PrefilterResult result =
            filter(probe, lobe, Layout::faces, 6, optionsFor(Quality::reference));
        EXPECT_LE(compare(result, divided(probe, 4), lobe, 30).rmse, 3e-7);
    }
}

TEST(Prefilter, RefusesWhatItCannotDo) {
    Image probe = constant(4, 2, 1);
    EXPECT_THROW(filter(probe, {Kernel::ggx, 1.5}, Layout::faces, 4), Error);
    EXPECT_THROW(filter(probe, {Kernel::ggx, 0.5}, Layout::faces, 0), Error);
    EXPECT_THROW(filter(probe, {Kernel::ggx, 0.5}, Layout::faces, 4, {0, false, 0}), Error);
    probe.at(1, 1)[2] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(filter(probe, {Kernel::ggx, 0.5}, Layout::faces, 4), Error);
}

} // namespace
} // namespace ibl
