// The log-average and how an eye adapts to it.
#include "display_support.h"

#include "render/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ibl {
namespace {

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
    picture.at(1, 0)[3] = 0.5F; // a shadow on the ground of another picture
    EXPECT_NEAR(takePictureCensus(picture, 1e-6, 1).log_average, 4, 1e-4);
    picture.at(1, 0)[3] = 1; // black paint
    EXPECT_LT(takePictureCensus(picture, 1e-6, 1).log_average, 1e-2);
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
