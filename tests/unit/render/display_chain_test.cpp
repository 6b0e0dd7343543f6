// Lens effects, and the tone maps that look at neighbours.
#include "display_support.h"

#include "core/error.h"
#include "render/exposure.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>

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

// Wherever the light is, at whatever size, and with nothing negative or beyond it.
TEST(Effects, NoEnergyIsLostAtOddSizesAndBorders) {
    const std::pair<int, int> sizes[] = {{1, 1},   {1, 2},   {3, 5},  {17, 31},
                                         {64, 64}, {101, 1}, {99, 70}};
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
            EXPECT_NEAR(at(d, d) / axis, 1, 0.3) << name << " " << r;
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
    // Octaves l = 1 .. L of variance 4^l / 2 - 1, of equal weight, L with 4^L / 2 - 1 = 16^2.
    const double level = 0.5 * std::log2(2 * 256 + 2);
    double expected = 0;
    for (int l = 1; l <= 5; ++l) {
        expected += std::clamp(level - (l - 1), 0.0, 1.0) / level * (std::exp2(2 * l) / 2 - 1);
    }
    EXPECT_NEAR(variance / expected, 1, 0.01);
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

/// A scene of wide range: a gradient with a lamp of 1e4 and a dark corner.
Image lampScene(int width, int height) {
    Image picture(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float ripple = 1 + 0.5F * std::sin(0.7F * static_cast<float>(x + 2 * y));
            const float base = std::exp2(static_cast<float>(x) / 10) * 0.02F * ripple;
            const bool lamp = std::hypot(x - 0.6 * width, y - 0.4 * height) < 4;
            for (int c = 0; c < 3; ++c)
                picture.at(x, y)[c] = lamp ? 1e4F : base * (1 + 0.3F * static_cast<float>(c));
        }
    }
    return picture;
}

// The weights of each Gaussian, normalised, the picture going on as its mirror image.
std::vector<double> blurredExactly(const std::vector<double>& in, int n, int stride, int lines,
                                   int line_stride, double deviation) {
    std::vector<double> out(in.size());
    const int reach = static_cast<int>(6 * deviation) + 1;
    for (int line = 0; line < lines; ++line) {
        for (int i = 0; i < n; ++i) {
            double sum = 0, weights = 0;
            for (int k = -reach; k <= reach; ++k) {
                const double weight = std::exp(-0.5 * k * k / (deviation * deviation));
                int j = ((i + k) % (2 * n) + 2 * n) % (2 * n);
                if (j >= n) j = 2 * n - 1 - j;
                sum += weight * in[static_cast<std::size_t>(line * line_stride + j * stride)];
                weights += weight;
            }
            out[static_cast<std::size_t>(line * line_stride + i * stride)] = sum / weights;
        }
    }
    return out;
}

TEST(Retinex, IsItsFormulaOverTrueGaussians) {
    const int width = 120, height = 81;
    const Image picture = lampScene(width, height);
    const double k = 0.8, f = 2, eps = 0.01, narrow = 0.05, wide = 0.3;
    const int scales = 3;
    const Image seen =
        displayed(ToneMap::retinex, {k, f, eps, scales, narrow, wide}, Per::channel, picture);
    for (int c = 0; c < 3; c += 2) {
        std::vector<double> channel;
        for (int i = 0; i < width * height; ++i)
            channel.push_back(picture.pixels[static_cast<std::size_t>(3 * i + c)]);
        std::vector<double> logs(channel.size());
        double weights = 0;
        for (int n = 0; n < scales; ++n)
            weights += std::pow(scales - n, f);
        for (int n = 0; n < scales; ++n) {
            const double deviation =
                height * narrow * std::pow(wide / narrow, static_cast<double>(n) / (scales - 1));
            const auto across = blurredExactly(channel, width, 1, height, width, deviation);
            const auto both = blurredExactly(across, height, width, width, 1, deviation);
            for (std::size_t i = 0; i < logs.size(); ++i) {
                logs[i] += std::pow(scales - n, f) / weights *
                           (std::log(channel[i] + eps) - k * std::log(both[i] + eps));
            }
        }
        double worst = 0, sum = 0;
        for (std::size_t i = 0; i < logs.size(); ++i) {
            const double exact = std::exp(logs[i]);
            const double error = seen.pixels[3 * i + static_cast<std::size_t>(c)] / exact - 1;
            worst = std::max(worst, std::abs(error));
            sum += std::abs(error);
        }
        // The pyramid's Gaussians are nearly so; they differ most in the tails about the lamp.
        EXPECT_LT(worst, 0.15);
        EXPECT_LT(sum / static_cast<double>(logs.size()), 0.01);
    }
}

TEST(Retinex, FlatPicturesHaveAClosedForm) {
    for (const float x : {0.0F, 1e-3F, 0.18F, 1e4F}) {
        const Image seen = displayed(ToneMap::retinex, standardParameters(ToneMap::retinex),
                                     Per::channel, flat(33, 20, x));
        const double exact = std::pow(x + 1e-3, 0.5);
        for (const float v : seen.pixels)
            ASSERT_NEAR(v / exact, 1, 3e-5);
    }
}

// The operator in plain loops: Gaussian pyramid by 1 5 8 5 1 / 20, bilinear between samples.
struct Level {
    int width, height;
    std::vector<double> values;
    double at(int x, int y) const {
        x = std::clamp(x, 0, width - 1);
        y = std::clamp(y, 0, height - 1);
        return values[static_cast<std::size_t>(y * width + x)];
    }
};

