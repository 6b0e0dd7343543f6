// Options of the commands that make pictures to look at, and what they do with them.
#pragma once

#include "cli/session.h"

#include "image/png.h"
#include "render/display_chain.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace ibl {

struct DisplayArguments {
    DisplayOptions chain; ///< `per`, `parameters`, `key` and `transform` follow from what is below
    double exposure = 0;  ///< stops; of auto exposure what is meant is `key`
    bool auto_exposure = false;
    std::optional<double> key;   ///< else 0.18
    std::optional<double> delta; ///< else 1e-5
    double adapt = 0;            ///< half-life in frames
    std::string adapt_state;     ///< file
    std::optional<Per> per;
    std::map<std::string, double> tone_parameters; ///< those given, by name
    DisplayView view;
    std::optional<int> bits;
    bool dither = false;
};

/// Exposure, tone map, effects and pixels of PNG files.
void bindDisplay(CLI::App& app, DisplayArguments& arguments);

/// Refuses what has no effect or does not fit together, before any work is done. `frames`: how many
/// are shown in turn.
void requireFitting(const DisplayArguments& arguments, const ImageOutputOptions& output,
                    int frames = 1);

/// Refuses an option that EXR files alone have.
bool isExr(const ImageOutputOptions& output);
void requireExr(const ImageOutputOptions& output, const std::string& option);

/// The delta of the log-average.
double deltaOf(const DisplayArguments& arguments);

/// What makes scene-linear pictures ones to look at: exposure and display chain, for one picture or
/// for frames in turn, to which the eye adapts.
class PictureDisplay {
public:
    /// Reads the state of adaptation and the OpenColorIO config, if there are such.
    PictureDisplay(Session& session, const EglContext& context, const DisplayArguments& arguments,
                   std::optional<std::filesystem::path> shader_folder = std::nullopt);

    /// As DisplayChain's.
    void warmUp();

    /// Sends a picture through the chain, in its place, and returns the stops that it was exposed
    /// by. `log_average` is that of the picture, where it is known already.
    double show(Image& picture, std::optional<double> log_average = std::nullopt);

    /// Adds the state of adaptation to the outputs, if one is kept.
    void handOn();

private:
    double exposureOf(const Image& picture, std::optional<double> log_average);

    Session& session_;
    const DisplayArguments& arguments_;
    std::optional<double> adapted_to_; ///< log-average
    std::optional<DisplayChain> chain_;
};

/// Adds a shown picture to the set. `threads` as everywhere.
WriteLosses writeShown(OutputSet& outputs, const std::string& path, const Image& picture,
                       const DisplayArguments& arguments, const WriteOptions& how, int threads);

/// Says once, of a picture or of all frames together, what the file's format could not hold. A PNG
/// says of how many of its `pixels` that is, and what would keep them.
void noteShown(Session& session, const std::string& path, const WriteLosses& losses,
               const DisplayArguments& arguments, const WriteOptions& how, double pixels);

} // namespace ibl
