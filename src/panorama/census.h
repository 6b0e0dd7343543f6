// What is in a probe: bad pixels, range, energy, sun.
#pragma once

#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/panorama.h"

#include <limits>

namespace ibl {

/// Pixels with something wrong in at least one channel.
struct BadPixels {
    long count = 0;
    V2i first{0, 0};   ///< the first one, in rows from the top
    float extreme = 0; ///< the worst value (most negative; for Inf its sign)
    V2i extreme_at{0, 0};
};

/// Sums weigh a pixel by its solid angle, skip what is not finite and pass over the cells of a
/// cross that hold no face. Energy is radiance times solid angle, W / m^2 for radiance in W / (m^2
/// sr).
struct Census {
    BadPixels nan;
    BadPixels infinite;
    BadPixels negative; ///< finite and below zero

    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    V3d min{kNone}; ///< of finite values, a channel; NaN where there are none
    V3d max{kNone};
    V3d mean{kNone};
    V3d energy{0, 0, 0}; ///< total of them over the sphere

    V2i sun_at{-1, -1}; ///< the pixel of greatest luminance (0.2125, 0.7154, 0.0721), if any
    V3d sun_direction{kNone};
    V3d sun_radiance{kNone};
};

/// Counts over the whole panorama; the same for any number of threads (0: the machine's).
Census takeCensus(const Panorama& panorama, int threads = 0);

/// Whether every pixel is finite and none below zero; a -0 is taken for one that is, and so are bad
/// values in a cross's blank cells. Far quicker than a census, for probes that need none.
bool surelyValid(const Image& image, int threads = 0);

/// Mends NaN, Inf and negative values channel by channel and returns the number of pixels touched.
///   negative        0, the nearest radiance there is (they are compression's undershoot)
///   +Inf            the largest of its valid neighbours (it was too bright to be stored)
///   NaN, -Inf       the mean of its valid neighbours
/// Neighbours are the eight around it on the same face, or around the seam of a lat-long; patches
/// are mended from their rim inwards. A face with nothing valid takes the mean over the panorama.
/// Throws Error (input) naming `subject` when a channel has no valid value at all.
long repair(std::string_view subject, Panorama& panorama);

} // namespace ibl
