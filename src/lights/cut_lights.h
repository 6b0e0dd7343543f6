// From a probe to lights with a known error.
#pragma once

#include "core/progress.h"
#include "image/image.h"
#include "lights/cut_tree.h"
#include "lights/light.h"

#include <optional>
#include <string_view>

namespace ibl {

enum class LightMethod { median, variance, importance };

/// The method's name, and back; none for another name.
std::string_view methodName(LightMethod method);
std::optional<LightMethod> methodFromName(std::string_view name);

inline constexpr int kMostLights = 65536;

struct LightRequest {
    LightMethod method = LightMethod::median;
    int count = 64;
    /// Instead of `count`: the first cut of the sequence, one cut after the other from the whole
    /// sphere on, whose lights have at most this irradiance error. No fewer cuts of that sequence
    /// have it. Not with LightMethod::importance.
    std::optional<double> max_error;
    LightPlacement placement = LightPlacement::centroid; ///< matched: not with max_error
    /// Lights of the frame before, by the same method. Their regions are kept where they still
    /// cover the probe and their error is at most a quarter above that of a new cut.
    const LightSet* previous = nullptr;
    TellProgress progress; ///< of the search for max_error
};

/// Lights of `latlong` (three channels, finite): from brightest to dimmest, or in the order of the
/// frame before; at most as many as pixels have energy, none for a black probe. They add up to the
/// probe's integral in each channel, negative pixels included. `source` of the result is empty.
/// Throws Error (accuracy) when no number of lights up to kMostLights has the asked error.
LightSet cutLights(const Image& latlong, const LightRequest& request, int threads);

/// The irradiance error of a lamp and what its removal leaves, against the probe.
double lampError(const Image& probe, const Image& residual, const Light& lamp, int threads);

} // namespace ibl