Level nextLevel(const Level& fine, int width, int height) {
    const double w[] = {0.05, 0.25, 0.4, 0.25, 0.05};
    Level made{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (int j = 0; j < 5; ++j) {
                for (int i = 0; i < 5; ++i)
                    sum += w[i] * w[j] * fine.at(2 * x + i - 2, 2 * y + j - 2);
            }
            made.values.push_back(sum);
        }
    }
    return made;
}

TEST(ReinhardLocal, IsDodgingAndBurning) {
    const int width = 150, height = 101;
    const Image picture = lampScene(width, height);
    const double phi = 8, contrast = 0.05, key = 0.18;
    DisplayOptions options;
    options.tone_map = ToneMap::reinhardLocal;
    options.parameters = {phi, contrast};
    options.key = key;
    const Image seen = shown(options, picture);
    std::vector<Level> levels{{width, height, {}}};
    for (int i = 0; i < width * height; ++i) {
        const float* p = &picture.pixels[static_cast<std::size_t>(3 * i)];
        levels[0].values.push_back(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
    }
    for (int k = 1, w = 128, h = 128; k < 8; ++k, w /= 2, h /= 2)
        levels.push_back(nextLevel(levels.back(), w, h));
    const auto between = [&](int x, int y, int k) {
        const Level& level = levels[static_cast<std::size_t>(k)];
        const int step = 1 << k, i = x / step, j = y / step;
        const double s = static_cast<double>(x - i * step) / step;
        const double t = static_cast<double>(y - j * step) / step;
        return (1 - t) * ((1 - s) * level.at(i, j) + s * level.at(i + 1, j)) +
               t * ((1 - s) * level.at(i, j + 1) + s * level.at(i + 1, j + 1));
    };
    int wrong = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double v = between(x, y, 0);
            for (int k = 0; k < 7; ++k) {
                const double s = std::pow(43, k / 8.0), surround = between(x, y, k + 1);
                if (std::abs(v - surround) / (std::pow(2, phi) * key / (s * s) + v) > contrast)
                    break;
                v = surround;
            }
            const double exact = picture.at(x, y)[1] / (1 + v);
            wrong += std::abs(seen.at(x, y)[1] / exact - 1) > 1e-4;
        }
    }
    EXPECT_LE(wrong, 15); // a contrast within rounding of the limit may fall either way
}

// Pictures that go by tiles are the same as those that fit.
TEST(Tiles, DoNotShow) {
    const Image picture = lampScene(150, 101);
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
        const Image whole = shown(options, picture, 1);
        for (const int edge : {16, 37, 64}) {
            const Image tiled = shown(options, picture, 1, edge);
            for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
                ASSERT_NEAR(tiled.pixels[i], whole.pixels[i], 1e-6F * (1 + whole.pixels[i]))
                    << info.name << " " << edge;
            }
        }
    }
}

TEST(Exposure, LogAverageIsExact) {
    const float largest = std::numeric_limits<float>::max();
    // 2^21 pixels of 1e-3 and 1e9, a third of them bright: in logarithms 2/3 ln 1e-3 + 1/3 ln 1e9.
    Image picture(3 * 1024, 512);
    for (std::size_t i = 0; i < picture.pixels.size() / 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            picture.pixels[3 * i + c] = i % 3 == 0 ? 1e9F : 1e-3F;
    }
    const double delta = 1e-5;
    const double expected = std::exp((2 * std::log(delta + 1e-3F) + std::log(delta + 1e9)) / 3);
    const double got = takePictureCensus(picture, delta, 1).log_average;
    EXPECT_NEAR(got / expected, 1, 1e-9);
    EXPECT_EQ(takePictureCensus(picture, delta, 3).log_average, got);
    EXPECT_NEAR(takePictureCensus(flat(10, 10, largest), 1e-30, 1).log_average / largest, 1, 1e-9);
    EXPECT_NEAR(takePictureCensus(flat(10, 10, 0), 1e-30, 1).log_average / 1e-30, 1, 1e-9);
}

TEST(Exposure, BadPixelsAreCountedAndCountAsBlack) {
    Image picture = flat(4, 1, 1);
    picture.at(0, 0)[1] = std::nanf("");
    picture.at(1, 0)[2] = -std::numeric_limits<float>::infinity();
    picture.at(2, 0)[0] = -5;
    const PictureCensus census = takePictureCensus(picture, 1, 1);
    EXPECT_EQ(census.nan, 1u);
    EXPECT_EQ(census.infinite, 1u);
    EXPECT_EQ(census.negative, 1u);
    // Luminance 0, 0, 0 (negative) and 1.
    EXPECT_NEAR(census.log_average, std::pow(2, 0.25), 1e-6);
}

TEST(Exposure, AlphaWeighs) {
    Image picture(2, 1, 4);
    for (int c = 0; c < 3; ++c) {
        picture.at(0, 0)[c] = 2; // straight 4
        picture.at(1, 0)[c] = 0;
    }
    picture.at(0, 0)[3] = 0.5F;
    picture.at(1, 0)[3] = 0;
    EXPECT_NEAR(takePictureCensus(picture, 1e-6, 1).log_average, 4, 1e-4);
}

TEST(Exposure, WhatIsMissingHalvesEachHalfLife) {
    double state = 1;
    for (int frame = 0; frame < 6; ++frame)
        state = adapted(state, 16, 3); // two half-lives, four stops away
    EXPECT_NEAR(std::log2(state), 3, 1e-9);
    EXPECT_EQ(adapted(1, 16, 0), 16);
}

} // namespace
} // namespace ibl
