#include "render/defocus.h"

#include "core/error.h"
#include "display_support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ibl {
namespace {

Image distances(int width, int height, float inverse) {
    Image image(width, height, 1);
    std::fill(image.pixels.begin(), image.pixels.end(), inverse);
    return image;
}

Image blurred(Image picture, const Image& inverse, const Lens& lens, double pixels_per_tangent) {
    defocus(softwareContext(), picture, inverse, lens, pixels_per_tangent);
    return picture;
}

TEST(Defocus, RadiusIsThatOfAThinLens) {
    // In the plane in focus, and infinitely far.
    EXPECT_EQ(blurRadius({0.2, 4}, 0.25, 500), 0);
    EXPECT_NEAR(blurRadius({0.2, 4}, 0, 500), 0.1 / 4 * 500, 1e-12);
    // A point at 2 with the focus at 4: the cone from the lens of 0.2 is 0.2 wide again at 4.
    EXPECT_NEAR(blurRadius({0.2, 4}, 0.5, 500), 0.1 / 4 * 500, 1e-12);
}

TEST(Defocus, WhatIsInFocusStaysAsItIs) {
    Image picture = flat(31, 17, 0.5f);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        picture.pixels[i] = static_cast<float>(i % 7);
    EXPECT_EQ(blurred(picture, distances(31, 17, 0.25f), {0.5, 4}, 100).pixels, picture.pixels);
}

TEST(Defocus, APointBecomesADiscOfTheSameLight) {
    // Radius 5.5; in the middle, at a border and in a corner, where the disc folds back.
    for (const auto& [x, y] : {std::pair{20, 15}, {0, 15}, {40, 0}}) {
        Image picture = flat(41, 31, 0);
        std::fill_n(picture.at(x, y), 3, 1e9f);
        const Image made = blurred(picture, distances(41, 31, 0), {0.44, 4}, 100);
        EXPECT_NEAR(total(made) / 3e9, 1, 1e-5) << x << " " << y;
        if (x != 20) continue;
        const double inside = 1e9 / (3.14159265 * 5.5 * 5.5);
        for (int j = 0; j < 31; ++j) {
            for (int i = 0; i < 41; ++i) {
                const double distance = std::hypot(i - x, j - y);
                if (distance < 5) {
                    EXPECT_NEAR(made.at(i, j)[0] / inside, 1, 0.03);
                } else if (distance > 6) {
                    EXPECT_EQ(made.at(i, j)[0], 0);
                }
            }
        }
    }
}

TEST(Defocus, DiscsLargerThanThePictureKeepTheirLight) {
    Image picture = flat(6, 4, 0);
    std::fill_n(picture.at(1, 3), 3, 2.0f);
    EXPECT_NEAR(total(blurred(picture, distances(6, 4, 0), {0.8, 4}, 100)) / 6, 1, 1e-5);
}

TEST(Defocus, UniformPicturesStayUniformAtAnyDistance) {
    Image inverse = distances(40, 30, 0);
    for (std::size_t i = 0; i < inverse.pixels.size(); ++i)
        inverse.pixels[i] = 0.1f * static_cast<float>(i * 2654435761u % 8);
    for (const float v : blurred(flat(40, 30, 0.7f), inverse, {0.3, 4}, 100).pixels)
        EXPECT_NEAR(v, 0.7f, 2e-6f);
}

TEST(Defocus, WhatLiesBehindDoesNotCoverWhatIsSharp) {
    // Left half: a dark object in focus. Right half: the bright distance.
    Image picture = flat(40, 20, 0), inverse = distances(40, 20, 0.25f);
    for (int y = 0; y < 20; ++y) {
        for (int x = 20; x < 40; ++x) {
            std::fill_n(picture.at(x, y), 3, 1e4f);
            inverse.at(x, y)[0] = 0;
        }
    }
    const Image made = blurred(picture, inverse, {0.4, 4}, 100);
    for (int x = 0; x < 20; ++x)
        EXPECT_EQ(made.at(x, 10)[0], 0) << x;
    // In front of it, an object out of focus does cover what is sharp.
    for (float& v : inverse.pixels)
        v = v == 0 ? 1 : 0.25f;
    EXPECT_GT(blurred(picture, inverse, {0.2, 4}, 100).at(17, 10)[0], 100);
}

TEST(Defocus, Refusals) {
    Image picture = flat(8, 8, 1);
    const Image far = distances(8, 8, 0);
    for (const Lens& lens : {Lens{-1, 4}, Lens{0.1, 0}, Lens{NAN, 4}, Lens{100, 0.01}}) {
        EXPECT_THROW(defocus(softwareContext(), picture, far, lens, 1000), Error);
    }
}

} // namespace
} // namespace ibl
