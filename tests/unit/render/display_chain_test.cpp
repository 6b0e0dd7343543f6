// Lens effects: bloom, glare, streaks, vignette; and pictures that go by tiles.
#include "display_support.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>

namespace ibl {
namespace {

using Set = std::function<void(DisplayOptions&, double)>;
const std::array<std::pair<const char*, Set>, 2> kSpreads{{
    {"bloom", [](DisplayOptions& o, double w) { o.bloom = w; }},
    {"glare", [](DisplayOptions& o, double w) { o.glare = w; }},
}};

DisplayOptions spreading(const Set& set, double weight) {
    DisplayOptions options;
    options.threshold = 0;
    set(options, weight);
    return options;
}

Image lonePixel(int width, int height, int x, int y, float value) {
    Image picture = flat(width, height, 0);
    for (int c = 0; c < 3; ++c)
        picture.at(x, y)[c] = value;
    return picture;
}

/// Deviation in pixels and weight of bloom's Gaussians: octaves l = 1, 2 ... of variance 3/2 4^l -
/// 1/2, as much of each, up to `widest`, the last in part.
std::vector<std::pair<double, double>> bloomOctaves(double widest) {
    const double level = 0.5 * std::log2((widest * widest + 0.5) / 1.5);
    std::vector<std::pair<double, double>> octaves;
    for (int l = 1; l < level + 1; ++l) {
        octaves.emplace_back(std::sqrt(1.5 * std::exp2(2 * l) - 0.5),
                             std::min(1.0, level - (l - 1)) / level);
    }
    return octaves;
}

/// The green channel of a picture all of whose bright part blooms, in double precision.
std::vector<double> bloomedExactly(const Image& picture, const DisplayOptions& options) {
    std::vector<double> seen, bright;
    for (std::size_t i = 0; i < picture.pixels.size(); i += 3) {
        const float* p = &picture.pixels[i];
        const double luminance = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        const double t = std::clamp(luminance / options.threshold - 0.5, 0.0, 1.0);
        const double share = options.threshold > 0 ? t * t * (3 - 2 * t) : 1;
        bright.push_back(share * p[1]);
        seen.push_back(p[1] - bright.back());
    }
    for (const auto& [deviation, weight] : bloomOctaves(options.bloom_radius * picture.height)) {
        const auto blurred = blurredExactly(bright, picture.width, picture.height, deviation);
        for (std::size_t i = 0; i < seen.size(); ++i)
            seen[i] += weight * blurred[i];
    }
    return seen;
}

// Wherever the light is, at whatever size, and with nothing negative or beyond it.
TEST(Effects, NoEnergyIsLostAtOddSizesAndBorders) {
    const std::pair<int, int> sizes[] = {{1, 1},   {1, 2},   {3, 5},   {17, 31},
                                         {64, 64}, {101, 1}, {99, 70}, {100, 60}};
    for (const auto& [name, set] : kSpreads) {
        for (const auto& [width, height] : sizes) {
            for (const auto& [x, y] : {std::pair(0, 0),
                                       {width - 1, height - 1},
                                       {width / 2, height / 3},
                                       {width - 1, 0}}) {
                DisplayOptions options = spreading(set, 0.75);
                options.bloom_radius = 0.5;
                const Image picture = lonePixel(width, height, x, y, 1e9F);
                const Image seen = shown(options, picture);
                EXPECT_NEAR(total(seen) / total(picture), 1, 2e-6)
                    << name << " " << width << "x" << height << " " << x << "," << y;
                for (const float v : seen.pixels)
                    ASSERT_TRUE(v >= 0 && v <= 1e9F) << name << " " << v;
            }
        }
    }
}

TEST(Effects, FlatPicturesStayFlat) {
    for (const auto& [name, set] : kSpreads) {
        for (const auto& [width, height] : {std::pair(1, 1), {7, 3}, {65, 33}, {128, 64}}) {
            for (const float v : shown(spreading(set, 1), flat(width, height, 2)).pixels)
                ASSERT_NEAR(v, 2, 1e-5) << name << " " << width << "x" << height;
        }
    }
}

// A lamp's halo is round and falls off: no square, no ring, no hole.
TEST(Effects, HalosAreRoundAndFallOff) {
    for (const auto& [name, set] : kSpreads) {
        const int size = 257, middle = 128;
        DisplayOptions options = spreading(set, 1);
        options.bloom_radius = 0.1;
        const Image seen = shown(options, lonePixel(size, size, middle, middle, 1000));
        // The mean of all four quarters: a halo's middle may be half a pixel off.
        const auto at = [&](int x, int y) {
            return 0.25F *
                   (seen.at(middle + x, middle + y)[0] + seen.at(middle - y, middle + x)[0] +
                    seen.at(middle - x, middle - y)[0] + seen.at(middle + y, middle - x)[0]);
        };
        for (int r = 1; r <= 90; ++r) {
            EXPECT_LE(at(r, 0), at(r - 1, 0) * 1.001F) << name << " " << r;
        }
        for (int r = 8; r <= 40; ++r) { // nor does it end at an edge
            EXPECT_GT(at(r, 0), at(r - 1, 0) * 0.7F) << name << " " << r;
            EXPECT_GT(at(r, r), at(r - 1, r - 1) * 0.7F) << name << " " << r;
        }
        for (const int r : {10, 15, 20, 30, 40}) {
            // At the diagonal's own distance, between the axis's neighbours.
            const int d = static_cast<int>(std::lround(r / std::sqrt(2.0)));
            const double distance = d * std::sqrt(2.0);
            const int low = static_cast<int>(distance);
            const double axis = at(low, 0) + (distance - low) * (at(low + 1, 0) - at(low, 0));
            EXPECT_NEAR(at(d, d) / axis, 1, 0.08) << name << " " << r;
        }
    }
}

// The deviation that is asked for is the widest octave's; the halo of all octaves is narrower.
TEST(Effects, BloomIsAsWideAsAsked) {
    const int size = 512, middle = 255;
    DisplayOptions options = spreading(kSpreads[0].second, 1);
    options.bloom_radius = 16.0 / size;
    const Image seen = shown(options, lonePixel(size, size, middle, middle, 1));
    double variance = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x)
            variance += seen.at(x, y)[0] * (x - middle) * (x - middle);
    }
    double expected = 0;
    for (const auto& [deviation, weight] : bloomOctaves(16))
        expected += weight * deviation * deviation;
    EXPECT_NEAR(variance / expected, 1, 0.01);
}

