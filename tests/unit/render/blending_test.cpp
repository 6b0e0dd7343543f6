// Surfaces of which alpha says how much there is, against the formula of compositing.
#include "lights_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ibl {
namespace {

struct Sheet {
    V3d color;
    double alpha;
};

/// Squares of 2 x 2 above one another, from y = 0 up in steps of 0.1, each two triangles and a
/// part.
Object sheets(const std::vector<Sheet>& from_below) {
    Object object;
    Mesh& mesh = object.mesh.emplace();
    for (const Sheet& sheet : from_below) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const float y = 0.025F * static_cast<float>(first);
        for (const V3f& p : {V3f(-1, y, -1), V3f(-1, y, 1), V3f(1, y, 1), V3f(1, y, -1)}) {
            mesh.positions.push_back(p);
            mesh.normals.emplace_back(0, 1, 0);
            mesh.texcoords.emplace_back(0.5F * (p.x + 1), 0.5F * (p.z + 1));
        }
        Part part{mesh.indices.size(), 6, {}};
        for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3})
            mesh.indices.push_back(first + corner);
        part.surface.base_color = sheet.color;
        part.surface.alpha = sheet.alpha;
        part.surface.alpha_cutoff = kBlended;
        object.parts.push_back(part);
    }
    return object;
}

constexpr int kSide = 48;
// The squares fill the picture and more.
const Camera kAbove{{0, 9, 0}, {0, 0, 0}, {0, 0, -1}, 10};

Scene sceneOf(Object object) {
    Scene scene;
    scene.object = std::move(object);
    scene.material.own =
        ShaderText{"own.frag", "vec3 shade(vec3 normal, vec3 incident) { return baseColor(); }\n"};
    scene.background = ColorBackground(1, 1, 1);
    return scene;
}

V3d meanOf(const Image& image) {
    V3d sum(0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            sum += pixel(image, x, y);
    }
    return sum / (image.width * image.height);
}

// A part of the samples, the same in each pixel but for what does not go into a whole one.
TEST(Blending, ASheetCoversWhatItsAlphaSaysInEveryPixel) {
    for (const double alpha : {0.0, 0.03, 0.4, 0.71, 1.0}) {
        for (const int samples : {1, 5, 16}) {
            const Scene scene = sceneOf(sheets({{V3d(0), alpha}}));
            const Image drawn =
                Renderer(softwareContext(), scene, {kSide, kSide, samples, {}}).render(kAbove);
            for (int i = 0; i < kSide * kSide; ++i) {
                const int x = i % kSide, y = i / kSide;
                if (std::abs(x - y) < 2) continue; // has samples of both triangles
                const double covered = (1 - drawn.at(x, y)[0]) * samples;
                ASSERT_GE(covered, std::floor(alpha * samples + 1e-9) - 1e-4);
                ASSERT_LE(covered, std::ceil(alpha * samples - 1e-9) + 1e-4);
            }
            // The rounding is random: of n pixels its mean's deviation is at most 1 / (2 sqrt n).
            EXPECT_NEAR(1 - meanOf(drawn).x, alpha, 4.0 / (2 * kSide * samples)) << samples;
        }
    }
}

TEST(Blending, SheetsAreCompositedInTheOrderInWhichTheyLie) {
    const Sheet low{{1, 0, 0}, 0.7}, middle{{0, 1, 0}, 0.5}, high{{0, 0, 1}, 0.25};
    const V3d expected =
        ((V3d(1) * 0.3 + low.color * 0.7) * 0.5 + middle.color * 0.5) * 0.75 + high.color * 0.25;
    Scene scene = sceneOf(sheets({low, middle, high}));
    const FrameOptions options{kSide, kSide, 16, {}};
    const V3d drawn = meanOf(Renderer(softwareContext(), scene, options).render(kAbove));
    EXPECT_LT((drawn - expected).length(), 0.01) << drawn;
    std::ranges::reverse(scene.object.parts); // drawn from the nearest on
    const V3d again = meanOf(Renderer(softwareContext(), scene, options).render(kAbove));
    EXPECT_LT((again - expected).length(), 0.01) << again;
}

