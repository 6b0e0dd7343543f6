// What a running command shares with every other: messages, stages, the set of outputs, the report.
#pragma once

#include "cli/arguments.h"

#include "core/progress.h"
#include "image/output_set.h"
#include "panorama/panorama.h"
#include "panorama/probe_file.h"
#include "panorama/resample.h"

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ibl {

class Session {
public:
    /// Refuses unwritable combinations of the common options (a depfile to standard output).
    Session(std::string command, const CommonOptions& common);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const CommonOptions& common() const { return common_; }
    int threads() const { return common_.threads; }

    /// A line on standard error at the end, unless --quiet, and in the report. A run that fails
    /// says nothing but why.
    void note(std::string_view subject, std::string_view text);
    /// A line on standard error with --verbose.
    void detail(std::string_view text) const;

    /// Shows on a terminal how far a stage is, once it lasts; empty without a terminal or with
    /// --quiet.
    TellProgress progress(const char* name) const;

    /// Runs `body` as a named stage whose seconds go into the report.
    template <class Body>
    auto stage(const char* name, Body body) {
        const StageTimer timer(*this, name);
        return body();
    }

    /// A file that the result depends on.
    void addInput(const std::string& path);

    /// Reads the probe, tells what is in it and refuses or mends what is not finite.
    ProbeFile readScreened(const ProbeOptions& options);
    /// Its pixels alone.
    Panorama readProbe(const ProbeOptions& options) { return readScreened(options).panorama; }

    /// Reads an image that is no probe, such as a texture, in a stage of that name; with alpha, if
    /// it has some and it is to be kept. NaN and infinite values are refused.
    Image readPicture(const std::string& path, const char* stage_name, bool keep_alpha = false);

    /// Reads the probe and says what was not plain in its file, whatever its pixels are.
    ProbeFile readUnscreened(const ProbeOptions& options);
    /// Mends what is not finite or negative and says how much it was.
    void mend(const std::string& subject, Panorama& panorama);

    /// Adds an image or a probe to the outputs and says what the format could not hold.
    void write(const std::string& path, const Panorama& panorama, const WriteOptions& options);
    void write(const std::string& path, const Image& image, const WriteOptions& options);
    /// A cube map with its levels in one container (writeCubeMap).
    void write(const std::string& path, std::span<const Image* const> levels,
               const WriteOptions& options);
    void writeText(const std::string& path, std::string_view text);

    OutputSet& outputs() { return outputs_; }
    void addOutput(const std::string& path) { output_names_.push_back(path); }
    /// Adds to a stage's seconds what was spent on it beside the others.
    void addSeconds(const char* stage, double seconds);

    /// The command's own part of the report.
    nlohmann::ordered_json& results();

    /// Writes report and depfile and gives all outputs their names.
    void finish();

private:
    class StageTimer {
    public:
        StageTimer(Session& session, const char* name);
        ~StageTimer();
        StageTimer(const StageTimer&) = delete;
        StageTimer& operator=(const StageTimer&) = delete;

    private:
        Session& session_;
        const char* name_;
        std::chrono::steady_clock::time_point begin_;
    };

    void screen(const std::string& subject, const Panorama& panorama);
    void reportLosses(const WriteLosses& losses, const std::string& path,
                      const WriteOptions& options);
    std::string reportText() const;
    std::string depfileText() const;

    std::string command_;
    CommonOptions common_;
    OutputSet outputs_;
    std::vector<std::string> input_names_;
    std::vector<std::string> probe_names_; ///< among them
    std::vector<std::string> output_names_;
    std::vector<std::string> notes_;
    std::vector<std::pair<std::string, double>> stages_;
    std::unique_ptr<nlohmann::ordered_json> results_;
};

/// The probe as a lat-long image: itself, or resampled to the height that keeps its resolution
/// (twice a face's edge). For what integrates over it pixels stay areas, which keeps the energy;
/// what is looked at may be interpolated.
Image latlongOf(Panorama&& probe, int threads, Enlarging enlarging = Enlarging::hold);

/// That height, of a probe that is no lat-long.
int latlongHeight(const Panorama& probe);

} // namespace ibl
