#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/display_options.h"
#include "cli/session.h"

#include "core/error.h"
#include "image/read.h"
#include "panorama/builtin.h"
#include "panorama/census.h"
#include "render/exposure.h"

#include <exception>
#include <future>
#include <memory>
#include <optional>

namespace ibl {
namespace {

struct TonemapOptions {
    CommonOptions common;
    std::string input;
    std::string layer;
    bool repair = false;
    DisplayArguments display;
    ImageOutputOptions output;
};

Image readPicture(Session& session, const TonemapOptions& options) {
    if (isBuiltin(options.input)) {
        return builtinProbe(options.input, 512, session.threads()).image;
    }
    ReadOptions how;
    how.layer = options.layer;
    how.keep_alpha = true;
    how.threads = session.threads();
    session.addInput(options.input);
    ImageFile file = session.stage("read", [&] { return readImage(options.input, how); });
    for (const std::string& text : file.notes)
        session.note(options.input, text);
    return std::move(file.image);
}

/// Mends the colours as those of a probe.
void mendPicture(Session& session, const std::string& subject, Image& picture) {
    Panorama colours{Layout::latlong, Image(picture.width, picture.height)};
    const auto exchange = [&](bool back) {
        for (int y = 0; y < picture.height; ++y) {
            for (int x = 0; x < picture.width; ++x) {
                float *to = colours.image.at(x, y), *from = picture.at(x, y);
                std::copy_n(back ? to : from, 3, back ? from : to);
            }
        }
    };
    exchange(false);
    session.mend(subject, colours);
    exchange(true);
}

/// Mends or refuses what is not finite; returns the log-average.
double screenPicture(Session& session, const TonemapOptions& options, Image& picture) {
    const auto census = [&] {
        return session.stage("screen", [&] {
            return takePictureCensus(picture, deltaOf(options.display), session.threads());
        });
    };
    PictureCensus found = census();
    if (options.repair && found.nan + found.infinite + found.negative > 0) {
        mendPicture(session, options.input, picture);
        found = census();
    }
    if (found.nan + found.infinite > 0) {
        throw inputError(options.input, std::to_string(found.nan) + " NaN and " +
                                            std::to_string(found.infinite) +
                                            " infinite pixels; --repair mends them");
    }
    if (found.negative > 0) {
        session.note(options.input, std::to_string(found.negative) +
                                        " negative pixels kept; --repair sets them to 0");
    }
    return found.log_average;
}

void runTonemap(const TonemapOptions& options) {
    Session session("tonemap", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    requireFitting(options.display, options.output);
    // The device is found while the picture is read, on this thread, where the context must be.
    Image picture;
    std::future<double> reading = std::async(std::launch::async, [&] {
        picture = readPicture(session, options);
        return screenPicture(session, options, picture);
    });
    std::optional<EglContext> context;
    std::exception_ptr no_device;
    try {
        context.emplace();
    } catch (...) {
        no_device = std::current_exception();
    }
    const double log_average = reading.get(); // what is wrong with the picture is said first
    if (no_device) std::rethrow_exception(no_device);
    session.detail("device: " + context->description());
    session.results()["device"] = context->description();
    showPicture(session, *context, options.display, std::move(picture), log_average, options.output,
                how);
    session.finish();
}

} // namespace

Command bindTonemap(CLI::App& root) {
    CLI::App* app = root.add_subcommand("tonemap", "Make an HDR image one to look at");
    auto options = std::make_shared<TonemapOptions>();
    app->add_option("IN", options->input,
                    "The image: a file, - for standard input, or builtin:sky, builtin:compass, "
                    "builtin:furnace")
        ->required()
        ->type_name("");
    app->add_option("--layer", options->layer,
                    "Layer, part or channel of an EXR to read; single channels are read as grey")
        ->type_name("NAME")
        ->group("Input");
    app->add_flag("--repair", options->repair,
                  "Mend NaN, infinite and negative pixels from their neighbours (default: NaN and "
                  "infinite are refused, negative kept)")
        ->group("Input");
    bindDisplay(*app, options->display);
    bindImageOutput(*app, options->output);
    bindCommon(*app, options->common);
    return {app, [options] { runTonemap(*options); }};
}

} // namespace ibl
