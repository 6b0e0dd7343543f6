#include "cli/render_options.h"

#include "core/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace ibl {
namespace {

/// `WxH`, both from 1.
void parseSize(const std::string& text, FrameOptions& frame) {
    const std::size_t cross = text.find('x');
    const auto number = [&](std::size_t begin, std::size_t end, int& value) {
        const auto [last, problem] = std::from_chars(text.data() + begin, text.data() + end, value);
        return problem == std::errc() && last == text.data() + end && value >= 1;
    };
    if (cross == std::string::npos || !number(0, cross, frame.width) ||
        !number(cross + 1, text.size(), frame.height)) {
        throw CLI::ValidationError("--size", "'" + text + "' is not WIDTHxHEIGHT, such as 640x480");
    }
}

/// `r,g,b`, if the text is three numbers that may be radiance: finite, none negative.
std::optional<V3f> colorFrom(const std::string& text) {
    V3f color;
    const char* at = text.data();
    const char* end = at + text.size();
    for (int c = 0; c < 3; ++c) {
        const auto [next, problem] = std::from_chars(at, end, color[c]);
        if (problem != std::errc() || !(color[c] >= 0) || std::isinf(color[c])) return std::nullopt;
        at = next;
        if (c < 2 && (at == end || *at++ != ',')) return std::nullopt;
    }
    return at == end ? std::optional(color) : std::nullopt;
}

/// One of the three components of every pixel.
std::vector<float> component(const Image& image, int c) {
    std::vector<float> values(image.pixels.size() / 3);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = image.pixels[3 * i + static_cast<std::size_t>(c)];
    return values;
}

} // namespace

std::vector<ExtraChannel> aovChannels(const PictureArguments& arguments, FrameAovs aovs) {
    std::vector<ExtraChannel> channels;
    const auto asked = [&](const char* name) {
        return std::ranges::find(arguments.aovs, name) != arguments.aovs.end();
    };
    if (asked("normal")) {
        channels.push_back({"normal.X", component(aovs.normal, 0)});
        channels.push_back({"normal.Y", component(aovs.normal, 1)});
        channels.push_back({"normal.Z", component(aovs.normal, 2)});
    }
    if (asked("depth")) channels.push_back({"depth.Z", std::move(aovs.depth)});
    if (asked("id")) channels.push_back({"id", std::move(aovs.id)});
    return channels;
}

ExtraChannel takeMatte(Image& picture) {
    ExtraChannel matte{"matte.A", {}};
    const std::size_t pixels = picture.pixels.size() / 4;
    matte.values.reserve(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        matte.values.push_back(picture.pixels[4 * i + 3]);
        for (std::size_t c = 0; c < 3; ++c)
            picture.pixels[3 * i + c] = picture.pixels[4 * i + c];
    }
    picture.pixels.resize(3 * pixels);
    picture.channels = 3;
    return matte;
}

void bindDevice(CLI::App& app, DeviceArguments& arguments) {
    app.add_option_function<std::string>(
           "--device",
           [&arguments](const std::string& text) {
               arguments.software = text == "software";
               if (arguments.software) return;
               int number = 0;
               const char* end = text.data() + text.size();
               const auto [last, problem] = std::from_chars(text.data(), end, number);
               if (problem != std::errc() || last != end || number < 0) {
                   throw CLI::ValidationError("--device", "'" + text +
                                                              "' is neither software nor a "
                                                              "device's number");
               }
               arguments.number = number;
           },
           "EGL device to draw with: software, or its number from 0; --verbose names them "
           "(default: "
           "hardware where there is some)")
        ->type_name("N|software")
        ->group("Run");
}

EglContext contextOf(const DeviceArguments& arguments) {
    if (arguments.number) return EglContext::ofDevice(*arguments.number);
    return EglContext(arguments.software ? DevicePreference::software
                                         : DevicePreference::hardwareFirst);
}

Background backgroundOf(Session& session, const std::string& name) {
    if (name == "probe") return ProbeBackground{};
    if (name == "none") return NoBackground{};
    if (const std::optional<V3f> color = colorFrom(name)) return *color;
    std::error_code ignored;
    if (name.find(',') != std::string::npos && !std::filesystem::exists(name, ignored)) {
        throw Error(ExitCode::usage, "--background " + name +
                                         ": a colour is three numbers from 0 to 3.4e38, such as "
                                         "0.2,0.2,0.2");
    }
    return session.readPicture(name, "background");
}

void bindPicture(CLI::App& app, PictureArguments& arguments) {
    app.add_option_function<std::string>(
           "--size",
           [&arguments](const std::string& text) {
               parseSize(text, arguments.frame);
               arguments.size_given = true;
           },
           "Width and height in pixels (default 512x512)")
        ->type_name("WxH")
        ->group("Picture");
    app.add_option("--samples", arguments.frame.samples,
                   "Shaded samples a pixel, averaged in linear light")
        ->check(inRange(1, 4096))
        ->type_name("N")
        ->capture_default_str()
        ->group("Picture");
    app.add_option("--aov", arguments.aovs,
                   "Layers of the EXR beside the picture, each pixel's centre: normal, depth, id")
        ->delimiter(',')
        ->check(CLI::IsMember({"normal", "depth", "id"}))
        ->type_name("NAME,...")
        ->group("Picture");
    app.add_option(
           "--background", arguments.background,
           "What is behind the object: probe, none (premultiplied alpha), r,g,b or an image "
           "of the picture's size")
        ->type_name("WHAT")
        ->capture_default_str()
        ->group("Picture");
}

} // namespace ibl
