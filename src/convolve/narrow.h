// Lobes too narrow for a band limit, split in a near part and a far part.
//
// GGX is a sharp core with a tail that falls as t^-4: at the roughness of 0.03 a thousandth of it
// still lies beyond 3 degrees. In q = alpha^2 + (1 - alpha^2) h, h = sin^2(t/2), it is a mixture of
// Gaussians of all widths,
//
//     K ~ cos t / q^2 = cos t int_0^oo v exp(-v q) dv,
//
// of which those narrower than a limit, v > u, are
//
//     K_near = K w,  w = exp(-u q) (1 + u q),
//
// and the others K_far = K (1 - w) = K (u q)^2 / 2 + ..., in which q^-2 cancels: an entire function
// that is smooth over sqrt(2 / u) radians, has the lesser part of the lobe's mass, and needs a band
// limit of a few times sqrt(u / 2), whatever the roughness. Both parts are positive. K_near ends
// after a few times sqrt(2 / u) and is convolved in space (near_weights.h), in closed form at the
// pixels' and texels' edges. Phong's and Blinn-Phong's lobes have no tail: all of them is near.
//
// A constant in place of what lies beyond the band limit, or a few displaced texels, is simpler and
// was measured: for GGX of roughness 0.01 to 0.03 into 256-texel faces it left 1e-4 to 6e-4 of the
// result at degree 2048, at 2 to 15 CPU seconds.
#pragma once

#include "convolve/lobe.h"

#include <vector>

namespace ibl {

/// K_near, normalised as the lobe is.
class NearKernel {
public:
    /// `u` as above, 0 for all of the lobe. Less than `negligible` of the lobe's mass lies beyond
    /// `reach`, and counts as lying within.
    NearKernel(const Lobe& lobe, double u, double negligible);

    /// Per steradian, at the angle t with h = sin^2(t/2).
    double value(double h) const;
    /// Its mass farther than that from the axis.
    double massBeyond(double h) const;

    const Lobe& lobe() const { return lobe_; }

    double mass = 0;  ///< of all of it, at most 1
    double width = 0; ///< angle over which it varies near its axis
    double reach = 0; ///< angle

private:
    Lobe lobe_;
    double u_;
    double norm_;
    LobeMassBeyond mass_beyond_;
};

/// Coefficients of K_far: k_l less those of K_near, l < k.size().
std::vector<double> farCoefficients(std::vector<double> k, const NearKernel& near);

/// A lobe as K_near and, to `degree`, K_far; a degree of 0 is none.
struct LobeSplit {
    NearKernel near;
    int degree = 0;
    std::vector<double> k; ///< of K_far, beyond `degree` too
};

/// Of what may be left, the lobe's mass beyond the near part's reach: it counts as lying within,
/// which moves twice as much.
inline constexpr double kBeyondReach = 0.05;

/// Splits the lobe of coefficients k, of which there are more than `degree`, such that K_far cut at
/// `degree` leaves at most `allowed`, the largest coefficient beyond. Lobes without a tail have no
/// K_far.
LobeSplit splitLobe(const Lobe& lobe, const std::vector<double>& k, int degree, double allowed);

} // namespace ibl
