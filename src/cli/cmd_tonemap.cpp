#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/display_options.h"
#include "cli/session.h"

#include "core/error.h"
#include "image/read.h"
#include "panorama/builtin.h"
#include "panorama/census.h"
#include "render/exposure.h"

#include <chrono>
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

/// The picture and what is in it; the seconds that this took.
struct Reading {
    ImageFile file;
    PictureCensus census;
    double seconds_reading = 0, seconds_screening = 0;
};

PictureCensus screen(const Image& picture, const TonemapOptions& options) {
    return takePictureCensus(picture, deltaOf(options.display), options.common.threads);
}

Reading readPicture(const TonemapOptions& options) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    const auto begin = Clock::now();
    Reading reading;
    if (isBuiltin(options.input)) {
        reading.file.image = builtinProbe(options.input, 512, options.common.threads).image;
    } else {
        ReadOptions how;
        how.layer = options.layer;
        how.keep_alpha = true;
        how.threads = options.common.threads;
        reading.file = readImage(options.input, how);
    }
    const auto read = Clock::now();
    reading.census = screen(reading.file.image, options);
    reading.seconds_reading = seconds(read - begin);
    reading.seconds_screening = seconds(Clock::now() - read);
    return reading;
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

/// Says what was read; mends or refuses what is not finite.
void tellReading(Session& session, const TonemapOptions& options, Reading& reading) {
    if (!isBuiltin(options.input)) session.addSeconds("read", reading.seconds_reading);
    session.addSeconds("screen", reading.seconds_screening);
    for (const std::string& text : reading.file.notes)
        session.note(options.input, text);
    PictureCensus& found = reading.census;
    if (options.repair && found.nan + found.infinite + found.negative > 0) {
        mendPicture(session, options.input, reading.file.image);
        found = session.stage("screen", [&] { return screen(reading.file.image, options); });
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
}

void runTonemap(const TonemapOptions& options) {
    Session session("tonemap", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    requireFitting(options.display, options.output);
    if (!isBuiltin(options.input)) session.addInput(options.input);
    // The device is found and the passes are made while the picture is read, on this thread, where
    // the context must be.
    std::future<Reading> pending =
        std::async(std::launch::async, [&] { return readPicture(options); });
    std::optional<EglContext> context;
    std::optional<PictureDisplay> display;
    std::exception_ptr failure;
    try {
        context.emplace();
        display.emplace(session, *context, options.display);
        display->warmUp();
    } catch (...) {
        failure = std::current_exception();
    }
    Reading reading = pending.get(); // what is wrong with the picture is said first
    tellReading(session, options, reading);
    if (failure) std::rethrow_exception(failure);
    session.detail("device: " + context->description());
    session.results()["device"] = context->description();
    Image& picture = reading.file.image;
    display->show(picture, reading.census.log_average);
    display->handOn();
    session.stage("write", [&] {
        const std::string& path = options.output.output;
        const WriteLosses losses =
            writeShown(session.outputs(), path, picture, options.display, how, session.threads());
        noteShown(session, path, losses, options.display, how,
                  static_cast<double>(picture.width) * picture.height);
        session.addOutput(path);
    });
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
