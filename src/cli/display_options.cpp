#include "cli/display_options.h"

#include "core/error.h"
#include "render/exposure.h"

#include <nlohmann/json.hpp>

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace ibl {
namespace {

constexpr double kStandardKey = 0.18; // middle grey
constexpr double kStandardDelta = 1e-5;

/// In lower case, without a dot.
std::string formatOf(const std::string& path, std::string format) {
    if (format.empty()) format = std::filesystem::path(path).extension().string();
    if (format.starts_with('.')) format.erase(0, 1);
    for (char& c : format)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return format;
}

bool isPng(const std::string& path, const std::string& format) {
    return formatOf(path, format) == "png";
}

void bindExposure(CLI::App& app, DisplayArguments& a) {
    app.add_option_function<std::string>(
           "--exposure",
           [&a](const std::string& text) {
               a.auto_exposure = text == "auto";
               if (a.auto_exposure) return;
               const char* end = text.data() + text.size();
               const auto [last, problem] = std::from_chars(text.data(), end, a.exposure);
               if (problem != std::errc() || last != end || !(std::abs(a.exposure) <= 64)) {
                   throw CLI::ValidationError("--exposure", "'" + text +
                                                                "' is neither auto nor a number "
                                                                "of stops from -64 to 64");
               }
           },
           "Stops: radiance is multiplied by 2^EV; auto: so that the log-average becomes the key "
           "(default 0)")
        ->type_name("EV|auto")
        ->group("Exposure");
    app.add_option("--key", a.key,
                   "What the log-average becomes: 0.045 of dark to 0.72 of bright scenes (default "
                   "0.18)")
        ->check(inRange(0.045, 0.72))
        ->type_name("K")
        ->group("Exposure");
    app.add_option("--delta", a.delta,
                   "Added to luminance ahead of its logarithm, for auto (default 1e-5)")
        ->check(inRange(1e-30, 1e30))
        ->type_name("D")
        ->group("Exposure");
    CLI::Option* adapt = app.add_option("--adapt", a.adapt,
                                        "Frames in which half of what the exposure lacks is made "
                                        "up for, with auto")
                             ->check(inRange(0.01, 1e6))
                             ->type_name("FRAMES")
                             ->group("Exposure");
    app.add_option(
           "--adapt-state", a.adapt_state,
           "JSON file that hands the adaptation on to the next run; made when there is none")
        ->needs(adapt)
        ->type_name("FILE")
        ->group("Exposure");
}

void bindToneMap(CLI::App& app, DisplayArguments& a) {
    std::vector<std::string> names;
    std::string help;
    for (const ToneMapInfo& info : toneMapTable()) {
        names.emplace_back(info.name);
        help +=
            (help.empty() ? "" : "; ") + std::string(info.name) + ": " + std::string(info.summary);
    }
    app.add_option_function<std::string>(
           "--tonemap", [&a](const std::string& n) { a.chain.tone_map = *toneMapFromName(n); },
           help + " (default none)")
        ->check(CLI::IsMember(names))
        ->type_name("NAME")
        ->group("Tone map");
    app.add_option_function<std::string>(
           "--per",
           [&a](const std::string& n) { a.per = n == "channel" ? Per::channel : Per::luminance; },
           "Apply the curve per channel or per luminance (default luminance for reinhard, channel "
           "for exponential, scurve and filmic)")
        ->check(CLI::IsMember({"channel", "luminance"}))
        ->type_name("WHAT")
        ->group("Tone map");
    for (const ToneMapInfo& info : toneMapTable()) {
        for (const ToneParameter& p : info.parameters) {
            const std::string name(p.name);
            if (app.get_option_no_throw("--" + name)) continue; // of an earlier map, too
            std::string help_text(p.summary);
            if (help_text.find("default") == std::string::npos) {
                char standard[32];
                std::snprintf(standard, sizeof standard, " (default %g)", p.standard);
                help_text += standard;
            }
            app.add_option_function<double>(
                   "--" + name, [&a, name](double value) { a.tone_parameters[name] = value; },
                   help_text)
                ->check(inRange(p.least, p.most))
                ->check(p.whole ? CLI::Validator(CLI::TypeValidator<int>()) : CLI::Validator())
                ->type_name(p.whole ? "N" : "X")
                ->group("Tone map");
        }
    }
    const auto text = [&](const char* name, std::string& value, const char* help_text) {
        app.add_option(name, value, help_text)->type_name("NAME")->group("Tone map");
    };
    text("--display", a.view.display, "Of display: which display (default: the config's)");
    text("--view", a.view.view, "Of display: which of its views (default: the display's)");
    text("--ocio-space", a.view.space,
         "Of display: the picture's colour space (default: the role scene_linear)");
    app.add_option("--ocio-config", a.view.config,
                   "Of display: OpenColorIO config (default: $OCIO; without it OpenColorIO's ACES "
                   "output transform)")
        ->type_name("FILE")
        ->group("Tone map");
}

void bindEffects(CLI::App& app, DisplayArguments& a) {
    DisplayOptions& o = a.chain;
    const auto number = [&](const char* name, double& value, double least, double most,
                            const char* type, const char* help) {
        return app.add_option(name, value, help)
            ->check(inRange(least, most))
            ->type_name(type)
            ->capture_default_str()
            ->group("Effects");
    };
    CLI::Option* bloom =
        number("--bloom", o.bloom, 0, 1, "W", "Share of bright light that is spread around");
    number("--bloom-radius", o.bloom_radius, 1e-3, 1, "R",
           "Deviation of its widest part, over the picture's height")
        ->needs(bloom);
    CLI::Option* streaks =
        number("--streaks", o.streaks, 0, 1, "W", "Share of bright light that goes into rays");
    app.add_option("--streak-count", o.streak_count, "Number of rays")
        ->check(inRange(1, 64))
        ->type_name("N")
        ->capture_default_str()
        ->needs(streaks)
        ->group("Effects");
    number("--streak-length", o.streak_length, 0.01, 2, "L",
           "Their length over the picture's height")
        ->needs(streaks);
    number("--streak-attenuation", o.streak_attenuation, 1e-4, 0.9, "A",
           "What is left of a ray at its length")
        ->needs(streaks);
    number("--streak-angle", o.streak_angle, -360, 360, "DEG",
           "Direction of the first, counter-clockwise from the right")
        ->needs(streaks);
    number("--glare", o.glare, 0, 1, "W", "Share of all light that veils the whole picture");
    number("--threshold", o.threshold, 0, 1e30, "T",
           "Exposed luminance from which light is bright, for bloom and streaks");
    number("--vignette", o.vignette, 0, 1, "W", "Weight of the fall-off towards the corners");
}

} // namespace

void bindDisplay(CLI::App& app, DisplayArguments& arguments) {
    bindExposure(app, arguments);
    bindToneMap(app, arguments);
    bindEffects(app, arguments);
    app.add_option("--bits", arguments.bits, "Bits a channel of PNG files: 8 (default) or 16")
        ->check(CLI::IsMember({8, 16}))
        ->type_name("N")
        ->group("Output");
    app.add_flag("--dither", arguments.dither,
                 "Mix neighbouring codes of PNG files by a fixed pattern, against bands")
        ->group("Output");
}

double deltaOf(const DisplayArguments& arguments) {
    return arguments.delta.value_or(kStandardDelta);
}

bool isExr(const ImageOutputOptions& output) {
    return formatOf(output.output, output.format) == "exr";
}

void requireExr(const ImageOutputOptions& output, const std::string& option) {
    if (isExr(output)) return;
    throw Error(ExitCode::usage, option + " is of EXR files; leave it out, or write .exr");
}

void requireFitting(const DisplayArguments& a, const ImageOutputOptions& output, int frames) {
    const auto refuse = [](bool idle, const std::string& option, const std::string& why) {
        if (idle) throw Error(ExitCode::usage, option + " " + why + "; leave it out");
    };
    const ToneMapInfo& info = toneMapInfo(a.chain.tone_map);
    const std::string name(info.name);
    refuse(a.key && !a.auto_exposure && info.map != ToneMap::reinhardLocal, "--key",
           "is of --exposure auto and of --tonemap reinhard-local");
    refuse(a.delta && !a.auto_exposure, "--delta", "is of --exposure auto");
    refuse(a.adapt > 0 && !a.auto_exposure, "--adapt", "is of --exposure auto");
    if (a.adapt > 0 && a.adapt_state.empty() && frames == 1) {
        throw Error(ExitCode::usage,
                    "--adapt: there is no frame before this one; hand its state on "
                    "with --adapt-state");
    }
    refuse(a.adapt_state == "-", "--adapt-state", "does not go to standard output");
    refuse(a.per && info.curve.empty(), "--per", "does nothing for the tone map " + name);
    for (const auto& [given, value] : a.tone_parameters) {
        const bool fits = std::any_of(info.parameters.begin(), info.parameters.end(),
                                      [&](const ToneParameter& p) { return p.name == given; });
        refuse(!fits, "--" + given, "does nothing for the tone map " + name);
    }
    const DisplayView& v = a.view;
    refuse((info.map != ToneMap::display) &&
               !(v.config.empty() && v.display.empty() && v.view.empty() && v.space.empty()),
           "--display, --view, --ocio-space or --ocio-config", "is of --tonemap display");
    refuse(a.chain.bloom + a.chain.streaks == 0 && a.chain.threshold != DisplayOptions().threshold,
           "--threshold", "is of --bloom and --streaks");
    const bool png = isPng(output.output, output.format);
    refuse((a.bits || a.dither) && !png, "--bits or --dither", "is of PNG files");
    if (info.map == ToneMap::display && !png) {
        throw Error(ExitCode::usage,
                    "--tonemap display: makes display-encoded values; write a PNG");
    }
}

namespace {

/// The log-average that the state file hands on, unless there is no file yet.
std::optional<double> readAdaptation(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::nullopt;
    std::ifstream file(path);
    const auto state = nlohmann::json::parse(file, nullptr, false);
    if (state.is_object() && state.contains("log_average") && state["log_average"].is_number()) {
        const double value = state["log_average"];
        if (value > 0 && std::isfinite(value)) return value;
    }
    throw inputError(path, "is no state of adaptation; delete it to begin anew");
}

DisplayOptions chainOf(const DisplayArguments& a) {
    DisplayOptions chain = a.chain;
    const ToneMapInfo& info = toneMapInfo(chain.tone_map);
    chain.per = a.per.value_or(info.per);
    chain.key = a.key.value_or(kStandardKey);
    chain.parameters = standardParameters(chain.tone_map);
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
        const auto given = a.tone_parameters.find(std::string(info.parameters[i].name));
        if (given != a.tone_parameters.end()) chain.parameters[i] = given->second;
    }
    return chain;
}

} // namespace

