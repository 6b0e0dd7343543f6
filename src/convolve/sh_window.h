// De-ringing: damping of the higher bands until nothing is below zero (Sloan 2017, "Deringing
// Spherical Harmonics", JCGT 6(2)).
#pragma once

#include "convolve/sh_coefficients.h"

#include <array>
#include <string_view>

namespace ibl {

/// w_l = 1 / (1 + lambda l^2 (l + 1)^2), the regulariser of the squared Laplacian.
double shWindow(double lambda, int l);

/// Band l times shWindow(lambda, l). With lambda 0 nothing changes, bit for bit.
ShCoefficients damp(const ShCoefficients& coefficients, double lambda);

/// Least value over the sphere of what the coefficients stand for, of each channel: local minima of
/// a grid refined until they move no more. Between grid points a polynomial of degree n and size M
/// hides at most M n^2 h^2 / 2 (Bernstein, twice, along the great circle to the nearest point h
/// away), so every local minimum that is no higher than that above the least is refined.
std::array<double, 3> leastOverSphere(const ShCoefficients& coefficients);

/// The lambda, one for all channels so that colours keep their balance, at which the least value
/// over the sphere first reaches 0 (to 1e-9 of the mean); 0 where it is not below 0 already. Found
/// by bisection to a relative 1e-4, from the side that is not negative. Throws Error (input)
/// naming `subject` for a channel whose mean is below 0, which no window helps.
double leastDamping(const ShCoefficients& coefficients, std::string_view subject = "probe");

} // namespace ibl
