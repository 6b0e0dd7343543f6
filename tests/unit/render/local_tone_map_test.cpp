// The tone maps that look at neighbours, against plain loops in double precision.
#include "display_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ibl {
namespace {

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
            const auto both = blurredExactly(channel, width, height, deviation);
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
        EXPECT_LT(worst, 0.06);
        EXPECT_LT(sum / static_cast<double>(logs.size()), 0.005);
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

// The operator in plain loops: Gaussian pyramid by 1 5 8 5 1 / 20, bilinear between samples, over a
// picture whose border goes on as far as anything is read.
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
    const int margin = 512, edge = 1280; // multiples of 128
    std::vector<Level> levels{{edge, edge, {}}};
    for (int y = 0; y < edge; ++y) {
        for (int x = 0; x < edge; ++x) {
            const float* p = picture.at(std::clamp(x - margin, 0, width - 1),
                                        std::clamp(y - margin, 0, height - 1));
            levels[0].values.push_back(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
        }
    }
    for (int k = 1; k < 8; ++k)
        levels.push_back(nextLevel(levels.back(), edge >> k, edge >> k));
    const auto between = [&](int x, int y, int k) {
        x += margin;
        y += margin;
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

} // namespace
} // namespace ibl
