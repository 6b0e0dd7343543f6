// A view of an OpenColorIO config on the device against OpenColorIO's own path on the CPU.
#include "display_support.h"

#include "core/error.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace OCIO = OCIO_NAMESPACE;

namespace ibl {
namespace {

Image colours() {
    Image picture(64, 64);
    std::uint32_t state = 1;
    for (float& v : picture.pixels) {
        state = state * 1664525u + 1013904223u;
        v = std::exp2(static_cast<float>(state >> 8) / (1 << 24) * 18 - 12); // 2^-12 to 2^6
    }
    for (int c = 0; c < 3; ++c) {
        picture.at(0, 0)[c] = 0;
        picture.at(1, 0)[c] = -1;
        picture.at(2, 0)[c] = 1e9F;
    }
    return picture;
}

void expectTheSame(const DisplayView& view, const OCIO::ConstProcessorRcPtr& processor) {
    const Image picture = colours();
    DisplayOptions options;
    options.tone_map = ToneMap::display;
    options.transform = loadDisplayTransform(view);
    const Image seen = shown(options, picture);
    const OCIO::ConstCPUProcessorRcPtr cpu = processor->getDefaultCPUProcessor();
    const auto code = [](float v) { return std::lround(255 * std::clamp(v, 0.0F, 1.0F)); };
    long spread = 0;
    for (std::size_t i = 0; i < seen.pixels.size(); i += 3) {
        float rgb[3] = {picture.pixels[i], picture.pixels[i + 1], picture.pixels[i + 2]};
        cpu->applyRGB(rgb);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_LE(std::abs(code(seen.pixels[i + c]) - code(rgb[c])), 1)
                << picture.pixels[i + c] << ": " << seen.pixels[i + c] << " for " << rgb[c];
            spread = std::max(spread, std::abs(code(rgb[c]) - code(rgb[0])));
        }
    }
    EXPECT_GT(spread, 50); // the colours are not all clipped to one
}

class OcioConfig : public testing::Test {
protected:
    OcioConfig() {
        std::filesystem::create_directories(folder_);
        std::ofstream config(folder_ / "config.ocio");
        config << R"(ocio_profile_version: 2
search_path: .
roles: {scene_linear: lin, default: lin}
displays:
  screen:
    - !<View> {name: cube, colorspace: cube}
    - !<View> {name: curve, colorspace: curve}
colorspaces:
  - !<ColorSpace> {name: lin}
  - !<ColorSpace>
    name: cube
    from_scene_reference: !<GroupTransform>
      children:
        - !<AllocationTransform> {allocation: lg2, vars: [-12, 6]}
        - !<FileTransform> {src: look.cube, interpolation: linear}
  - !<ColorSpace>
    name: curve
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0.9, 0.1, 0, 0, 0, 0.8, 0.2, 0, 0.1, 0, 0.9, 0, 0, 0, 0, 1]}
        - !<FileTransform> {src: look.spi1d, interpolation: linear}
)";
        std::ofstream cube(folder_ / "look.cube");
        cube << "LUT_3D_SIZE 9\n";
        for (int b = 0; b < 9; ++b) {
            for (int g = 0; g < 9; ++g) {
                for (int r = 0; r < 9; ++r) {
                    cube << r * r / 64.0 << " " << (g + r) / 16.0 << " " << (2 * b + g) / 24.0
                         << "\n";
                }
            }
        }
        std::ofstream curve(folder_ / "look.spi1d");
        curve << "Version 1\nFrom 0.0 4.0\nLength 5000\nComponents 1\n{\n";
        for (int i = 0; i < 5000; ++i)
            curve << std::pow(i / 4999.0, 0.4) << "\n";
        curve << "}\n";
    }
    ~OcioConfig() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "config.ocio").string(); }

    // Tests run beside each other, and beside those of another tree.
    const std::filesystem::path folder_{testing::TempDir() + "ibl_ocio_" +
                                        std::to_string(getpid())};
};

TEST_F(OcioConfig, ViewsAreOpenColorIosOwn) {
    const OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromFile(path().c_str());
    for (const char* view : {"cube", "curve"}) {
        const OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
        transform->setSrc("lin");
        transform->setDisplay("screen");
        transform->setView(view);
        expectTheSame({path(), "", "", view}, config->getProcessor(transform));
    }
}

TEST_F(OcioConfig, WhatIsNotInItIsRefused) {
    const auto expectRefused = [](const DisplayView& view, ExitCode code, const char* said) {
        try {
            loadDisplayTransform(view);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
            return;
        }
        ADD_FAILURE() << "not refused: " << said;
    };
    EXPECT_NO_THROW(loadDisplayTransform({path(), "", "", ""}));
    expectRefused({path(), "nowhere", "", ""}, ExitCode::usage,
                  "config.ocio: has no colour space or role 'nowhere'; there is lin, cube, curve");
    expectRefused({path(), "", "wall", ""}, ExitCode::usage,
                  "config.ocio: has no display 'wall'; there is screen");
    expectRefused({path(), "", "", "sideways"}, ExitCode::usage,
                  "has no view 'sideways' of the display 'screen'; there is cube, curve");
    expectRefused({path() + "x", "", "", ""}, ExitCode::input, "config.ociox: ");
    std::ofstream(folder_ / "broken.ocio") << "ocio_profile_version: [";
    expectRefused({(folder_ / "broken.ocio").string(), "", "", ""}, ExitCode::input,
                  "give another config");
}

TEST(Ocio, WithoutAConfigItIsTheAcesOutputTransform) {
    const OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    const auto append = [&](const char* style, OCIO::TransformDirection direction) {
        const OCIO::BuiltinTransformRcPtr builtin = OCIO::BuiltinTransform::Create();
        builtin->setStyle(style);
        builtin->setDirection(direction);
        group->appendTransform(builtin);
    };
    append("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", OCIO::TRANSFORM_DIR_INVERSE);
    append("ACEScg_to_ACES2065-1", OCIO::TRANSFORM_DIR_FORWARD);
    append("ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0", OCIO::TRANSFORM_DIR_FORWARD);
    append("DISPLAY - CIE-XYZ-D65_to_sRGB", OCIO::TRANSFORM_DIR_FORWARD);
    expectTheSame({}, OCIO::Config::CreateRaw()->getProcessor(group));
}

} // namespace
} // namespace ibl
