// Materials of render and the maps that they read, as users call them.
#include "cli/render_support.h"

#include "image/write.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

TEST(RenderMaterial, FurnaceIsOneForEveryShaderAndObject) {
    const Scratch scratch;
    for (const char* object :
         {"sphere", "cube", "torus", "teapot", "dodecahedron", "cone", "plane"}) {
        for (const char* shader :
             {"mirror", "diffuse", "mirror-diffuse", "glass", "dispersion", "coat", "ggx"}) {
            const Image frame =
                render(scratch, {"--probe", "builtin:furnace", "--object", object, "--shader",
                                 shader, "--size", "24x24", "--samples", "4"});
            for (const float v : frame.pixels) {
                ASSERT_NEAR(v, 1, 1e-5) << object << " " << shader;
            }
        }
    }
}

TEST(RenderMaterial, ModelsOnlyWhatTheMaterialRequires) {
    const Scratch scratch;
    struct Case {
        Words words;
        std::vector<std::string> kernels; ///< of the maps that are convolved
        std::vector<std::string> stages;  ///< and what else is computed
    };
    const std::vector<Case> cases{
        {{"--shader", "mirror"}, {}, {"read"}},
        {{"--shader", "glass"}, {}, {"read"}},
        {{"--shader", "diffuse"}, {"lambert"}, {"read", "convolve"}},
        {{"--shader", "coat"}, {"lambert"}, {"read", "convolve"}},
        {{"--shader", "ggx"}, {"ggx", "lambert"}, {"read", "convolve", "split-sum"}},
        {{"--shader", "ggx", "--metallic", "1"}, {"ggx"}, {"read", "convolve", "split-sum"}},
        {{"--shader", "ggx", "--metallic", "1", "--samples-specular", "4"}, {}, {"read", "levels"}},
        {{"--shader", "diffuse", "--diffuse-map", "builtin:sky", "--background", "none"},
         {},
         {"read"}},
    };
    for (const Case& c : cases) {
        Words words{"--probe", "builtin:furnace", "--size", "8x8", "--report", "r.json"};
        words.insert(words.end(), c.words.begin(), c.words.end());
        render(scratch, words);
        const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
        std::vector<std::string> kernels, stages;
        for (const auto& map : report["results"].value("maps", nlohmann::json::array()))
            kernels.push_back(map["kernel"]);
        for (const char* stage : {"read", "convolve", "split-sum", "levels"})
            if (report["seconds"].contains(stage)) stages.emplace_back(stage);
        EXPECT_EQ(kernels, c.kernels) << c.words[1];
        EXPECT_EQ(stages, c.stages) << c.words[1];
    }
}

