// Gauss-Legendre quadrature.
#pragma once

#include <vector>

namespace ibl {

/// Nodes in (-1, 1), ascending, and weights, summing to 2; exact for polynomials of degree 2n - 1.
struct GaussRule {
    std::vector<double> nodes;
    std::vector<double> weights;
};

/// The rule of n >= 1 points, computed by Newton's method on P_n and kept for the process (up to
/// 32 points).
const GaussRule& gaussRule(int n);

} // namespace ibl
