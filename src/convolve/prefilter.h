// Prefiltered environment maps: a probe convolved with reflection lobes.
//
// One spherical-harmonic analysis of the probe serves all requests; each output is one
// multiplication by the lobe's zonal coefficients and one synthesis (Ramamoorthi and Hanrahan 2001,
// 2002). What a band limit would lose is made good in space: bright pixels are split off and
// convolved directly, and of lobes too narrow for it the area-filtered probe is the rest.
#pragma once

#include "convolve/lobe.h"
#include "core/progress.h"
#include "panorama/panorama.h"

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace ibl {

struct PrefilterRequest {
    Lobe lobe;
    Layout layout = Layout::faces;
    int size = 64; ///< edge of a cube face, or height of a lat-long map (its width is twice that)
};

enum class Quality { draft, standard, high, reference };

/// What a quality promises; `--quality` and the man page are made from these rows.
struct QualityRow {
    Quality quality;
    std::string_view name;
    double max_error; ///< relative RMSE that the result is to keep
    std::string_view summary;
};

inline constexpr std::array<QualityRow, 4> kQualities{{
    {Quality::draft, "draft", 1e-3, "harmonics cut where 1e-3 of relative RMSE is kept"},
    {Quality::standard, "standard", 1e-4, "harmonics cut where 1e-4 of relative RMSE is kept"},
    {Quality::high, "high", 1e-5, "harmonics cut where 1e-5 of relative RMSE is kept"},
    {Quality::reference, "reference", 1e-7, "direct sum over all pixels in double precision, slow"},
}};

struct PrefilterOptions {
    double max_error = 1e-4; ///< relative RMSE asked for (> 0); chooses band limits and peaks
    bool reference = false;  ///< direct double-precision sum instead of harmonics
    int threads = 0;         ///< 0: as many as the machine has; the result does not depend on it
    /// What the lat-long was read from, where that has another layout: mirrors show it, and errors
    /// hold what reading it left (reading_error.h).
    const Panorama* source = nullptr;
    TellProgress progress{}; ///< of the direct sum, which lasts
};

/// The options that a row of kQualities stands for.
PrefilterOptions optionsFor(Quality quality, int threads = 0);

/// A prefiltered map and what it cost. Errors are relative RMSE, sqrt(sum w |a - b|^2 / sum w
/// |b|^2) over texels and channels, w the solid angle, against the exact integral.
struct PrefilterResult {
    Panorama map;
    int band_limit = 0;        ///< highest degree l used, 0 when none was
    int peaks_split = 0;       ///< pixels convolved directly instead of in harmonics
    double error_bound = 0;    ///< the error is not greater than this
    double error_estimate = 0; ///< from the decay of the probe's measured spectrum
    /// No texel's channel is off by more than this times the map's mean of |b|. Not known for lobes
    /// too narrow for harmonics.
    std::optional<double> worst_bound;
    double seconds_analysis = 0;  ///< transform of the probe; the same for all requests
    double seconds_synthesis = 0; ///< harmonics to texels
    double seconds_spatial = 0;   ///< peaks and texels, or the direct sum
};

/// Convolves the probe with every request's lobe. The probe is a lat-long RGB image of any size
/// from 1 x 1, pixels constant over their rectangles, finite; negative pixels are allowed. A texel
/// is the lobe-weighted mean about its centre's direction, so a constant probe L gives L; where the
/// lobe is narrower than about two texels it is the mean of that over the texel's footprint, and
/// for roughness 0 the area-filtered probe. Results stand in the order of the requests. Throws
/// Error on a lobe parameter or a size out of range, and where max_error is less than a narrow
/// lobe's least.
std::vector<PrefilterResult> prefilter(const Panorama& latlong,
                                       std::span<const PrefilterRequest> requests,
                                       const PrefilterOptions& options);

} // namespace ibl
