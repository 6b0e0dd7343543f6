// Convolutions of probes in other layouts than lat-longs.
#include "cli/tool.h"

#include "image/read.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

/// A pixel is an area in every layout: however coarse the probe, its convolution has its energy.
TEST(Diffuse, KeepsTheEnergyOfACoarseProbeInAnyLayout) {
    const Scratch scratch;
    const auto energy = [&](const std::string& name, const std::string& layout) {
        const ToolResult told = runTool({"info", "--json", "--from", layout, name}, scratch.path());
        return nlohmann::json::parse(told.out).at("energy")[0].get<double>();
    };
    for (const std::string layout :
         {"vcross", "octahedral", "angular", "mirrorball", "exr-latlong", "exr-cube"}) {
        for (const char* size : {"3", "16"}) {
            ASSERT_EQ(
                runTool({"convert", "builtin:sky", "--to", layout, "--size", size, "-o", "p.exr"},
                        scratch.path())
                    .exit_code,
                0);
            const ToolResult made = runTool({"diffuse", "p.exr", "--from", layout, "--to",
                                             "latlong", "--size", "32", "-o", "d.exr"},
                                            scratch.path());
            ASSERT_EQ(made.exit_code, 0) << made.err;
            EXPECT_NEAR(energy("d.exr", "latlong") / energy("p.exr", layout), 1, 2e-3)
                << layout << " " << size;
        }
    }
}

/// A lobe cos^exponent, which at 1 is Lambert's, and the texels of a lat-long of `rows` that are
/// looked at: each `step`th.
struct Case {
    Words words;
    double exponent;
    int rows;
    int step;
};

/// The means over the lobe that `layout`'s own texels give: the sum over parts^2 points in each.
std::vector<double> litByTexels(const Image& probe, Layout layout, const Case& c, int parts) {
    std::vector<V3d> axes;
    for (int t = 0; t < 2 * c.rows * c.rows; t += c.step) {
        axes.push_back(latlongDirection((t % (2 * c.rows) + 0.5) / (2 * c.rows),
                                        (t / (2 * c.rows) + 0.5) / c.rows));
    }
    const double least = std::exp(-25 / c.exponent); // below, the lobe is 1e-11
    std::vector<double> sums(axes.size(), 0.0);
    for (int y = 0; y < probe.height; ++y) {
        for (int x = 0; x < probe.width; ++x) {
            std::vector<V3d> directions;
            std::vector<double> weights;
            double whole = 0;
            for (int part = 0; part < parts * parts; ++part) {
                directions.push_back(*texelDirection(layout, probe.width, probe.height,
                                                     x + (part % parts + 0.5) / parts,
                                                     y + (part / parts + 0.5) / parts));
                weights.push_back(solidAngleDensity(layout, directions.back()));
                whole += weights.back();
            }
            const double scale = probe.at(x, y)[0] / whole * (c.exponent + 1) / (2 * kPi) *
                                 texelSolidAngle(layout, probe.width, probe.height, x, y);
            for (std::size_t t = 0; t < sums.size(); ++t) {
                for (std::size_t part = 0; part < directions.size(); ++part) {
                    const double cosine = axes[t].dot(directions[part]);
                    if (cosine > least)
                        sums[t] += scale * weights[part] * std::pow(cosine, c.exponent);
                }
            }
        }
    }
    return sums;
}

/// And it is lit as by its own texels, not by those of a lat-long as coarse: to the error that the
/// quality promises, which the report's bound holds. So are lobes that see the texels' edges.
TEST(Convolutions, OfOtherLayoutsAreTheSumOverTheirTexels) {
    const Scratch scratch;
    const Case cases[] = {
        {{"diffuse"}, 1, 6, 1},
        {{"specular", "--kernel", "phong", "--exponent", "100"}, 100, 96, 331},
        {{"specular", "--kernel", "phong", "--exponent", "3000"}, 3000, 200, 2503}};
    for (const auto& [name, layout] : {std::pair<std::string, Layout>{"vstrip", Layout::vstrip},
                                       {"octahedral", Layout::octahedral}}) {
        ASSERT_EQ(runTool({"convert", "builtin:sky", "--to", name, "--size", "16", "-o", "p.exr",
                           "--type", "float"},
                          scratch.path())
                      .exit_code,
                  0);
        const Image probe = readImage((scratch / "p.exr").string()).image;
        for (const Case& c : cases) {
            // What points leave falls with the square of their number along a side.
            const int parts = c.exponent > 1000 ? 96 : 32;
            std::vector<double> exact = litByTexels(probe, layout, c, parts);
            const std::vector<double> coarse = litByTexels(probe, layout, c, parts / 2);
            for (std::size_t t = 0; t < exact.size(); ++t)
                exact[t] += (exact[t] - coarse[t]) / 3;
            for (const auto& [quality, most] : {std::pair<std::string, double>{"draft", 1e-3},
                                                {"standard", 1e-4},
                                                {"high", 1e-5}}) {
                Words words = c.words;
                for (const std::string& word :
                     {std::string("p.exr"), std::string("--from"), name, std::string("--to"),
                      std::string("latlong"), std::string("--size"), std::to_string(c.rows),
                      std::string("--quality"), quality, std::string("--report"),
                      std::string("r.json"), std::string("--type"), std::string("float"),
                      std::string("-o"), std::string("d.exr")})
                    words.push_back(word);
                ASSERT_EQ(runTool(words, scratch.path()).exit_code, 0);
                const Image map = readImage((scratch / "d.exr").string()).image;
                const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
                double error = 0, size = 0;
                for (std::size_t k = 0; k < exact.size(); ++k) {
                    const int t = static_cast<int>(k) * c.step;
                    const float* texel = map.at(t % (2 * c.rows), t / (2 * c.rows));
                    error += std::pow(texel[0] - exact[k], 2);
                    size += exact[k] * exact[k];
                }
                const double relative = std::sqrt(error / size);
                EXPECT_LT(relative, most) << name << " " << c.words[0] << " " << quality;
                EXPECT_LT(relative, report.at("results").at("maps")[0].at("error_bound"))
                    << name << " " << c.words[0] << " " << quality;
            }
        }
    }
}

/// A mirror's map is the probe, whatever the others are convolved from.
TEST(Specular, RoughnessZeroOfFacesIsTheirTexels) {
    const Scratch scratch;
    for (const Words& words :
         {Words{"convert", "builtin:sky", "--to", "vcross", "--size", "12", "-o", "p.exr"},
          Words{"specular", "p.exr", "--roughness", "0", "--to", "vcross", "--size", "12", "-o",
                "s.exr"},
          Words{"specular", "p.exr", "--levels", "3", "--to", "vcross", "--size", "12", "-o",
                "c.exr"}}) {
        ASSERT_EQ(runTool(words, scratch.path()).exit_code, 0) << words[0];
    }
    const auto probe = readImage((scratch / "p.exr").string()).image.pixels;
    EXPECT_EQ(readImage((scratch / "s.exr").string()).image.pixels, probe);
    EXPECT_EQ(readImage((scratch / "c_m0.exr").string()).image.pixels, probe);
}

} // namespace
} // namespace ibl
