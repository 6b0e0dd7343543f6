#include "convolve/edge_table.h"

#include "convolve/gauss.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

/// Nodes to a unit of log(1 + r / width); cubic interpolation between them is good to 1e-6 of m.
constexpr double kNodesPerUnit = 10;

} // namespace

double EdgeTable::nodeAt(int i) const {
    return width_ * std::expm1(i * step_);
}

EdgeTable::EdgeTable(const std::function<double(double)>& mass_beyond, double width, double reach,
                     double extent)
    : width_(width),
      reach_(reach),
      step_(1 / kNodesPerUnit),
      inverse_width_(1 / width),
      inverse_step_(kNodesPerUnit),
      nodes_(static_cast<int>(std::log1p(extent / width) / step_) + 5) {
    const double all = mass_beyond(0);
    const auto beyond = [&](double r) { return r < reach ? mass_beyond(r) : 0.0; };
    // Phi at the nodes, from the outside in; between the nodes by the same quadrature.
    const GaussRule& rule = gaussRule(8);
    const auto overLog = [&](double from, double to) { // int of (m - M) / (2 pi r) dr
        if (from >= reach) return 0.0;
        to = std::min(to, reach);
        const double low = std::log(from), half = 0.5 * (std::log(to) - low);
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i)
            sum += rule.weights[i] * beyond(std::exp(low + half * (1 + rule.nodes[i])));
        return half * sum / (2 * std::numbers::pi);
    };
    // Near 0, Phi = -m log(r) / (2 pi) + constant: only its table is short of nodes there.
    constexpr int kFinest = -160;
    const int coarsest = 10 * nodes_;
    std::vector<double> phi(static_cast<std::size_t>(coarsest - kFinest + 1), 0.0);
    const auto radius = [&](int i) { return width * std::exp(0.1 * i); };
    for (int i = coarsest - 1; i >= kFinest; --i) {
        const std::size_t at = static_cast<std::size_t>(i - kFinest);
        phi[at] = phi[at + 1] + overLog(radius(i), radius(i + 1));
    }
    const auto potential = [&](double r) {
        if (r >= reach) return 0.0;
        const int i = static_cast<int>(std::floor(std::log(r / width) / 0.1)) + 1;
        return i <= kFinest ? phi[0] - all * std::log(r / radius(kFinest)) / (2 * std::numbers::pi)
                            : phi[static_cast<std::size_t>(i - kFinest)] + overLog(r, radius(i));
    };
    const std::size_t n = static_cast<std::size_t>(nodes_);
    angle_.assign(n * n, 0.0);
    flow_.assign(n * n, 0.0);
    for (std::size_t a = 0; a < n; ++a) {
        const double d = std::max(nodeAt(static_cast<int>(a)), 1e-9 * width);
        double angle = 0, flow = 0;
        for (std::size_t b = 1; b < n; ++b) {
            const double from = nodeAt(static_cast<int>(b) - 1), to = nodeAt(static_cast<int>(b));
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                // From 0 on, Phi's logarithm: s = to x^2.
                const double x = 0.5 + 0.5 * rule.nodes[i];
                const double s = b == 1 ? to * x * x : from + (to - from) * x;
                const double ds = 0.5 * rule.weights[i] * (b == 1 ? 2 * to * x : to - from);
                const double r2 = d * d + s * s, r = std::sqrt(r2);
                flow += ds * potential(r);
                angle += ds * (all - beyond(r)) * d / r2;
            }
            angle_[a * n + b] = a == 0 ? 0 : angle;
            flow_[a * n + b] = flow;
        }
    }
}

} // namespace ibl
