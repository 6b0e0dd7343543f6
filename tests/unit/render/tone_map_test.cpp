// Every tone map against its formula in double precision, on everything a float can be.
#include "display_support.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace ibl {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// 1e-8 to 1e8, 0, half's limits, and what is no colour.
std::vector<float> sweep() {
    std::vector<float> values{0,         -1e-8F,   -1,    -1e8F,     -kInfinity, kNan,
                              kInfinity, kLargest, 65504, 65520,     6.1e-5F,    6e-8F,
                              1e-30F,    1,        1e30F, 0.0031308F};
    for (int i = 0; i <= 640; ++i)
        values.push_back(static_cast<float>(std::pow(10, -8 + i / 40.0)));
    return values;
}

/// What the maps take a value for: NaN for 0, negatives for 0, what is infinite for the largest.
double taken(float v) {
    if (std::isnan(v) || v < 0) return 0;
    return std::min(static_cast<double>(v), 1e30);
}

double hable(double x) {
    return (x * (0.15 * x + 0.05) + 0.2 * 0.02) / (x * (0.15 * x + 0.5) + 0.2 * 0.3) - 0.02 / 0.3;
}

struct Curve {
    ToneMap map;
    ToneParameters parameters;
    std::function<double(double)> exact;
};

std::vector<Curve> curves() {
    std::vector<Curve> all;
    for (const double c : {0.01, 1.0, 50.0}) {
        all.push_back({ToneMap::exponential, {c}, [=](double x) { return -std::expm1(-c * x); }});
    }
    for (const auto& [n, sigma] : {std::pair(1.1, 0.72), {0.3, 100.0}, {5.0, 0.01}}) {
        all.push_back({ToneMap::scurve, {n, sigma}, [=](double x) {
                           return x > 0 ? 1 / (1 + std::pow(sigma / x, n)) : 0;
                       }});
    }
    for (const double white : {0.5, 4.0, 1e6}) {
        all.push_back({ToneMap::reinhard, {white}, [=](double x) {
                           return x * (1 + x / (white * white)) / (1 + x);
                       }});
    }
    for (const double white : {1.0, 11.2}) {
        all.push_back({ToneMap::filmic, {white}, [=](double x) {
                           // Next to 0 the two terms cancel: its tangent, f'(0) x.
                           const double tangent = (0.05 * 0.06 - 0.5 * 0.004) / (0.06 * 0.06);
                           const double f = 2 * x < 1e-7 ? 2 * x * tangent : hable(2 * x);
                           return f / hable(white);
                       }});
    }
    return all;
}

TEST(ToneMaps, CurvesAreTheirClosedFormsPerChannel) {
    const std::vector<float> values = sweep();
    for (const Curve& curve : curves()) {
        const Image shown = displayed(curve.map, curve.parameters, Per::channel, row(values));
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double exact = curve.exact(taken(values[i]));
            for (int c = 0; c < 3; ++c) {
                const double got = shown.at(static_cast<int>(i), 0)[c];
                ASSERT_NEAR(got, exact, 3e-5 * exact + 1e-36)
                    << toneMapInfo(curve.map).name << " of " << values[i];
            }
        }
    }
}

TEST(ToneMaps, CurvesAreTheirClosedFormsPerLuminance) {
    const std::vector<float> values = sweep();
    Image picture(static_cast<int>(values.size()), 1);
    for (int i = 0; i < picture.width; ++i) {
        const float v = values[static_cast<std::size_t>(i)];
        picture.at(i, 0)[0] = v;
        picture.at(i, 0)[1] = 0.5F * v;
        picture.at(i, 0)[2] = 0.125F;
    }
    for (const Curve& curve : curves()) {
        const Image shown = displayed(curve.map, curve.parameters, Per::luminance, picture);
        for (int i = 0; i < picture.width; ++i) {
            double colour[3], luminance = 0;
            const double weights[] = {0.2126, 0.7152, 0.0722};
            for (int c = 0; c < 3; ++c) {
                colour[c] = taken(picture.at(i, 0)[c]);
                luminance += weights[c] * colour[c];
            }
            const double scale = curve.exact(luminance) / luminance;
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(shown.at(i, 0)[c], colour[c] * scale, 3e-5 * colour[c] * scale + 1e-36)
                    << toneMapInfo(curve.map).name << " of " << picture.at(i, 0)[0];
            }
        }
    }
}

TEST(ToneMaps, AcesIsItsFit) {
    const double to[3][3] = {
        {0.59719, 0.35458, 0.04823}, {0.07600, 0.90834, 0.01566}, {0.02840, 0.13383, 0.83777}};
    const double from[3][3] = {{1.60475, -0.53108, -0.07367},
                               {-0.10208, 1.10813, -0.00605},
                               {-0.00327, -0.07276, 1.07602}};
    const std::vector<float> values = sweep();
    for (const float blue : {1.0F, 0.2F}) {
        Image picture = row(values);
        for (int i = 0; i < picture.width; ++i)
            picture.at(i, 0)[2] *= blue;
        const Image shown = displayed(ToneMap::aces, {}, Per::channel, picture);
        for (int i = 0; i < picture.width; ++i) {
            double curve[3];
            for (int r = 0; r < 3; ++r) {
                double v = 0;
                for (int c = 0; c < 3; ++c)
                    v += to[r][c] * taken(picture.at(i, 0)[c]);
                curve[r] = (v * (v + 0.0245786) - 0.000090537) /
                           (v * (0.983729 * v + 0.4329510) + 0.238081);
            }
            for (int r = 0; r < 3; ++r) {
                const double light =
                    from[r][0] * curve[0] + from[r][1] * curve[1] + from[r][2] * curve[2];
                ASSERT_NEAR(shown.at(i, 0)[r], std::clamp(light, 0.0, 1.0), 1e-6) << values[i];
            }
        }
    }
}

