// A map's texels from all that a convolution has parted.
#pragma once

#include "convolve/direct.h"
#include "convolve/error_bound.h"
#include "convolve/evaluate.h"
#include "convolve/peak_sum.h"
#include "convolve/prefilter.h"
#include "convolve/synthesis.h"
#include "convolve/texels.h"
#include "core/progress.h"

namespace ibl {

/// What a map's rows are made from; absent parts are null.
struct Ingredients {
    double scale;  ///< of all parts but `map`
    bool negative; ///< the probe has negative pixels; else no texel is below 0
    const SmoothField* field = nullptr;
    const MapValues* at_points = nullptr; ///< in place of `field`
    const PeakSum* peaks = nullptr;
    const DirectSum* direct = nullptr;
    const Image* map = nullptr; ///< added to all that
};

/// A result whose map has the request's layout and size, to be filled.
PrefilterResult emptyResult(const PrefilterRequest& request);

/// Fills the map, of the request's layout and size, with the means over its texels' footprints, and
/// adds them to `norm`. Progress is told a step for each row.
void fillMap(const PrefilterRequest& request, const Footprint& footprint, const Ingredients& parts,
             int threads, Panorama& map, MapNorm& norm, Progress* progress = nullptr);

} // namespace ibl