PictureDisplay::PictureDisplay(Session& session, const EglContext& context,
                               const DisplayArguments& arguments,
                               std::optional<std::filesystem::path> shader_folder)
    : session_(session), arguments_(arguments) {
    if (!arguments.adapt_state.empty()) adapted_to_ = readAdaptation(arguments.adapt_state);
    DisplayOptions options = chainOf(arguments);
    if (options.tone_map == ToneMap::display) {
        options.transform =
            session.stage("ocio", [&] { return loadDisplayTransform(arguments.view); });
        for (const std::string& file : options.transform->files)
            session.addInput(file);
    }
    chain_.emplace(context, options, std::move(shader_folder));
}

void PictureDisplay::warmUp() {
    session_.stage("warm up", [&] { chain_->warmUp(session_.threads()); });
}

double PictureDisplay::exposureOf(const Image& picture, std::optional<double> log_average) {
    const DisplayArguments& a = arguments_;
    if (!a.auto_exposure) return a.exposure;
    double average = log_average ? *log_average : session_.stage("expose", [&] {
        return takePictureCensus(picture, deltaOf(a), session_.threads()).log_average;
    });
    session_.results()["log_average"] = average;
    if (a.adapt > 0) {
        if (adapted_to_) average = adapted(*adapted_to_, average, a.adapt);
        session_.results()["adapted_log_average"] = average;
        adapted_to_ = average;
    }
    return std::log2(a.key.value_or(kStandardKey) / average);
}

