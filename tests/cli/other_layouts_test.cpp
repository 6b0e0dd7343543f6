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

/// The irradiance over pi that `layout`'s own texels give, at the texels of a lat-long of `rows`:
/// the sum over parts^2 points in each.
std::vector<double> litByTexels(const Image& probe, Layout layout, int rows, int parts) {
    std::vector<V3d> normals;
    for (int t = 0; t < 2 * rows * rows; ++t) {
        normals.push_back(
            latlongDirection((t % (2 * rows) + 0.5) / (2 * rows), (t / (2 * rows) + 0.5) / rows));
    }
    std::vector<double> sums(normals.size(), 0.0);
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
            const double scale = probe.at(x, y)[0] / whole / kPi *
                                 texelSolidAngle(layout, probe.width, probe.height, x, y);
            for (std::size_t t = 0; t < sums.size(); ++t) {
                for (std::size_t part = 0; part < directions.size(); ++part) {
                    sums[t] +=
                        scale * weights[part] * std::max(0.0, normals[t].dot(directions[part]));
                }
            }
        }
    }
    return sums;
}

/// And it is lit as by its own texels, not by those of a lat-long as coarse: to the error that the
/// quality promises, which the report's bound holds.
TEST(Diffuse, OfOtherLayoutsIsTheSumOverTheirTexels) {
    const Scratch scratch;
    constexpr int kRows = 6;
    for (const auto& [name, layout] : {std::pair<std::string, Layout>{"vstrip", Layout::vstrip},
                                       {"octahedral", Layout::octahedral}}) {
        ASSERT_EQ(runTool({"convert", "builtin:sky", "--to", name, "--size", "16", "-o", "p.exr",
                           "--type", "float"},
                          scratch.path())
                      .exit_code,
                  0);
        const Image probe = readImage((scratch / "p.exr").string()).image;
        // What points leave falls with the square of their number along a side.
        std::vector<double> exact = litByTexels(probe, layout, kRows, 32);
        const std::vector<double> coarse = litByTexels(probe, layout, kRows, 16);
        for (std::size_t t = 0; t < exact.size(); ++t)
            exact[t] += (exact[t] - coarse[t]) / 3;
        for (const auto& [quality, most] :
             {std::pair<std::string, double>{"draft", 1e-3}, {"standard", 1e-4}, {"high", 1e-5}}) {
            ASSERT_EQ(runTool({"diffuse", "p.exr", "--from", name, "--to", "latlong", "--size", "6",
                               "--quality", quality, "--report", "r.json", "-o", "d.exr"},
                              scratch.path())
                          .exit_code,
                      0);
            const Image map = readImage((scratch / "d.exr").string()).image;
            const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
            double error = 0, size = 0;
            for (std::size_t t = 0; t < exact.size(); ++t) {
                const int i = static_cast<int>(t);
                error += std::pow(map.at(i % (2 * kRows), i / (2 * kRows))[0] - exact[t], 2);
                size += exact[t] * exact[t];
            }
            const double relative = std::sqrt(error / size);
            EXPECT_LT(relative, most) << name << " " << quality;
            EXPECT_LT(relative, report.at("results").at("maps")[0].at("error_bound"))
                << name << " " << quality;
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
