// What a lat-long leaves of a probe that has its pixels' edges elsewhere.
//
// A probe of another layout is read into a lat-long of finer pixels before it is convolved, each
// the mean of what it covers. Where edges of the probe's pixels cross it, light moves by up to half
// its width, most of it from the bright side to the dark one: to a lobe that is a blur, whose error
// falls with the square of the pixels' width (by 3.5 to 4.5 a halving, measured on faces, ball maps
// and octahedral maps of two probes for Lambert and GGX 0.15 and 0.3).
#pragma once

#include "convolve/prefilter.h"

#include <span>
#include <vector>

namespace ibl {

/// Relative to a map: bounds as PrefilterResult has them.
struct ReadingError {
    double bound = 0;
    double worst = 0;
    double estimate = 0; ///< a third of the bound, if the error falls as above
};

/// Of each request, measured on the lat-long alone: by how much the map would change had the probe
/// been read into half as many rows, whose pixels are the means of 2 x 2 of these. In harmonics, as
/// far as the lobe and the map's texels see them, and beyond that by the energy that is left.
/// Mirrors: none, which are filtered from the probe itself. Throws Error (input) on values that are
/// not finite.
std::vector<ReadingError> readingErrors(const Image& latlong,
                                        std::span<const PrefilterRequest> requests, int threads);

} // namespace ibl
