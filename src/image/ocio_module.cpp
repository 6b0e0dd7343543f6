// The module ibltool_ocio.so: the only code that sees OpenColorIO.
#include "image/ocio.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
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

/// What is asked for is not in the config.
struct Unknown : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// `nameOf(i)` for all i below `count`, a dozen at most.
template <class NameOf>
std::string listed(int count, const NameOf& nameOf) {
    std::string text;
    for (int i = 0; i < std::min(count, 12); ++i)
        text += (i == 0 ? "" : ", ") + std::string(nameOf(i));
    return count > 12 ? text + " and " + std::to_string(count - 12) + " more" : text;
}

/// Inactive displays and views are taken, too, but not advertised.
void requireKnown(const OCIO::Config& config, const std::string& space, const char* display,
                  const char* view) {
    if (!config.getColorSpace(space.c_str())) {
        throw Unknown("has no colour space or role '" + space + "'; there is " +
                      listed(config.getNumColorSpaces(),
                             [&](int i) { return config.getColorSpaceNameByIndex(i); }));
    }
    if (config.getNumViews(OCIO::VIEW_DISPLAY_DEFINED, display) +
            config.getNumViews(OCIO::VIEW_SHARED, display) ==
        0) {
        throw Unknown("has no display '" + std::string(display) + "'; there is " +
                      listed(config.getNumDisplays(), [&](int i) { return config.getDisplay(i); }));
    }
    if (*config.getDisplayViewColorSpaceName(display, view) == '\0' &&
        *config.getDisplayViewTransformName(display, view) == '\0') {
        throw Unknown(
            "has no view '" + std::string(view) + "' of the display '" + display + "'; there is " +
            listed(config.getNumViews(display), [&](int i) { return config.getView(display, i); }));
    }
}

OCIO::ConstProcessorRcPtr viewOf(const OCIO::ConstConfigRcPtr& config, const DisplayView& wanted) {
    const std::string space = wanted.space.empty() ? OCIO::ROLE_SCENE_LINEAR : wanted.space;
    const std::string display =
        wanted.display.empty() ? config->getDefaultDisplay() : wanted.display;
    const std::string view =
        wanted.view.empty() ? config->getDefaultView(display.c_str()) : wanted.view;
    requireKnown(*config, space, display.c_str(), view.c_str());
    const OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(space.c_str());
    transform->setDisplay(display.c_str());
    transform->setView(view.c_str());
    return config->getProcessor(transform);
}

/// "" where there is none.
std::string configFile(const DisplayView& view) {
    const char* environment = std::getenv("OCIO");
    return !view.config.empty() || !environment ? view.config : environment;
}

OCIO::ConstProcessorRcPtr processorOf(const DisplayView& view) {
    const std::string config = configFile(view);
    if (!config.empty()) return viewOf(OCIO::Config::CreateFromFile(config.c_str()), view);
    if (!view.space.empty() || !view.display.empty() || !view.view.empty()) {
        throw Unknown("is not set, so there is no OpenColorIO config to look spaces, displays and "
                      "views up in; set it to a config's file, or give one with --ocio-config");
    }
    return acesOutput();
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

extern "C" __attribute__((visibility("default"))) ibl::ExitCode
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
        if (const std::string config = ibl::configFile(view); !config.empty())
            transform.files.push_back(config);
        const OCIO::ConstProcessorMetadataRcPtr read = processor->getProcessorMetadata();
        for (int i = 0; i < read->getNumFiles(); ++i)
            transform.files.emplace_back(read->getFile(i));
        return ibl::ExitCode::done;
    } catch (const ibl::Unknown& problem) {
        error = problem.what();
        return ibl::ExitCode::usage;
    } catch (const std::exception& problem) {
        error = problem.what();
        while (error.ends_with('.'))
            error.pop_back();
        error += "; correct it, or give another config";
        return ibl::ExitCode::input;
    }
}