// With alpha for what is behind, and in Gouraud's interpolation.
TEST(Blending, MatteAndColoursOfVertices) {
    Scene scene = sceneOf(sheets({{V3d(0.5), 0.5}, {V3d(2), 0.25}}));
    scene.background = NoBackground{};
    for (const Interpolation interpolation : {Interpolation::phong, Interpolation::gouraud}) {
        scene.interpolation = interpolation;
        const Image drawn =
            Renderer(softwareContext(), scene, {kSide, kSide, 16, {}}).render(kAbove);
        double alpha = 0;
        for (std::size_t i = 3; i < drawn.pixels.size(); i += 4)
            alpha += drawn.pixels[i] / (kSide * kSide);
        EXPECT_NEAR(alpha, 1 - 0.5 * 0.75, 0.01);
        EXPECT_NEAR(meanOf(drawn).x, 0.5 * 0.5 * 0.75 + 2 * 0.25, 0.02);
    }
}

TEST(Blending, AovsAreOfWhatIsAtLeastHalfThere) {
    const Scene scene = sceneOf(sheets({{V3d(1), 0.9}, {V3d(1), 0.5}, {V3d(1), 0.49}}));
    Renderer renderer(softwareContext(), scene, {kSide, kSide, 4, {}});
    const FrameAovs aovs = renderer.renderAovs(kAbove);
    for (const float id : aovs.id)
        ASSERT_EQ(id, 2);
}

// Alpha of a texture of its own, and premultiplied colours, which blending must not darken.
TEST(Blending, TexturesOfAlphaAndPremultipliedColours) {
    Object object = sheets({{V3d(1), 1}});
    SurfaceTexture alpha{Image(2, 1), Wrap::clamp, Wrap::clamp};
    SurfaceTexture color{Image(1, 1, 4), Wrap::clamp, Wrap::clamp, true};
    std::fill_n(alpha.image.at(0, 0), 3, 0.25F);
    std::fill_n(alpha.image.at(1, 0), 3, 1.0F);
    std::ranges::copy(std::vector<float>{0.4F, 0.2F, 0, 0.5F}, color.image.at(0, 0));
    object.textures = {alpha, color};
    object.parts[0].surface.alpha_texture = 0;
    object.parts[0].surface.base_texture = 1;
    Scene scene = sceneOf(object);
    const Image drawn = Renderer(softwareContext(), scene, {kSide, kSide, 16, {}}).render(kAbove);
    // Of the picture, whose edges are at x = -0.79 and 0.79, the outer texels' halves are even.
    const V3d own(0.8, 0.4, 0);
    V3d left(0), right(0);
    for (int y = 0; y < kSide; ++y) {
        left += pixel(drawn, 1, y) / kSide;
        right += pixel(drawn, kSide - 2, y) / kSide;
    }
    EXPECT_LT((left - (own * 0.125 + V3d(0.875))).length(), 0.02) << left;
    EXPECT_LT((right - (own * 0.5 + V3d(0.5))).length(), 0.02) << right;
}

// Two sheets above one another keep 1 - (1 - a)(1 - b) of the light, the same for one light as for
// many.
TEST(Blending, ShadowsAreOfTheLightThatIsKept) {
    for (const int count : {1, 40}) {
        Scene scene = sceneOf(sheets({{V3d(1), 0.5}, {V3d(1), 0.25}}));
        scene.placement.translate = V3d(0, 1, 0);
        scene.ground = Ground{0, V3d(0.5)};
        scene.lights.assign(static_cast<std::size_t>(count), sunlight({0, 1, 0}, V3d(1.0 / count)));
        const Camera camera{{0, 0.8, 3}, {0, 0, 0}, {0, 1, 0}, 30};
        const Image drawn = Renderer(softwareContext(), scene, {64, 64, 4, {}, 256}).render(camera);
        const CameraRays rays = cameraRays(camera, 64, 64);
        double sum = 0;
        int pixels = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const V3d d = rays.direction(x + 0.5, y + 0.5);
                if (d.y >= 0) continue;
                const V3d p = rays.eye - d * (rays.eye.y / d.y);
                if (std::abs(p.x) > 0.9 || std::abs(p.z) > 0.9) continue;
                sum += drawn.at(x, y)[0];
                ++pixels;
            }
        }
        ASSERT_GT(pixels, 400);
        const double kept = 1 - 0.5 * 0.75;
        EXPECT_NEAR(1 - sum / pixels, kept * 0.5 / std::numbers::pi, 0.01) << count;
    }
}

} // namespace
} // namespace ibl
