#include "cli/render_options.h"

#include "core/error.h"
#include "image/read.h"

#include <charconv>
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

/// `r,g,b`, if the text is three numbers.
std::optional<V3f> colorFrom(const std::string& text) {
    V3f color;
    const char* at = text.data();
    const char* end = at + text.size();
    for (int c = 0; c < 3; ++c) {
        const auto [next, problem] = std::from_chars(at, end, color[c]);
        if (problem != std::errc()) return std::nullopt;
        at = next;
        if (c < 2 && (at == end || *at++ != ',')) return std::nullopt;
    }
    return at == end ? std::optional(color) : std::nullopt;
}

} // namespace

Background backgroundOf(Session& session, const PictureArguments& arguments) {
    if (arguments.background == "probe") return ProbeBackground{};
    if (arguments.background == "none") return NoBackground{};
    if (const std::optional<V3f> color = colorFrom(arguments.background)) return *color;
    std::error_code ignored;
    if (arguments.background.find(',') != std::string::npos &&
        !std::filesystem::exists(arguments.background, ignored)) {
        throw Error(ExitCode::usage, "--background " + arguments.background +
                                         ": a colour is three numbers, such as 0.2,0.2,0.2");
    }
    session.addInput(arguments.background);
    ReadOptions how;
    how.threads = session.threads();
    ImageFile file =
        session.stage("background", [&] { return readImage(arguments.background, how); });
    for (const std::string& text : file.notes)
        session.note(arguments.background, text);
    return std::move(file.image);
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
        ->check(CLI::Range(1, 4096))
        ->type_name("N")
        ->capture_default_str()
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
