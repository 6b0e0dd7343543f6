// The module ibltool_ocio.so: the only code that sees OpenColorIO.
#include "image/ocio.h"

#include <OpenColorIO/OpenColorIO.h>

#include <cstdlib>
#include <stdexcept>

namespace OCIO = OCIO_NAMESPACE;

namespace ibl {
namespace {

// From linear Rec. 709 through the ACES 1.0 output transform for SDR video to sRGB, all of them
// OpenColorIO's own.
OCIO::ConstProcessorRcPtr acesOutput() {
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
    return OCIO::Config::CreateRaw()->getProcessor(group);
}

OCIO::ConstProcessorRcPtr viewOf(const OCIO::ConstConfigRcPtr& config, const DisplayView& wanted) {
    const std::string space = wanted.space.empty() ? OCIO::ROLE_SCENE_LINEAR : wanted.space;
    const std::string display =
        wanted.display.empty() ? config->getDefaultDisplay() : wanted.display;
    const std::string view =
        wanted.view.empty() ? config->getDefaultView(display.c_str()) : wanted.view;
    if (!config->getColorSpace(space.c_str())) {
        throw std::runtime_error("has no colour space or role '" + space +
                                 "'; name one with --ocio-space");
    }
    const OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(space.c_str());
    transform->setDisplay(display.c_str());
    transform->setView(view.c_str());
    return config->getProcessor(transform);
}

OCIO::ConstProcessorRcPtr processorOf(const DisplayView& view) {
    const bool from_environment = view.config.empty() && std::getenv("OCIO");
    if (view.config.empty() && !from_environment) {
        if (!view.space.empty() || !view.display.empty() || !view.view.empty()) {
            throw std::runtime_error("there is no config to look spaces, displays and views up in; "
                                     "name one with --ocio-config or $OCIO");
        }
        return acesOutput();
    }
    return viewOf(from_environment ? OCIO::Config::CreateFromEnv()
                                   : OCIO::Config::CreateFromFile(view.config.c_str()),
                  view);
}

void addTables(const OCIO::GpuShaderDesc& shader, DisplayTransform& transform) {
    for (unsigned i = 0; i < shader.getNumTextures(); ++i) {
        const char *name = nullptr, *sampler = nullptr;
        unsigned width = 0, height = 0;
        OCIO::GpuShaderDesc::TextureType type{};
        OCIO::Interpolation interpolation{};
        shader.getTexture(i, name, sampler, width, height, type, interpolation);
        const float* values = nullptr;
        shader.getTextureValues(i, values);
        const int channels = type == OCIO::GpuShaderDesc::TEXTURE_RED_CHANNEL ? 1 : 3;
        const std::size_t count = static_cast<std::size_t>(width) * height * channels;
        transform.luts.push_back({sampler,
                                  static_cast<int>(width),
                                  static_cast<int>(height),
                                  0,
                                  channels,
                                  interpolation != OCIO::INTERP_NEAREST,
                                  {values, values + count}});
    }
    for (unsigned i = 0; i < shader.getNum3DTextures(); ++i) {
        const char *name = nullptr, *sampler = nullptr;
        unsigned edge = 0;
        OCIO::Interpolation interpolation{};
        shader.get3DTexture(i, name, sampler, edge, interpolation);
        const float* values = nullptr;
        shader.get3DTextureValues(i, values);
        const int n = static_cast<int>(edge);
        const std::size_t count = static_cast<std::size_t>(edge) * edge * edge * 3;
        transform.luts.push_back(
            {sampler, n, n, n, 3, interpolation == OCIO::INTERP_LINEAR, {values, values + count}});
    }
}

} // namespace
} // namespace ibl

extern "C" __attribute__((visibility("default"))) bool
ibltoolOcioLoad(const ibl::DisplayView& view, ibl::DisplayTransform& transform,
                std::string& error) noexcept {
    try {
        OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE);
        const OCIO::ConstProcessorRcPtr processor = ibl::processorOf(view);
        OCIO::GpuShaderDescRcPtr shader = OCIO::GpuShaderDesc::CreateShaderDesc();
        shader->setLanguage(OCIO::GPU_LANGUAGE_GLSL_4_0);
        shader->setFunctionName("ocioDisplay");
        shader->setResourcePrefix("ocio");
        processor->getDefaultGPUProcessor()->extractGpuShaderInfo(shader);
        transform.glsl = shader->getShaderText();
        ibl::addTables(*shader, transform);
        return true;
    } catch (const std::exception& problem) {
        error = problem.what();
        return false;
    }
}
