#include "convolve/edge_table.h"

#include "convolve/gauss.h"

#include <algorithm>
#include <cmath>

namespace ibl {

double EdgeTable::nodeAt(int i) const {
    return width_ * std::expm1(i * step_);
}

EdgeTable::EdgeTable(const std::function<double(double)>& mass_within,
                     const std::function<double(double)>& potential, double width, double reach,
                     double extent, double nodes)
    : width_(width),
      reach_(reach),
      step_(1 / nodes),
      inverse_width_(1 / width),
      inverse_step_(nodes),
      nodes_(static_cast<int>(std::log1p(extent / width) / step_) + 5) {
    const GaussRule& rule = gaussRule(8);
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
                angle += ds * mass_within(std::atan(r)) * d / r2;
            }
            angle_[a * n + b] = a == 0 ? 0 : angle;
            flow_[a * n + b] = flow;
        }
    }
}

} // namespace ibl
