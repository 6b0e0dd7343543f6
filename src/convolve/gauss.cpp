#include "convolve/gauss.h"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr int kMaxPoints = 32;

GaussRule makeRule(int n) {
    GaussRule rule{std::vector<double>(static_cast<std::size_t>(n)),
                   std::vector<double>(static_cast<std::size_t>(n))};
    for (int i = 0; i < n; ++i) {
        // Tricomi's first guess is within Newton's reach for every root.
        double x = -std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
        for (int step = 0; step < 8; ++step) {
            double p0 = 1, p1 = x;
            for (int l = 1; l < n; ++l) {
                const double p2 = ((2 * l + 1) * x * p1 - l * p0) / (l + 1);
                p0 = p1;
                p1 = p2;
            }
            slope = n * (x * p1 - p0) / (x * x - 1);
            x -= p1 / slope;
        }
        rule.nodes[static_cast<std::size_t>(i)] = x;
        rule.weights[static_cast<std::size_t>(i)] = 2 / ((1 - x * x) * slope * slope);
    }
    return rule;
}

} // namespace

const GaussRule& gaussRule(int n) {
    assert(n >= 1 && n <= kMaxPoints);
    static const std::array<GaussRule, kMaxPoints> rules = [] {
        std::array<GaussRule, kMaxPoints> made;
        for (int i = 1; i <= kMaxPoints; ++i)
            made[static_cast<std::size_t>(i - 1)] = makeRule(i);
        return made;
    }();
    return rules[static_cast<std::size_t>(n - 1)];
}

} // namespace ibl
