// How bright a picture is, and how an eye comes to see it.
#pragma once

#include "image/image.h"

#include <cstddef>

namespace ibl {

/// What is in a picture's pixels: bad ones, and the log-average.
struct PictureCensus {
    std::size_t nan = 0, infinite = 0, negative = 0; ///< pixels with such a channel, in this order
    /// exp(mean(ln(delta + L))), L the luminance (0.2126, 0.7152, 0.0722), 0 where it is negative
    /// or no number, largest float where it is infinite (Reinhard et al. 2002, eq. 1, without the
    /// misprint of the 1/N). With alpha the colours are premultiplied and count without it, weighed
    /// by it; black that is not opaque, as shadows are on a ground without background, does not
    /// count; delta where nothing does.
    double log_average = 0;
};

/// Exact but for rounding in double, and the same for any number of threads. delta >= 1e-30.
PictureCensus takePictureCensus(const Image& image, double delta, int threads);

/// The log-average that an eye adapted to `before` has come to one frame later, when it looks at
/// `now`: in stops, what was missing halves every `half_life` frames (0: it adapts at once).
double adapted(double before, double now, double half_life);

} // namespace ibl