double PictureDisplay::show(Image& picture, std::optional<double> log_average) {
    const double exposure = exposureOf(picture, log_average);
    session_.results()["exposure"] = exposure;
    session_.stage("display", [&] { chain_->apply(picture, exposure, session_.threads()); });
    return exposure;
}

void PictureDisplay::handOn() {
    if (arguments_.adapt_state.empty()) return;
    nlohmann::ordered_json state;
    state["log_average"] = *adapted_to_;
    session_.writeText(arguments_.adapt_state, state.dump(2) + "\n");
}

WriteLosses writeShown(OutputSet& outputs, const std::string& path, const Image& picture,
                       const DisplayArguments& arguments, const WriteOptions& how, int threads) {
    if (!isPng(path, how.format)) {
        WriteOptions options = how;
        options.threads = threads;
        return writeImage(outputs, path, picture, options);
    }
    const PngOptions png{arguments.bits.value_or(8), arguments.dither,
                         arguments.chain.tone_map == ToneMap::display};
    return writePng(outputs.add(path), picture, png, threads);
}

void noteShown(Session& session, const std::string& path, const WriteLosses& losses,
               const DisplayArguments& arguments, const WriteOptions& how, double pixels) {
    std::vector<std::string> lines = describeLosses(losses, path, how);
    if (losses.bright_pixels > 0) {
        char share[64];
        std::snprintf(share, sizeof share, " (%.3g %% of the pixels)",
                      100 * static_cast<double>(losses.bright_pixels) / pixels);
        lines[0] += share;
        if (!arguments.auto_exposure) {
            lines[0] += "; try --exposure auto";
        } else if (arguments.chain.tone_map == ToneMap::none) {
            lines[0] += "; try a --tonemap";
        }
    }
    for (const std::string& line : lines)
        session.note(path, line);
}

} // namespace ibl
