// Lobes too narrow for a band limit.
//
// The lobe is split into K = K_smooth + K_core. K_smooth has the lobe's coefficients under a taper,
//
//     h_l = erfc(3 (2 l / B - 1)) / erfc(-3),
//
// and is synthesised as any other field. What is left, K_core, is compact: the taper is a smooth
// step whose spatial counterpart falls like exp(-(l-width t)^2 / 2), so beyond about 40 / B radians
// nothing of it remains and there is no ringing. It is convolved in space over the edges of the
// pixels near the axis (edges.h), which is exact for lobes much narrower than a pixel.
//
// A texel larger than the lobe gets the mean over its footprint. The core is then sampled at points
// spread over the texel, and of the lobe's innermost part, whose edges would fall between the
// points, the mean over the texel is that of the probe itself (`inner_mass` times the area-filtered
// map).
#pragma once

#include "convolve/edges.h"
#include "convolve/lobe.h"
#include "image/image.h"

#include <vector>

namespace ibl {

/// The smooth part's coefficients k_l h_l, l = 0 .. degree.
std::vector<double> smoothCoefficients(const Lobe& lobe, int degree);

/// Q = M - M(pi) of K_core, and how far from the axis it reaches.
struct LobeCore {
    LobeMassBeyond mass_beyond;
    Disc disc;                       ///< beyond its radius Q is negligible
    double inner_mass = 0;           ///< mass within inner_h, left to the area-filtered map
    double inner_h = 0;              ///< sin^2(rho/2) of the innermost part
    double step = 0;                 ///< of the table
    std::vector<double> smooth_mass; ///< M_smooth at t = i step; none: it is M(pi), 1

    /// Q at h = sin^2(t/2) within the radius.
    double operator()(double h) const;
};

/// The core left by `smooth`, down to `tolerance` of the lobe's mass, less what lies within `inner`
/// radians of the axis.
LobeCore makeCore(const Lobe& lobe, const std::vector<double>& smooth, double inner,
                  double tolerance);

/// The whole lobe as a core: nothing of it is smooth.
LobeCore makeWholeCore(const Lobe& lobe);

/// Adds (K_core * L) in the direction of the axis, L the probe times `scale`: sum[c], c < 3.
void addCore(const LobeCore& core, const Image& probe, double scale, const Axis& axis, double* sum);

} // namespace ibl
