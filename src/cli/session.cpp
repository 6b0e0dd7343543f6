#include "cli/session.h"

#include "core/error.h"
#include "image/read.h"
#include "panorama/builtin.h"
#include "panorama/census.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstring>

#include <unistd.h>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

std::string place(const V2i& pixel) {
    return "(" + std::to_string(pixel.x) + ", " + std::to_string(pixel.y) + ")";
}

std::string counted(long count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? " pixel" : " pixels");
}

/// A file name as a makefile's rule takes it.
std::string makeEscaped(const std::string& name) {
    std::string escaped;
    for (const char c : name) {
        if (c == ' ' || c == '#' || c == '\\' || c == ':') escaped += '\\';
        if (c == '$') escaped += '$';
        escaped += c;
    }
    return escaped;
}

/// A Radiance file holds mantissas and powers of two, without signs: no pixel can be bad as long as
/// nothing was divided out.
bool isValidByFormat(const ProbeFile& file) {
    return file.metadata.format == "radiance" && file.files.size() <= 1 &&
           file.metadata.exposure == 1 && file.metadata.colour_correction == V3d(1);
}

std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

} // namespace

Session::StageTimer::StageTimer(Session& session, const char* name)
    : session_(session), name_(name), begin_(std::chrono::steady_clock::now()) {}

Session::StageTimer::~StageTimer() {
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
    session_.addSeconds(name_, taken.count());
}

void Session::addSeconds(const char* stage, double seconds) {
    stages_.emplace_back(stage, seconds);
    char text[96];
    std::snprintf(text, sizeof text, "%s: %.1f ms", stage, 1e3 * seconds);
    detail(text);
}

Session::Session(std::string command, const CommonOptions& common)
    : command_(std::move(command)), common_(common), results_(std::make_unique<Json>()) {
    for (const std::string* file : {&common_.report, &common_.depfile}) {
        if (*file == "-") {
            throw Error(ExitCode::usage,
                        "--report and --depfile do not go to standard output; name a file");
        }
    }
}

Session::~Session() = default;

void Session::note(std::string_view subject, std::string_view text) {
    const std::string line =
        Error(ExitCode::done, std::string(subject) + ": " + std::string(text)).what();
    notes_.push_back(line);
}

void Session::detail(std::string_view text) const {
    if (common_.verbose) std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
}

TellProgress Session::progress(const char* name) const {
    if (common_.quiet || isatty(STDERR_FILENO) == 0) return {};
    const auto begin = std::chrono::steady_clock::now();
    return [name, begin](double done) {
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        if (taken.count() < 1) return;
        // The line is wiped when all is done.
        if (done < 1) {
            std::fprintf(stderr, "\r%s %d %%", name, static_cast<int>(100 * done));
        } else {
            std::fprintf(stderr, "\r%*s\r", static_cast<int>(std::strlen(name)) + 6, "");
        }
        std::fflush(stderr);
    };
}

namespace {

bool isSameFile(const std::string& a, const std::string& b) {
    std::error_code ignored;
    return a != "-" && !a.empty() && std::filesystem::equivalent(a, b, ignored);
}

} // namespace

void Session::addInput(const std::string& path) {
    for (const auto& [option, output] :
         {std::pair{"--report", common_.report}, {"--depfile", common_.depfile}}) {
        if (!isSameFile(output, path)) continue;
        throw Error(ExitCode::usage, std::string(option) + ": " + output +
                                         " is read as well and would be lost; name another file");
    }
    input_names_.push_back(path);
}

ProbeFile Session::readUnscreened(const ProbeOptions& options) {
    ReadProbeOptions how;
    how.from = options.from;
    how.layer = options.layer;
    how.threads = threads();
    ProbeFile file = stage("read", [&] { return ibl::readProbe(options.input, how); });
    for (const std::string& name : file.files) {
        addInput(name);
        probe_names_.push_back(name);
    }
    for (const std::string& text : file.notes)
        note(options.input, text);
    return file;
}

Image Session::readPicture(const std::string& path, const char* stage_name, bool keep_alpha) {
    addInput(path);
    ReadOptions how;
    how.keep_alpha = keep_alpha;
    how.threads = threads();
    how.finite = true;
    ImageFile file = stage(stage_name, [&] { return readImage(path, how); });
    for (const std::string& text : file.notes)
        note(path, text);
    return std::move(file.image);
}

