// Means over cube texels of a probe convolved with lobes of any width: an oracle for those that
// points in texel and pixel would miss. Plain adaptive quadrature, on the sphere itself; nothing
// shared with the engine.
#pragma once

#include "image/image.h"

#include <array>
#include <functional>
#include <vector>

namespace ibl::oracle {

/// With the kernel's mass 1 and beyond(t) of it farther than t from its axis,
///
///     Phi(t) = int_t beyond(t') / (2 pi sin t') dt',   laplacian of Phi = K - delta,
///
/// at even steps of log t, from 1e-9 to 90 degrees.
struct Potential {
    double step = 0;
    std::vector<double> value, slope; ///< slope by a step
};

/// Of a lobe, not normalised, as a function of h = sin^2(t/2), 0 beyond 90 degrees.
Potential makePotential(const std::function<double(double h)>& lobe);

/// What the convolution adds to the mean of the probe over texel (x, y) of face `face`: by Gauss's
/// theorem in texel T and pixels P, as n_e . (rotation that moves x along n_e) is divergence-free,
///
///     int_T int_P K = |T n P| - oint_dT oint_dP Phi dx . dy
///
/// with the line elements' product in space (Neumann's formula for inductances), summed over all
/// pixels and divided by |T|.
std::array<double, 3> contourChange(const Image& latlong, const Potential& potential, int face,
                                    int x, int y, int edge);

/// The same of texel (x, y) of a lat-long map.
std::array<double, 3> latlongContourChange(const Image& latlong, const Potential& potential, int x,
                                           int y, int width, int height);

} // namespace ibl::oracle
