// The sun, or a lamp, taken out of a probe.
#pragma once

#include "image/image.h"
#include "lights/light.h"

#include <string_view>

namespace ibl {

struct Lamp {
    Light light;    ///< with angular_radius; its irradiance is what the residual lacks
    Image residual; ///< the probe without it
};

/// The lamp about the brightest pixel of a lat-long (three channels, finite).
///
/// The surroundings are the median luminance within 60 degrees of the peak. The lamp is the
/// connected set of pixels (eight neighbours, across the seam and the poles) above the geometric
/// mean of peak and surroundings, or a thousandth of the peak where that is more, and the pixels
/// that touch it, which it may cover in part (or which a codec made ring). These pixels take the
/// median, channel by channel, of the pixels around them; what they lose is the light. Its
/// direction is the centroid of the luminance lost. Its solid angle is that of the pixels with at
/// least half the lamp's mean luminance (weighted by energy), and the angular radius that of a disc
/// of that solid angle.
///
/// Throws Error (input) naming `subject` when there is no lamp: the peak is below 20 times the
/// surroundings, or the lamp would be wider than 20 degrees in radius.
Lamp findLamp(const Image& latlong, std::string_view subject);

} // namespace ibl