TEST(ToneMaps, NoneAndClampKeepWhatTheyKeep) {
    const std::vector<float> values = sweep();
    const Image none = displayed(ToneMap::none, {}, Per::channel, row(values));
    const Image clamped = displayed(ToneMap::clamp, {}, Per::channel, row(values));
    for (int i = 0; i < none.width; ++i) {
        const float v = values[static_cast<std::size_t>(i)];
        const float finite = std::isnan(v) ? 0 : std::clamp(v, -kLargest, kLargest);
        // Devices may flush what is below the smallest normal number.
        EXPECT_NEAR(none.at(i, 0)[0], finite, 1.2e-38) << v;
        EXPECT_NEAR(clamped.at(i, 0)[0], std::clamp(finite, 0.0F, 1.0F), 1.2e-38) << v;
    }
}

TEST(ToneMaps, MoreLightIsNeverDarker) {
    constexpr int kValues = 16384; // as wide as a texture may be
    std::vector<float> values;
    for (int i = 0; i < kValues; ++i)
        values.push_back(static_cast<float>(std::pow(10, -8 + i * 16.0 / kValues)));
    for (const ToneMapInfo& info : toneMapTable()) {
        if (info.curve.empty() && info.map != ToneMap::aces && info.map != ToneMap::clamp) continue;
        for (const Per per : {Per::channel, Per::luminance}) {
            ToneParameters parameters = standardParameters(info.map);
            const Image shown = displayed(info.map, parameters, per, row(values));
            for (int i = 1; i < kValues; ++i) {
                ASSERT_GE(shown.at(i, 0)[1], shown.at(i - 1, 0)[1])
                    << info.name << " " << values[static_cast<std::size_t>(i)];
            }
            EXPECT_GT(shown.at(kValues - 1, 0)[1], 0.99F) << info.name;
        }
    }
}

TEST(ToneMaps, ExposureIsInStopsAndStaysFinite) {
    const Image picture = row({1, 2, -3, kLargest, -kLargest});
    EXPECT_EQ(displayed(ToneMap::none, {}, Per::channel, picture, 2).at(0, 0)[0], 4);
    EXPECT_EQ(displayed(ToneMap::none, {}, Per::channel, picture, -1).at(2, 0)[0], -1.5F);
    const Image bright = displayed(ToneMap::none, {}, Per::channel, picture, 8);
    EXPECT_EQ(bright.at(3, 0)[0], kLargest);
    EXPECT_EQ(bright.at(4, 0)[0], -kLargest);
}

TEST(ToneMaps, CurvesApplyToStraightColours) {
    Image picture(3, 1, 4);
    const float alphas[] = {1, 0.25F, 0};
    for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 3; ++c)
            picture.at(i, 0)[c] = 3 * alphas[i];
        picture.at(i, 0)[3] = alphas[i];
    }
    const Image shown = displayed(ToneMap::reinhard, {1e6}, Per::channel, picture);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(shown.at(i, 0)[0], 0.75 * alphas[i], 1e-6);
        EXPECT_EQ(shown.at(i, 0)[3], alphas[i]);
    }
}

TEST(ToneMaps, TheTableIsSound) {
    for (const ToneMapInfo& info : toneMapTable()) {
        EXPECT_EQ(toneMapFromName(info.name), info.map);
        EXPECT_LE(info.parameters.size(), kToneParameters);
        for (const ToneParameter& p : info.parameters) {
            EXPECT_LE(p.least, p.standard) << p.name;
            EXPECT_GE(p.most, p.standard) << p.name;
        }
    }
    EXPECT_FALSE(toneMapFromName("magic"));
}

TEST(ToneMaps, ParametersOutOfRangeAreRefused) {
    const auto refused = [](ToneMap map, const ToneParameters& p, double exposure) {
        try {
            displayed(map, p, Per::channel, row({1}), exposure);
        } catch (const Error& error) {
            return error.code() == ExitCode::usage;
        }
        return false;
    };
    EXPECT_TRUE(refused(ToneMap::none, {}, 400));
    EXPECT_TRUE(refused(ToneMap::none, {}, std::nan("")));
    EXPECT_TRUE(refused(ToneMap::scurve, {0, 1}, 0));
    EXPECT_TRUE(refused(ToneMap::scurve, {1, std::nan("")}, 0));
    EXPECT_TRUE(refused(ToneMap::reinhard, {0}, 0));
    EXPECT_TRUE(refused(ToneMap::display, {}, 0));
    EXPECT_FALSE(refused(ToneMap::scurve, {1, 1}, 0));
}

} // namespace
} // namespace ibl
