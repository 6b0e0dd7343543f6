// What a lat-long leaves of a probe that has its pixels' edges elsewhere.
//
// A probe of another layout is read into a lat-long of finer pixels before it is convolved, which
// keep its first moments (panorama/latlong_moments.h). What that leaves falls by 8 to 16 times from
// one lat-long to one of twice as many rows, measured on crosses, ball maps, octahedral maps and
// OpenEXR's lat-longs of a night with lamps, for GGX 0.2 and 0.1.
#pragma once

#include "convolve/prefilter.h"

#include <span>
#include <vector>

namespace ibl {

/// Relative to a map: bounds as PrefilterResult has them.
struct ReadingError {
    double bound = 0;
    double worst = 0;
    double estimate = 0; ///< if the error falls as above
};

/// Of each request, measured on the lat-long alone, of even width and height: by how much the map
/// would change had the probe been read into half as many rows, divided by what the error falls by.
/// In harmonics, as far as the lobe and the map's texels see them, and beyond that by the energy
/// that is left. Mirrors: none, which are filtered from the probe itself. Of lobes that see its own
/// texels (near_own_texels.h) only what harmonics hold comes from the lat-long, and with
/// `reference` nothing. Throws Error (input) on values that are not finite.
std::vector<ReadingError> readingErrors(const Image& latlong, const Panorama& source,
                                        std::span<const PrefilterRequest> requests, bool reference,
                                        int threads);

} // namespace ibl
