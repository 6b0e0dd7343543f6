// The sphere under builtin:sky as Blender's Cycles sees it (scripts/make-references made the
// pictures): an independent path tracer, so an error in axes, Fresnel, lobe or filter shows here.
#include "cli/tool.h"

#include "image/read.h"
#include "panorama/layouts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

constexpr int kSize = 64;

/// How near to the sphere's centre a pixel's ray passes: 1 at the silhouette. The camera stands at
/// 4 radii and sees 40 degrees.
double passing(int x, int y) {
    const double half = std::tan(20 * std::acos(-1.0) / 180);
    const double t = half * std::hypot((x + 0.5) / (kSize / 2) - 1, (y + 0.5) / (kSize / 2) - 1);
    return 4 * t / std::sqrt(1 + t * t);
}

/// The unit sphere of triangles, with its normals.
void writeSphere(const std::filesystem::path& path, int columns, int rows) {
    std::ofstream file(path);
    for (int y = 0; y <= rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const V3d p =
                latlongDirection(static_cast<double>(x) / columns, static_cast<double>(y) / rows);
            for (const char* kind : {"v", "vn"})
                file << kind << ' ' << p.x << ' ' << p.y << ' ' << p.z << '\n';
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const int next = (x + 1) % columns + 1, a = y * columns, b = a + columns;
            file << 'f';
            for (const int i : {a + x + 1, a + next, b + next, b + x + 1})
                file << ' ' << i << "//" << i;
            file << '\n';
        }
    }
}

class Cycles : public testing::Test {
protected:
    Cycles() {
        const ToolResult made =
            runTool({"convert", "builtin:sky", "--to", "latlong", "--size", "128", "-o", "sky.exr"},
                    scratch_.path());
        EXPECT_EQ(made.exit_code, 0) << made.err;
    }

    /// Relative RMSE of what the tool renders against a picture of Cycles, on the sphere away from
    /// its silhouette.
    double errorOf(const std::string& reference, Words words) const {
        const Words common{"render", "--probe", "sky.exr", "--azimuth", "75",   "--elevation",
                           "15",     "--size",  "64x64",   "-o",        "o.exr"};
        words.insert(words.begin(), common.begin(), common.end());
        const ToolResult result = runTool(words, scratch_.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        const Image ours = readImage((scratch_ / "o.exr").string()).image;
        const Image theirs = readImage(testData("cycles/" + reference + ".exr")).image;
        EXPECT_EQ(theirs.width, kSize);
        double error = 0, norm = 0;
        int compared = 0;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                if (passing(x, y) > 0.95) continue;
                ++compared;
                for (int c = 0; c < 3; ++c) {
                    const double b = theirs.at(x, y)[c], d = ours.at(x, y)[c] - b;
                    error += d * d;
                    norm += b * b;
                }
            }
        }
        EXPECT_GT(compared, 1400);
        const double relative = std::sqrt(error / norm);
        std::printf("%s against Cycles: relative RMSE %.2e\n", reference.c_str(), relative);
        return relative;
    }

    const Scratch& scratch() const { return scratch_; }

private:
    Scratch scratch_;
};

TEST_F(Cycles, Mirror) {
    EXPECT_LT(errorOf("mirror", {"--samples", "2048"}), 0.01);
}

TEST_F(Cycles, Diffuse) {
    EXPECT_LT(errorOf("diffuse", {"--shader", "diffuse", "--samples", "16"}), 0.003);
}

// Cycles' Glass, which follows reflections inside until they leave.
TEST_F(Cycles, Glass) {
    EXPECT_LT(errorOf("glass", {"--shader", "glass", "--samples", "2048"}), 0.01);
}

// Meshes have one exit: the error that the manual states.
TEST_F(Cycles, GlassOfAMeshIsAsFarOffAsTheManualSays) {
    writeSphere(scratch() / "sphere.obj", 256, 128);
    EXPECT_NEAR(errorOf("glass", {"--object", "sphere.obj", "--shader", "glass"}), 0.10, 0.02);
}

TEST_F(Cycles, SampledLobeConverges) {
    for (const char* roughness : {"0.25", "0.5"}) {
        const std::string reference =
            std::string("ggx") + (roughness + 2) + (std::string(roughness) == "0.5" ? "0" : "");
        const Words lobe{"--shader", "ggx",       "--metallic", "1",         "--roughness",
                         roughness,  "--masking", "separable",  "--samples", "36"};
        const auto with = [&](const Words& more) {
            Words words = lobe;
            words.insert(words.end(), more.begin(), more.end());
            return errorOf(reference, words);
        };
        const double few = with({"--samples-specular", "128"});
        const double many = with({"--samples-specular", "2048"});
        const double split_sum = with({"--multiscatter", "off"});
        std::printf("GGX of roughness %s: split sum %.2e, 128 samples %.2e, 2048 samples %.2e\n",
                    roughness, split_sum, few, many);
        EXPECT_LT(many, 0.01);
        EXPECT_LT(many, few);
        EXPECT_LT(split_sum, 0.15);
    }
}

} // namespace
} // namespace ibl