// Constant maps of another value than the probe's show that they, not the probe, are read.
TEST(RenderMaterial, TakesMapsBakedEarlier) {
    const Scratch scratch;
    Image half(8, 4);
    for (float& v : half.pixels)
        v = 0.5f;
    OutputSet outputs;
    writeImage(outputs, (scratch / "half.exr").string(), half);
    outputs.commit();
    for (const Words& words :
         {Words{"diffuse", "half.exr", "--size", "4", "-o", "d.exr"},
          Words{"specular", "half.exr", "--levels", "4", "--size", "16", "-o", "s.exr"}}) {
        const ToolResult made = runTool(words, scratch.path());
        ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    const auto middle = [&](Words words) {
        words.insert(words.end(),
                     {"--probe", "builtin:furnace", "--size", "9x9", "--background", "none"});
        return render(scratch, words).at(4, 4)[0];
    };
    EXPECT_NEAR(middle({"--shader", "diffuse", "--diffuse-map", "d.exr"}), 0.5, 1e-5);
    for (const char* roughness : {"0", "0.4", "1"}) {
        EXPECT_NEAR(middle({"--shader", "ggx", "--metallic", "1", "--roughness", roughness,
                            "--specular-map", "s.exr"}),
                    0.5, 1e-4);
    }
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "-o", "q.exr"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--diffuse-map", "d.exr"}, 1, "--diffuse-map");
    refused({"--shader", "diffuse", "--specular-map", "s.exr"}, 1, "--specular-map");
    refused({"--shader", "diffuse", "--diffuse-map", "none.exr"}, 2, "none.exr");
    refused({"--shader", "ggx", "--specular-map", "d.exr"}, 2, "specular --levels");
}

TEST(RenderMaterial, OwnShaders) {
    const Scratch scratch;
    writeFile(scratch / "own.frag", "uniform float roughness;\n"
                                    "vec3 shade(vec3 normal, vec3 incident) {\n"
                                    "    return roughness * probeRadiance(normal);\n}\n");
    const Image frame = render(scratch, {"--probe", "builtin:furnace", "--size", "9x9", "--shader",
                                         "own.frag", "--roughness", "0.25", "--depfile", "o.d"});
    EXPECT_NEAR(frame.at(4, 4)[0], 0.25, 1e-6);
    EXPECT_EQ(readFile(scratch / "o.d"), "o.exr: own.frag\n");
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "-o", "q.exr"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--shader", "own.frag", "--metallic", "1"}, 1, "metallic");
    refused({"--shader", "missing.frag"}, 2, "missing.frag");
    writeFile(scratch / "none.frag", "// nothing\n");
    refused({"--shader", "none.frag"}, 2, "shade(vec3 normal");
    writeFile(scratch / "bad.frag", "\nvec3 shade(vec3 n, vec3 i) { return what; }\n");
    refused({"--shader", "bad.frag"}, 2, "bad.frag:2: ");
    writeFile(scratch / "open.frag", "\nvec3 shade(vec3 n, vec3 i) {\n    return n;\n");
    refused({"--shader", "open.frag"}, 2, "open.frag:3: ");
}

TEST(RenderMaterial, OwnUniformsThatNothingSetsAreNamed) {
    const Scratch scratch;
    const auto said = [&](const std::string& declarations, const std::string& color,
                          const Words& more = {"-o", "o.exr"}) {
        writeFile(scratch / "own.frag", declarations +
                                            "\nvec3 shade(vec3 normal, vec3 incident) {\n"
                                            "    return " +
                                            color + ";\n}\n");
        Words words{"render",    "--probe", "builtin:furnace", "--shader", "own.frag",
                    "--size",    "8x8",     "--samples",       "1",        "--object",
                    "octahedron"};
        words.insert(words.end(), more.begin(), more.end());
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.err;
    };
    EXPECT_EQ(said("uniform float glow;", "vec3(glow)"),
              "ibltool: --shader own.frag: no option sets its uniform glow; it stays as declared, "
              "0 where nothing is said\n");
    EXPECT_EQ(
        said("uniform float warm = 2.0, cold[3];\nlayout(binding = 3) uniform sampler2D film;",
             "texture(film, normal.xy).rgb * warm + cold[1]"),
        "ibltool: --shader own.frag: no options set its uniforms cold, film, warm; they stay "
        "as declared, 0 where nothing is said\n");
    // What is documented, what the program itself has, and what the compiler leaves out.
    EXPECT_EQ(said("uniform float roughness, metallic, ior;\nuniform vec3 ior_rgb, eye;\n"
                   "uniform float unused;",
                   "base_color + part_color + vec3(roughness + metallic + ior + part_id) + ior_rgb "
                   "+ eye + fresnel + specularRadiance(normal, 0.5) + probeRadiance(normal) + "
                   "throughObject(normal, incident, 1.5)",
                   {"--roughness", "0.5", "-o", "o.exr"}),
              "");
    // Once, however many frames.
    const std::string frames =
        said("uniform vec3 glow;", "glow", {"--frames", "1-3", "--yaw", "0..9", "-o", "o%d.exr"});
    EXPECT_EQ(frames.find("glow"), frames.rfind("glow"));
}

TEST(RenderMaterial, BaseTextureOfIntegersIsDecoded) {
    const Scratch scratch;
    // All linear 0.5: a background, and a camera that sees nothing else.
    render(scratch,
           {"--probe", "builtin:furnace", "--background", "0.5,0.5,0.5", "--eye", "0,0,9",
            "--target", "0,0,18", "--size", "16x8"},
           "grey.png");
    for (const char* object : {"sphere", "cube", "cylinder", "torus", "teapot", "plane"}) {
        const Image frame =
            render(scratch, {"--probe", "builtin:furnace", "--base-texture", "grey.png", "--object",
                             object, "--elevation", "30", "--background", "0,0,0", "--size",
                             "32x32", "--samples", "1"});
        float largest = 0;
        for (const float v : frame.pixels)
            largest = std::max(largest, v);
        EXPECT_NEAR(largest, 0.5, 0.005) << object;
    }
}

// Alpha of a texture is how much of the object there is; through a sphere's holes its inside shows.
TEST(RenderMaterial, BaseTexturesAlphaShowsWhatIsBehind) {
    const Scratch scratch;
    // A sphere on nothing: red, opaque in the middle.
    render(scratch,
           {"--probe", "builtin:furnace", "--background", "none", "--base-color", "0.5,0,0",
            "--size", "64x64"},
           "ball.exr");
    const Image ball = readImage((scratch / "ball.exr").string(), {"", true}).image;
    const Words words{"--probe",  "builtin:furnace", "--base-texture", "ball.exr",
                      "--object", "plane",           "--eye",          "0,9,0",
                      "--up",     "0,0,-1",          "--size",         "64x64"};
    Words alone = words;
    alone.insert(alone.end(), {"--background", "none", "--report", "r.json"});
    const Image plane = render(scratch, alone);
    EXPECT_EQ(readFile(scratch / "r.json").find("alpha channel is ignored"), std::string::npos);
    double covered = 0, of_texture = 0;
    for (std::size_t i = 0; i < plane.pixels.size(); i += 4) {
        covered += plane.pixels[i + 3];
        of_texture += ball.pixels[i + 3];
        // Premultiplied, so red is half of alpha everywhere, the edge included.
        ASSERT_NEAR(plane.pixels[i], 0.5 * plane.pixels[i + 3], 1e-5);
        ASSERT_EQ(plane.pixels[i + 1], 0);
    }
    // The plane's side is sqrt 2, that of what is seen there 2 * 9 tan 20 degrees.
    const double side = std::sqrt(2.0) / (18 * std::tan(std::numbers::pi / 9));
    EXPECT_NEAR(covered / of_texture, side * side, 0.01);

    // The sphere's front has the ball; through the back, which has nothing of it, the front shows.
    Words sphere{"--probe", "builtin:furnace", "--background", "none", "--size", "33x33"};
    const auto coverage = [](const Image& image) {
        double sum = 0;
        for (std::size_t i = 3; i < image.pixels.size(); i += 4)
            sum += image.pixels[i];
        return sum;
    };
    const double whole = coverage(render(scratch, sphere));
    sphere.insert(sphere.end(), {"--base-texture", "ball.exr"});
    const Image front = render(scratch, sphere);
    sphere.insert(sphere.end(), {"--azimuth", "180"});
    const Image back = render(scratch, sphere);
    EXPECT_EQ(front.at(16, 16)[3], 1);
    EXPECT_EQ(back.at(16, 16)[3], 1);
    EXPECT_LT(coverage(front), whole - 2);
    EXPECT_LT(coverage(back), 0.95 * whole);
    EXPECT_GT(coverage(back), 0.5 * whole);
}

} // namespace
} // namespace ibl