// Against the sum of true Gaussians in double precision: lone pixels, whose halo is the kernel
// itself, at places that fall differently onto the pyramid's grids and beside borders; and a scene.
TEST(Effects, BloomIsASumOfGaussians) {
    const auto expectNear = [](const Image& picture, double radius, double threshold, double rmse,
                               double worst) {
        DisplayOptions options;
        options.bloom = 1;
        options.bloom_radius = radius;
        options.threshold = threshold;
        const Image seen = shown(options, picture);
        const std::vector<double> exact = bloomedExactly(picture, options);
        const double most = *std::max_element(exact.begin(), exact.end());
        double error = 0, square = 0, furthest = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            const double difference = seen.pixels[3 * i + 1] - exact[i];
            error += difference * difference;
            square += exact[i] * exact[i];
            furthest = std::max(furthest, std::abs(difference) / (exact[i] + 0.01 * most));
        }
        const auto [w, h] = std::pair(picture.width, picture.height);
        EXPECT_LT(std::sqrt(error / square), rmse) << w << "x" << h;
        EXPECT_LT(furthest, worst) << w << "x" << h;
    };
    for (const auto& [width, height] : {std::pair(160, 120), {161, 121}, {127, 96}}) {
        for (const auto& [x, y] : {std::pair(80, 60), {81, 60}, {83, 61}, {3, 90}, {0, 0}}) {
            for (const double radius : {0.05, 0.2})
                expectNear(lonePixel(width, height, x, y, 1000), radius, 0, 0.06, 0.2);
        }
    }
    expectNear(lampScene(150, 101), 0.1, 2, 0.015, 0.08);
}

// A kernel that ends at the edges of a square shows them about a sun: in black, what falls to 1e-9
// of the sun is still seen.
TEST(Effects, BloomOfASunIsRoundDownToTheDark) {
    const int size = 301, middle = 150;
    for (const double radius : {0.02, 0.04}) {
        DisplayOptions options = spreading(kSpreads[0].second, 0.5);
        options.bloom_radius = radius;
        const Image seen = shown(options, lonePixel(size, size, middle, middle, 1e9F));
        const auto reach = [&](int x, int y) { // pixels until it is below 1
            int k = 0;
            while (middle + k < size && seen.at(middle + k * x, middle + k * y)[1] > 1)
                ++k;
            return k * std::hypot(x, y);
        };
        for (const auto& [x, y] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}})
            EXPECT_NEAR(reach(x, y) / reach(1, 1), 1, 0.12) << x << " " << y << " " << radius;
    }
}

