// Maps say in their files what they are, and what reads them holds them to it.
#include "cli/render_support.h"
#include "cli/tool.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace ibl {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kFaces{"_px", "_nx", "_py", "_ny", "_pz", "_nz"};

std::string make(const Scratch& scratch, Words words) {
    const ToolResult made = runTool(words, scratch.path());
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return made.err;
}

std::string makeChain(const Scratch& scratch, const std::string& out, const std::string& levels,
                      const Words& more = {}) {
    Words words{"specular", "builtin:sky", "--size", "32", "--levels", levels, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    return make(scratch, words);
}

Image underChain(const Scratch& scratch, const std::string& chain) {
    return pictureOf(scratch, "render",
                     {"--probe", "builtin:furnace", "--background", "none", "--size", "16x16",
                      "--shader", "ggx", "--metallic", "1", "--roughness", "0.6", "--samples", "1",
                      "--specular-map", chain},
                     "p.exr");
}

void expectMapRefused(const Scratch& scratch, const char* option, const std::string& map,
                      const std::string& said) {
    const std::string shader = std::string(option) == "--diffuse-map" ? "diffuse" : "ggx";
    expectRefused(runTool({"render", "--probe", "builtin:furnace", "--shader", shader, option, map,
                           "--size", "8x8", "-o", "q.exr"},
                          scratch.path()),
                  2, said);
    EXPECT_FALSE(fs::exists(scratch / "q.exr"));
}

TEST(MapLabel, InfoTellsWhatAMapIs) {
    const Scratch scratch;
    const auto map = [&](const std::string& name) {
        const ToolResult told = runTool({"info", "--json", name}, scratch.path());
        return nlohmann::json::parse(told.out).value("map", "");
    };
    makeChain(scratch, "s.exr", "5", {"--roughness-map", "square"});
    EXPECT_EQ(map("s_m2.exr"), "ggx, roughness 0.25, level 2 of 0 to 4");
    make(scratch, {"diffuse", "builtin:sky", "--size", "4", "-o", "d.exr"});
    EXPECT_EQ(map("d.exr"), "lambert");
    make(scratch, {"specular", "builtin:sky", "--kernel", "phong", "--exponent", "40", "--size",
                   "4", "--to", "vstrip", "-o", "p.exr"});
    EXPECT_EQ(map("p.exr"), "phong, exponent 40");
    EXPECT_EQ(map("builtin:sky"), "");
    make(scratch, {"convert", "d.exr", "--to", "latlong", "--size", "4", "-o", "c.exr"});
    EXPECT_EQ(map("c.exr"), "") << "a resampled map is no longer what the convolution made";
}

// Of six levels and then four to the same name, the last two of the six stay.
TEST(MapLabel, LevelsLeftOfALongerChainAreToldAndPassedOver) {
    const Scratch scratch;
    makeChain(scratch, "alone.exr", "4");
    EXPECT_EQ(makeChain(scratch, "s.exr", "6"), "");
    EXPECT_NE(makeChain(scratch, "s.exr", "4").find("s_m4_px.exr: is left of a longer chain"),
              std::string::npos);
    EXPECT_EQ(underChain(scratch, "s.exr").pixels, underChain(scratch, "alone.exr").pixels);

    make(scratch, {"bake", "builtin:sky", "--size", "16", "--lights", "1", "-o", "b"});
    const std::string note = make(scratch, {"bake", "builtin:sky", "--size", "16", "--lights", "1",
                                            "--levels", "3", "-o", "b"});
    EXPECT_NE(note.find("specular_m3_px.exr: is left of a longer chain"), std::string::npos);
    underChain(scratch, "b/specular.exr");

    const std::string other = make(scratch, {"bake", "builtin:sky", "--size", "16", "--lights", "1",
                                             "--format", "ktx2", "-o", "b"});
    EXPECT_NE(other.find("diffuse_px.exr: is left of another format"), std::string::npos);
}

TEST(MapLabel, MixedLevelsAndFacesAreRefused) {
    const Scratch scratch;
    makeChain(scratch, "s.exr", "4");
    makeChain(scratch, "t.exr", "6");
    const auto overwrite = [&](const std::string& from, const std::string& to) {
        fs::copy_file(scratch / from, scratch / to, fs::copy_options::overwrite_existing);
    };
    overwrite("t_m1_nz.exr", "s_m1_nz.exr");
    expectMapRefused(scratch, "--specular-map", "s.exr", "s_m1_nz.exr: is of another map");
    for (const std::string& face : kFaces)
        overwrite("t_m1" + face + ".exr", "s_m1" + face + ".exr");
    expectMapRefused(scratch, "--specular-map", "s.exr", "s_m1.exr: is not of the chain");
    for (const std::string& face : kFaces)
        fs::remove(scratch / ("t_m5" + face + ".exr"));
    expectMapRefused(scratch, "--specular-map", "t.exr", "t_m5.exr");
}

TEST(MapLabel, MapsOfAnotherKindAreRefused) {
    const Scratch scratch;
    makeChain(scratch, "square.exr", "4", {"--roughness-map", "square"});
    expectMapRefused(scratch, "--specular-map", "square.exr", "--roughness-map linear");
    makeChain(scratch, "phong.exr", "3", {"--kernel", "phong"});
    expectMapRefused(scratch, "--specular-map", "phong.exr", "takes ggx");
    makeChain(scratch, "s.exr", "3");
    expectMapRefused(scratch, "--diffuse-map", "s_m1.exr", "is no diffuse map but ggx");
    makeChain(scratch, "c.ktx2", "3");
    expectMapRefused(scratch, "--specular-map", "c.ktx2", "written but not read");
}

// Of square maps the shape says nothing.
TEST(MapLabel, LayoutsAreReadBackAsTheyWereWritten) {
    const Scratch scratch;
    const auto info = [&](const std::string& name) {
        return nlohmann::json::parse(runTool({"info", "--json", name}, scratch.path()).out);
    };
    for (const std::string layout :
         {"latlong", "faces", "vcross", "hcross", "strip", "vstrip", "angular", "mirrorball",
          "octahedral", "exr-latlong", "exr-cube"}) {
        const std::string name = layout + ".exr";
        make(scratch, {"convert", "builtin:compass", "--to", layout, "--size", "8", "-o", name});
        EXPECT_EQ(info(name).at("layout"), layout);
        EXPECT_EQ(info(name).at("layout_label"), layout);
    }
    make(scratch, {"convert", "builtin:compass", "--to", "angular", "--size", "8", "-o", "p.hdr"});
    expectRefused(runTool({"info", "p.hdr"}, scratch.path()), 2, "no layout has the shape");
    EXPECT_FALSE(info("builtin:sky").contains("layout_label"));
    EXPECT_NE(runTool({"info", "angular.exr"}, scratch.path()).out.find("(its label: angular)"),
              std::string::npos);
}

TEST(MapLabel, LayoutsOfMapsAreBelieved) {
    const Scratch scratch;
    const auto under = [&](const std::string& shader, const std::string& option,
                           const std::string& map) {
        return pictureOf(scratch, "render",
                         {"--probe", "builtin:furnace", "--background", "none", "--size", "32x32",
                          "--samples", "1", "--shader", shader, option, map},
                         "p.exr");
    };
    const auto difference = [](const Image& a, const Image& b) {
        double largest = 0, sum = 0, squares = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            largest = std::max(largest, std::abs(double(a.pixels[i]) - b.pixels[i]));
            sum += std::abs(b.pixels[i]);
            squares += 1;
        }
        return largest / (sum / squares);
    };
    const auto maps = [&](const std::string& command, const std::string& to, const Words& more) {
        Words words{command, "builtin:sky", "--to", to, "--size", "128", "-o", to + ".exr"};
        words.insert(words.end(), more.begin(), more.end());
        make(scratch, words);
        return to + ".exr";
    };
    const Image latlong = under("diffuse", "--diffuse-map", maps("diffuse", "latlong", {}));
    const Words chain{"--levels", "4"};
    const Image glossy = under("ggx", "--specular-map", maps("specular", "latlong", chain));
    for (const std::string layout : {"angular", "mirrorball", "octahedral"}) {
        EXPECT_LT(
            difference(under("diffuse", "--diffuse-map", maps("diffuse", layout, {})), latlong),
            0.02)
            << layout;
        EXPECT_LT(
            difference(under("ggx", "--specular-map", maps("specular", layout, chain)), glossy),
            0.05)
            << layout;
    }
}

