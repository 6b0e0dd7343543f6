#include "cli/tool.h"

#include "image/read.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

TEST(Brdf, TermsAndClothGoIntoTheirChannels) {
    const Scratch scratch;
    for (const Words& words : {Words{"brdf", "-o", "p.exr", "--report", "p.json"},
                               Words{"brdf", "-o", "m.exr", "--size", "64", "--terms",
                                     "multiscatter", "--cloth", "--report", "m.json"}}) {
        const ToolResult result = runTool(words, scratch.path());
        ASSERT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(result.err, "");
    }
    const Image plain = readImage((scratch / "p.exr").string()).image;
    ASSERT_EQ(plain.width, 128);
    ASSERT_EQ(plain.height, 128);
    // The smoothest row: scale + bias is 1, the bias (1 - n.v)^5.
    const double n_dot_v = 64.5 / 128;
    EXPECT_NEAR(plain.at(64, 0)[0] + plain.at(64, 0)[1], 1, 1e-4);
    EXPECT_NEAR(plain.at(64, 0)[1], std::pow(1 - n_dot_v, 5), 1e-4);
    EXPECT_LT(plain.at(64, 127)[0], 0.6); // rough, and some light is lost
    EXPECT_EQ(plain.at(64, 64)[2], 0);

    const Image scattered = readImage((scratch / "m.exr").string()).image;
    ASSERT_EQ(scattered.width, 64);
    EXPECT_NEAR(scattered.at(32, 0)[1], 1, 1e-4);
    EXPECT_GT(scattered.at(32, 60)[2], 0.1);
    const auto report = nlohmann::json::parse(readFile(scratch / "m.json")).at("results");
    EXPECT_EQ(report.at("channels"), nlohmann::json({"bias", "total", "cloth"}));
    EXPECT_LT(report.at("error_estimate").get<double>(), 1e-5);
}

TEST(Brdf, SameBytesForAnyNumberOfThreads) {
    const Scratch scratch;
    for (const char* threads : {"1", "5"}) {
        ASSERT_EQ(runTool({"brdf", "--cloth", "--size", "24", "--threads", threads, "-o",
                           std::string("t") + threads + ".exr"},
                          scratch.path())
                      .exit_code,
                  0);
    }
    EXPECT_TRUE(readFile(scratch / "t1.exr") == readFile(scratch / "t5.exr"));
}

TEST(Brdf, Refusals) {
    const Scratch scratch;
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), "brdf");
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({}, 1, "--output");
    refused({"-o", "t.exr", "--size", "0"}, 1, "--size");
    refused({"-o", "t.exr", "--size", "5000"}, 1, "--size");
    refused({"-o", "t.exr", "--terms", "both"}, 1, "--terms");
    refused({"-o", "t.exr", "--kernel", "ggx"}, 1, "--kernel");
    refused({"builtin:sky", "-o", "t.exr"}, 1, "builtin:sky");
    refused({"-o", "-"}, 1, "--format");
    refused({"-o", "t.hdr", "--type", "half"}, 1, "--type");
    refused({"-o", "no/t.exr"}, 4, "no/t.exr");
    EXPECT_TRUE(scratch.names().empty());
}

} // namespace
} // namespace ibl
