#include "scene_support.h"

#include "core/error.h"
#include "render/sample_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <unistd.h>

namespace ibl {
namespace {

Error errorOf(const Scene& scene, const FrameOptions& options) {
    try {
        Renderer(softwareContext(), scene, options).render({});
    } catch (const Error& error) {
        return error;
    }
    return {ExitCode::done, ""};
}

TEST(EglContext, NamesItsDevice) {
    const std::string text = softwareContext().description();
    EXPECT_NE(text.find("llvmpipe"), text.npos) << text;
    EXPECT_NE(text.find("OpenGL 4"), text.npos) << text;
    EXPECT_EQ(text.find('\n'), text.npos);
}

// A process of its own, since EGL looks for drivers once.
TEST(EglContext, MachinesWithoutADriverAreToldWhatToInstall) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto withoutDriver = [] {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent", 1);
        try {
            EglContext context;
        } catch (const Error& error) {
            std::fprintf(stderr, "%s", error.what());
            std::exit(static_cast<int>(error.code()));
        }
        std::exit(0);
    };
    EXPECT_EXIT(withoutDriver(), testing::ExitedWithCode(3),
                "^EGL: .*libegl1 libgl1-mesa-dri libopengl0");
}

TEST(Background, NoneGivesPremultipliedAlpha) {
    const Panorama furnace = constantProbe(2);
    Scene scene;
    scene.probe = &furnace;
    scene.background = NoBackground{};
    Renderer renderer(softwareContext(), scene, {32, 32, 16, {}});
    const Image linear = renderer.render({});
    ASSERT_EQ(linear.channels, 4);
    EXPECT_EQ(linear.at(16, 16)[3], 1);
    EXPECT_EQ(linear.at(0, 0)[3], 0);
    int partial = 0;
    double coverage = 0;
    for (int i = 0; i < 32 * 32; ++i) {
        const float* p = linear.pixels.data() + 4 * i;
        EXPECT_FLOAT_EQ(p[0], 2 * p[3]);
        partial += p[3] > 0 && p[3] < 1;
        coverage += p[3];
    }
    EXPECT_GT(partial, 20);
    // The disc has the tangent 1/sqrt(15) of the frame's half, tan 20 degrees.
    const double radius = 16 / std::sqrt(15.0) / std::tan(20 * kPi / 180);
    EXPECT_NEAR(coverage, kPi * radius * radius, 1);
}

TEST(Background, ImageIsSeenPixelForPixel) {
    const Panorama furnace = constantProbe(0);
    Scene scene;
    scene.probe = &furnace;
    scene.background = noiseProbe(Layout::latlong, 31, 17).image;
    const Image& plate = std::get<ImageBackground>(scene.background);
    const Camera away{{0, 0, 4}, {0, 0, 8}, {0, 1, 0}, 40};
    const Image frame = Renderer(softwareContext(), scene, {31, 17, 4, {}}).render(away);
    for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
        ASSERT_EQ(frame.pixels[i], plate.pixels[i]);
    }
    EXPECT_EQ(errorOf(scene, {32, 17, 1, {}}).code(), ExitCode::usage);
}

TEST(Meshes, TheNearerSurfaceIsSeenWhateverTheOrder) {
    // Two quads across the view, at z = 0 facing the camera and at z = 1 facing away.
    Mesh mesh;
    for (const float z : {1.f, 0.f}) {
        const float side = z == 1 ? 0.5f : 2.f;
        for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
            mesh.positions.emplace_back(side * static_cast<float>(x), side * static_cast<float>(y),
                                        z);
            mesh.normals.emplace_back(0.f, 0.f, z == 1 ? -1.f : 1.f);
        }
    }
    mesh.indices = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7};
    Panorama diffuse{Layout::faces, Image(1, 6)};
    for (float& v : diffuse.image.pixels)
        v = 1;
    for (int c = 0; c < 3; ++c)
        diffuse.image.at(0, 5)[c] = 0; // black for normals along -Z
    for (const bool reversed : {false, true}) {
        Scene scene;
        scene.diffuse = &diffuse;
        scene.material.shader = Shader::diffuse;
        scene.object.mesh = mesh;
        if (reversed)
            std::rotate(scene.object.mesh->indices.begin(), scene.object.mesh->indices.begin() + 6,
                        scene.object.mesh->indices.end());
        scene.background = ColorBackground(9, 9, 9);
        Renderer renderer(softwareContext(), scene, {33, 33, 1, {}});
        const Image front = renderer.render({{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40});
        // The nearer quad is seen from its back: its normal is turned to the eye, so it is white.
        EXPECT_EQ(pixel(front, 16, 16), V3d(1));
        const Image back = renderer.render({{0, 0, -5}, {0, 0, 0}, {0, 1, 0}, 20});
        EXPECT_EQ(pixel(back, 16, 16), V3d(0)); // turned to -Z
    }
}