TEST(MapLabel, LayoutsThatAreContradictedAreRefused) {
    const Scratch scratch;
    const auto refused = [&](const Words& words, const std::string& said) {
        expectRefused(runTool(words, scratch.path()), 2, said);
    };
    const auto rename = [&](const char* from, const char* to) {
        fs::rename(scratch / from, scratch / to);
    };
    make(scratch, {"convert", "builtin:sky", "--to", "angular", "--size", "8", "-o", "a.exr"});
    // What another program makes of it keeps the label.
    const auto resized = [&](const std::string& size, const std::string& out) {
        EXPECT_EQ(runProgram({"oiiotool", "a.exr", "--resize", size, "-o", out}, scratch.path())
                      .exit_code,
                  0);
    };
    resized("16x8", "wide.exr");
    refused({"info", "wide.exr"}, "wide.exr: is labelled angular, which 16x8 pixels cannot be");
    EXPECT_EQ(runTool({"info", "wide.exr", "--from", "latlong"}, scratch.path()).exit_code, 0);
    make(scratch, {"convert", "builtin:sky", "--to", "latlong", "--size", "8", "-o", "l.exr"});
    EXPECT_EQ(runProgram({"oiiotool", "l.exr", "--resize", "8x8", "-o", "s.exr"}, scratch.path())
                  .exit_code,
              0);
    refused({"info", "s.exr"}, "is labelled latlong");
    EXPECT_EQ(runProgram({"oiiotool", "l.exr", "--attrib", "ibl.layout", "globe", "-o", "g.exr"},
                         scratch.path())
                  .exit_code,
              0);
    refused({"info", "g.exr"}, "is labelled globe, which is no layout");

    make(scratch, {"convert", "builtin:sky", "--size", "8", "-o", "f.exr"});
    refused({"info", "f_px.exr"}, "is one of six faces");
    rename("a.exr", "f_nz.exr");
    refused({"info", "f.exr"}, "f_nz.exr: is labelled angular");
    EXPECT_EQ(runTool({"info", "f.exr", "--from", "faces"}, scratch.path()).exit_code, 0);
}

// Radiance files hold no label: their levels are counted by their files.
TEST(MapLabel, MapsWithoutOneAreTakenAsTheyAre) {
    const Scratch scratch;
    makeChain(scratch, "s.hdr", "4");
    makeChain(scratch, "s.exr", "4");
    const Image from_hdr = underChain(scratch, "s.hdr"), from_exr = underChain(scratch, "s.exr");
    float largest = 0, difference = 0;
    for (std::size_t i = 0; i < from_exr.pixels.size(); ++i) {
        largest = std::max(largest, from_exr.pixels[i]);
        difference = std::max(difference, std::abs(from_hdr.pixels[i] - from_exr.pixels[i]));
    }
    EXPECT_LT(difference, 0.01F * largest); // shared exponents hold 8 bits
}

} // namespace
} // namespace ibl
