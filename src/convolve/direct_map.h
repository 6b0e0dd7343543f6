// Maps by sums over a probe's pixels, with no part of them in harmonics.
#pragma once

#include "convolve/narrow.h"
#include "convolve/near_weights.h"
#include "convolve/prefilter.h"
#include "core/progress.h"

#include <vector>

namespace ibl {

/// A lat-long to be convolved and what it was read from.
struct PlacedProbe {
    const Panorama& panorama;
    const Panorama* source; ///< what it was read from, if it was
    const Image& image;     ///< its
    double scale;           ///< of the engine's values
    bool negative;          ///< it has negative pixels; else no texel is below 0
};

/// Rules for the near part of a lobe that leave so much, about.
const NearRules& nearRulesFor(const PlacedProbe& probe, const Lobe& lobe, double max_error);

/// The mean over each texel's footprint of the kernel's convolution with the probe, by its pixels'
/// outlines: of lobes that see the probe's own texels by those.
Image nearMapOf(const PlacedProbe& probe, const NearKernel& kernel, const NearRules& rules,
                const PrefilterRequest& request, const Footprint& footprint, int threads,
                Progress* progress = nullptr);

/// The sum over all pixels: by points in the texel, or where the lobe is too narrow for them, or
/// sees the probe's own texels, by the outlines of texel and pixels.
PrefilterResult directMap(const PlacedProbe& probe, const PrefilterRequest& request, int threads,
                          Progress& progress);

/// Whether that takes 12 s of one core or less for so many of the map's texels.
bool isSummedSoon(const PlacedProbe& probe, const PrefilterRequest& request, double texels);

/// Sums some texels so, of a map whose texels are their centres' values.
void sumDirectly(const PlacedProbe& probe, const PrefilterRequest& request,
                 const std::vector<V2i>& texels, int threads, Panorama& map);

} // namespace ibl