ProbeFile Session::readScreened(const ProbeOptions& options) {
    ProbeFile file = readUnscreened(options);
    if (options.repair) {
        mend(options.input, file.panorama);
    } else if (!isValidByFormat(file)) {
        stage("screen", [&] { screen(options.input, file.panorama); });
    }
    return file;
}

void Session::screen(const std::string& subject, const Panorama& panorama) {
    if (surelyValid(panorama.image, threads())) return;
    const Census census = takeCensus(panorama, threads());
    if (census.nan.count + census.infinite.count > 0) {
        const BadPixels& first = census.nan.count > 0 ? census.nan : census.infinite;
        throw inputError(subject, counted(census.nan.count, "NaN") + " and " +
                                      counted(census.infinite.count, "infinite") +
                                      ", the first at " + place(first.first) +
                                      "; --repair mends them");
    }
    if (census.negative.count > 0) {
        note(subject, counted(census.negative.count, "negative") + " kept, down to " +
                          shortNumber(census.negative.extreme) + " at " +
                          place(census.negative.extreme_at) + "; --repair sets them to 0");
    }
}

void Session::mend(const std::string& subject, Panorama& panorama) {
    if (surelyValid(panorama.image, threads())) return;
    const Census census = takeCensus(panorama, threads());
    if (census.nan.count + census.infinite.count + census.negative.count == 0) return;
    const long mended = stage("repair", [&] { return repair(subject, panorama); });
    note(subject, counted(mended, "bad") + " mended (" + std::to_string(census.nan.count) +
                      " NaN, " + std::to_string(census.infinite.count) + " infinite, " +
                      std::to_string(census.negative.count) + " negative)");
}

void Session::reportLosses(const WriteLosses& losses, const std::string& path,
                           const WriteOptions& options) {
    for (const std::string& text : describeLosses(losses, path, options))
        note(path, text);
}

void Session::write(const std::string& path, const Panorama& panorama,
                    const WriteOptions& options) {
    reportLosses(writeProbe(outputs_, path, panorama, options), path, options);
    if (isCubeContainer(path, options)) return addOutput(path);
    for (const std::string& name : probeFileNames(path, panorama.layout))
        addOutput(name);
}

void Session::write(const std::string& path, const Image& image, const WriteOptions& options) {
    reportLosses(writeImage(outputs_, path, image, options), path, options);
    addOutput(path);
}

void Session::write(const std::string& path, std::span<const Image* const> levels,
                    const WriteOptions& options) {
    reportLosses(writeCubeMap(outputs_, path, levels, options), path, options);
    addOutput(path);
}

void Session::writeText(const std::string& path, std::string_view text) {
    for (const std::string& probe : probe_names_) {
        if (!isSameFile(path, probe)) continue;
        throw Error(ExitCode::usage, path + ": is the probe and would be lost; name another file");
    }
    outputs_.add(path).write(text);
    addOutput(path);
}

Json& Session::results() {
    return *results_;
}

std::string Session::reportText() const {
    Json root;
    root["command"] = command_;
    root["inputs"] = input_names_;
    root["outputs"] = output_names_;
    root["notes"] = notes_;
    Json& seconds = root["seconds"] = Json::object();
    for (const auto& [name, taken] : stages_) {
        seconds[name] = seconds.value(name, 0.0) + taken;
    }
    root["results"] = *results_;
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Session::depfileText() const {
    std::string text;
    for (const std::string& name : output_names_) {
        if (name != "-") text += (text.empty() ? "" : " ") + makeEscaped(name);
    }
    text += ":";
    for (const std::string& name : input_names_) {
        if (name != "-") text += " " + makeEscaped(name);
    }
    return text + "\n";
}

void Session::finish() {
    if (!common_.report.empty()) outputs_.add(common_.report).write(reportText());
    if (!common_.depfile.empty()) outputs_.add(common_.depfile).write(depfileText());
    outputs_.commit();
    if (common_.quiet) return;
    for (const std::string& line : notes_)
        std::fprintf(stderr, "ibltool: %s\n", line.c_str());
}

int latlongHeight(const Panorama& probe) {
    const int size = *layoutSize(probe.layout, probe.image.width, probe.image.height);
    const bool like_latlong = probe.layout == Layout::exrLatlong || isSquareMap(probe.layout);
    return like_latlong ? size : 2 * size;
}

Image latlongOf(Panorama&& probe, int threads, Enlarging enlarging) {
    if (probe.layout == Layout::latlong) return std::move(probe.image);
    return resample(probe, Layout::latlong, latlongHeight(probe), threads, enlarging).image;
}

} // namespace ibl
