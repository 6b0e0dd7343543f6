// Sums of spherical harmonics over many sources, order by order.
#pragma once

#include "lights/light_harmonics.h"

#include <cstddef>
#include <vector>

namespace ibl {

/// Sources at cos theta = x, each with its wave at the order at hand: re and im of three channels
/// times exp(-i m psi). As many values a vector as `size` says, a multiple of kLanes.
struct HarmonicSources {
    explicit HarmonicSources(std::size_t count);

    std::size_t size;
    std::vector<double> x, sine;     ///< cos and sin of theta; of unused places 0
    std::vector<double> sectoral;    ///< P_mm; at first for m = 0
    std::vector<double> wave[6];     ///< of unused places 0
    std::vector<double> now, before; ///< room for the recurrence
};

/// Adds sum P_lm(x) wave over the sources to `even` for l = m or m + 1, whichever is even, to
/// `degree` in twos.
void addOrder(HarmonicSources& sources, int m, int degree, LightHarmonics::Parts* even);

/// P_mm to the next order's: times sin theta sqrt((2m + 3) / (2m + 2)).
void raiseSectoral(HarmonicSources& sources, int m);

} // namespace ibl
