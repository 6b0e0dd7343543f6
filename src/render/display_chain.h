// From a scene-linear picture to display light: exposure, lens effects, tone map.
#pragma once

#include "image/image.h"
#include "image/ocio.h"
#include "render/egl_context.h"
#include "render/tone_map.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace ibl {

/// What the chain does to a picture. Effects have a weight from 0 (none) to 1: that share of the
/// light, of bright parts alone or of everything, is taken out of the picture and laid over it
/// again, spread; so no effect makes or loses light, but for streaks that leave the picture.
/// Lengths are shares of the picture's height. The three weights of bloom, streaks and glare are 1
/// in all at most.
struct DisplayOptions {
    ToneMap tone_map = ToneMap::none;
    Per per = Per::channel; ///< of curves
    ToneParameters parameters{};
    double key = 0.18; ///< of reinhardLocal: the exposed value of the log-average
    std::optional<DisplayTransform> transform; ///< of ToneMap::display

    double threshold = 1; ///< exposed luminance from which light is bright: of bloom and streaks
    double bloom = 0;     ///< Gaussians of all widths, as much of each octave, up to
    double bloom_radius = 0.05; ///< this standard deviation
    double glare = 0;   ///< of everything, as bloom but without an end: falls off as 1 / distance^2
                        ///< (Spencer et al. 1995)
    double streaks = 0; ///< rays from bright parts,
    int streak_count = 6;
    double streak_length = 0.25;      ///< at which they have faded to
    double streak_attenuation = 0.02; ///< of their beginning
    double streak_angle = 0;          ///< degrees, counter-clockwise from the right
    double vignette = 0; ///< towards cos^4 of a lens whose corners stand at 45 degrees; takes light
};

/// The passes of a chain on a device, made when first needed. The context must be current and
/// outlive it. Throws Error: usage for weights, parameters or exposures out of range, for glow on
/// pictures with alpha, and for pictures too large for the device; input for shaders of the folder
/// that do not compile.
class DisplayChain {
public:
    /// Pictures are uploaded in tiles of at most `tile_edge` pixels a side.
    DisplayChain(const EglContext& context, const DisplayOptions& options,
                 std::optional<std::filesystem::path> shader_folder = std::nullopt,
                 int tile_edge = 4096);
    ~DisplayChain();
    DisplayChain(DisplayChain&&) noexcept;
    DisplayChain& operator=(DisplayChain&&) noexcept;

    /// Makes the passes that a picture without alpha needs, machine code of software rasterisers
    /// included, so that apply() finds them ready. For while it has to be waited for.
    void warmUp(int threads = 0);

    /// Puts the picture (3 or 4 channels, scene-linear, premultiplied) times 2^exposure through the
    /// chain, in its place: linear display light, display-encoded after ToneMap::display. NaN
    /// counts as 0 and what is beyond floats as their largest. `threads` as everywhere.
    void apply(Image& picture, double exposure, int threads = 0);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace ibl