TEST(Effects, EachMixesLinearlyWithItsWeight) {
    Image picture = noiseProbe(Layout::latlong, 70, 41).image;
    for (int c = 0; c < 3; ++c)
        picture.at(30, 20)[c] = 500;
    const std::array<Set, 4> sets{kSpreads[0].second, kSpreads[1].second,
                                  [](DisplayOptions& o, double w) { o.streaks = w; },
                                  [](DisplayOptions& o, double w) { o.vignette = w; }};
    for (const Set& set : sets) {
        DisplayOptions options;
        const Image none = shown(options, picture);
        EXPECT_TRUE(none.pixels == picture.pixels);
        set(options, 1);
        const Image all = shown(options, picture);
        set(options, 0.3);
        const Image some = shown(options, picture);
        for (std::size_t i = 0; i < some.pixels.size(); ++i) {
            const float expected = 0.7F * none.pixels[i] + 0.3F * all.pixels[i];
            ASSERT_NEAR(some.pixels[i], expected, 1e-5F * (1 + none.pixels[i] + all.pixels[i]));
        }
    }
}

TEST(Effects, OnlyBrightPartsBloomAndStreak) {
    DisplayOptions options;
    options.bloom = 0.5;
    options.streaks = 0.5;
    options.threshold = 2;
    const Image dim = flat(40, 30, 0.99F); // half the threshold, less a little
    EXPECT_TRUE(shown(options, dim).pixels == dim.pixels);
    const Image lamp = shown(options, lonePixel(40, 30, 20, 15, 100));
    EXPECT_LT(lamp.at(20, 15)[0], 30);
    EXPECT_GT(lamp.at(24, 15)[0], 0.01F);
}

TEST(Effects, StreaksGoWhereTheyAreSentAndKeepTheirLight) {
    DisplayOptions options;
    options.streaks = 1;
    options.streak_count = 1;
    options.streak_angle = 90; // up
    options.streak_length = 0.2;
    const Image seen = shown(options, lonePixel(101, 201, 50, 150, 1e6F));
    EXPECT_NEAR(total(seen) / 3e6, 1, 2e-3); // what is left after the length runs on
    EXPECT_GT(seen.at(50, 120)[0], 1e3F);
    EXPECT_LT(seen.at(50, 170)[0], 1);
    EXPECT_LT(seen.at(70, 150)[0], 1);
    for (int y = 146; y > 115; --y)
        EXPECT_LE(seen.at(50, y - 1)[0], seen.at(50, y)[0] * 1.01F) << y;
}

TEST(Effects, VignetteIsCos4) {
    DisplayOptions options;
    options.vignette = 1;
    const Image seen = shown(options, flat(300, 200, 1));
    EXPECT_NEAR(seen.at(150, 100)[0], 1, 1e-4);
    EXPECT_NEAR(seen.at(0, 0)[0], 0.25, 0.01);
    EXPECT_NEAR(seen.at(299, 199)[0], 0.25, 0.01);
}

TEST(Effects, WhatCannotBeIsRefused) {
    const auto code = [](const Set& set, int channels) {
        DisplayOptions options;
        set(options, 0);
        Image picture(2, 2, channels);
        for (float& v : picture.pixels)
            v = 1;
        try {
            shown(options, picture);
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::done;
    };
    using O = DisplayOptions;
    EXPECT_EQ(code([](O& o, double) { o.bloom = 1.5; }, 3), ExitCode::usage);
    EXPECT_EQ(code([](O& o, double) { o.glare = std::nan(""); }, 3), ExitCode::usage);
    EXPECT_EQ(code([](O& o, double) { o.bloom = o.streaks = 0.6; }, 3), ExitCode::usage);
    EXPECT_EQ(code([](O& o, double) { o.bloom = 0.5; }, 4), ExitCode::usage);
    EXPECT_EQ(code([](O& o, double) { o.vignette = 0.5; }, 4), ExitCode::done);
}

// Pictures that go by tiles are the same as those that fit.
TEST(Tiles, DoNotShow) {
    const Image wide = lampScene(150, 101), high = lampScene(100, 151);
    for (const ToneMapInfo& info : toneMapTable()) {
        if (info.map == ToneMap::display) continue;
        DisplayOptions options;
        options.tone_map = info.map;
        options.per = info.per;
        options.parameters = standardParameters(info.map);
        options.bloom = 0.3;
        options.streaks = 0.2;
        options.glare = 0.1;
        options.vignette = 0.5;
        for (const auto& [picture, edge] :
             {std::pair(&wide, 16), {&wide, 37}, {&wide, 64}, {&wide, 120}, {&high, 120}}) {
            const Image whole = shown(options, *picture, 1);
            const Image tiled = shown(options, *picture, 1, edge);
            for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
                ASSERT_NEAR(tiled.pixels[i], whole.pixels[i], 1e-6F * (1 + whole.pixels[i]))
                    << info.name << " " << edge;
            }
        }
    }
}

} // namespace
} // namespace ibl
