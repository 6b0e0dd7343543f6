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

/// Refuses what has no effect or does not fit together, before any work is done.
void requireFitting(const DisplayArguments& arguments, const ImageOutputOptions& output);

/// The delta of the log-average.
double deltaOf(const DisplayArguments& arguments);

/// Sends a scene-linear picture through the chain and adds it to the outputs, and the state of
/// adaptation, if one is kept. `log_average` is that of the picture, where it is known already.
void showPicture(Session& session, const EglContext& context, const DisplayArguments& arguments,
                 Image picture, std::optional<double> log_average, const ImageOutputOptions& output,
                 const WriteOptions& how,
                 std::optional<std::filesystem::path> shader_folder = std::nullopt);

} // namespace ibl