TEST(Meshes, EdgesAreCoveredSampleForSample) {
    Mesh mesh;
    mesh.positions = {{-9, -9, 0}, {0.1f, -9, 0}, {0.1f, 0.23f, 0}, {-9, 0.23f, 0}};
    mesh.normals.assign(4, V3f(0, 0, 1));
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const Panorama white = constantProbe(1);
    Scene scene;
    scene.diffuse = &white;
    scene.material.shader = Shader::diffuse;
    scene.object.mesh = mesh;
    scene.background = NoBackground{};
    // A slanting edge, since upright ones cover as many samples of the mirrored pattern.
    const Camera camera{{0.3, 0, 4}, {0, 0, 0}, {0.6, 1, 0}, 40};
    const Image frame = Renderer(softwareContext(), scene, {30, 20, 3, {}}).render(camera);
    const CameraRays rays = cameraRays(camera, 30, 20);
    int partial = 0, wrong = 0;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 30; ++x) {
            int inside = 0;
            for (const V2d& p : samplePattern(3)) {
                const V3d d = rays.direction(x + p.x, y + p.y);
                const V3d hit = rays.eye - d * (rays.eye.z / d.z);
                inside += hit.x < 0.1f && hit.y < 0.23f;
            }
            wrong += std::abs(frame.at(x, y)[3] - inside / 3.0) > 0.1;
            partial += inside > 0 && inside < 3;
        }
    }
    EXPECT_GT(partial, 10);
    EXPECT_LE(wrong, 2); // devices place vertices on a grid in the pixel
}

TEST(Renderer, DrawsOnePixelAndNeedsOnlyItsMaps) {
    const Panorama probe = constantProbe(3);
    Scene mirror;
    mirror.probe = &probe;
    mirror.background = NoBackground{};
    EXPECT_EQ(errorOf(mirror, {1, 1, 1, {}}).code(), ExitCode::done);
    mirror.probe = nullptr;
    EXPECT_EQ(errorOf(mirror, {1, 1, 1, {}}).code(), ExitCode::usage);
    Scene diffuse;
    diffuse.diffuse = &probe;
    diffuse.material.shader = Shader::diffuse;
    diffuse.background = NoBackground{};
    EXPECT_EQ(errorOf(diffuse, {1, 1, 1, {}}).code(), ExitCode::done);
    diffuse.background = ProbeBackground{};
    EXPECT_EQ(errorOf(diffuse, {1, 1, 1, {}}).code(), ExitCode::usage);
}

TEST(Renderer, SizesBeyondTheDeviceAreRefused) {
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    EXPECT_EQ(errorOf(scene, {100000, 2, 1, {}}).code(), ExitCode::usage);
    EXPECT_EQ(errorOf(scene, {0, 2, 1, {}}).code(), ExitCode::usage);
    EXPECT_EQ(errorOf(scene, {2, 2, 0, {}}).code(), ExitCode::usage);
    const Panorama wide{Layout::latlong, Image(40000, 1)};
    scene.probe = &wide;
    const Error error = errorOf(scene, {2, 2, 1, {}});
    EXPECT_EQ(error.code(), ExitCode::input);
    EXPECT_NE(std::string(error.what()).find("40000"), std::string::npos) << error.what();
}

TEST(Renderer, SameBytesOnEveryRun) {
    const Panorama probe = noiseProbe(Layout::latlong, 64, 32);
    Scene scene;
    scene.probe = &probe;
    scene.object = *builtinObject("teapot");
    const auto draw = [&] {
        return Renderer(softwareContext(), scene, {64, 48, 7, {}}).render({}).pixels;
    };
    EXPECT_TRUE(draw() == draw());
}

class ShaderFolder : public testing::Test {
protected:
    ShaderFolder() { std::filesystem::create_directories(folder_); }
    ~ShaderFolder() override { std::filesystem::remove_all(folder_); }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }
    const std::filesystem::path folder_{testing::TempDir() + "ibl_shader_folder_" +
                                        std::to_string(getpid())};
};

TEST_F(ShaderFolder, FilesReplaceTheEmbeddedOnes) {
    write("mirror.frag", "vec3 shade(vec3 normal, vec3 incident) { return vec3(7.0); }\n");
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    const Image frame = Renderer(softwareContext(), scene, {9, 9, 1, folder_}).render({});
    EXPECT_EQ(pixel(frame, 4, 4), V3d(7));
    EXPECT_EQ(pixel(frame, 0, 0), V3d(1));
}

TEST_F(ShaderFolder, ErrorsNameFileAndLine) {
    write("mirror.frag",
          "// one\n// two\nvec3 shade(vec3 normal, vec3 incident) { return nonsense; }\n");
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    const Error error = errorOf(scene, {9, 9, 1, folder_});
    EXPECT_EQ(error.code(), ExitCode::input);
    const std::string expected = (folder_ / "mirror.frag").string() + ":3: ";
    EXPECT_EQ(std::string(error.what()).rfind(expected, 0), 0u) << error.what();
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
}

} // namespace
} // namespace ibl
