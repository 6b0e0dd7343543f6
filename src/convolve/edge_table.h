// Integrals of a narrow kernel along straight edges, in a table.
//
// Let M(t) be a kernel's mass within t of its axis, m all of it. In the plane that touches the
// sphere at the axis great circles are straight and r = tan t; about a point at the distance d from
// a line, whose foot is s = 0,
//
//     A(d, s) = int_0^s M(atan r) d / r^2 ds',   r^2 = d^2 + s'^2,
//
// is 2 pi times the kernel's mass over the triangle between the point and the edge: summed around a
// polygon it is 2 pi times the mass over it. And with Phi of near_weights.h
//
//     B(d, s) = int_0^s Phi(r) ds'
//
// is what flows between half-planes, where curvature does not count. A varies over the lobe's width
// near the point and in proportion to the distance farther out, so the table's nodes are evenly
// spaced in log(1 + d / width) and log(1 + s / width). B, of Phi's logarithm, varies over d and s
// however wide the lobe is: of lobes wider than the edges the edges' length is the width.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace ibl {

class EdgeTable {
public:
    /// `mass_within` is M(t), `potential` Phi(t), which is 0 from `reach` on, t in radians. Of
    /// lines nearer than `width` the integrals are taken to vary over `width`. Asked for are |d|
    /// and |s| up to `extent`, and `nodes` to a unit of the logarithms.
    EdgeTable(const std::function<double(double)>& mass_within,
              const std::function<double(double)>& potential, double width, double reach,
              double extent, double nodes);

    /// A's difference between `from` and `to` on a line at the signed distance d.
    double angle(double d, double from, double to) const {
        const double result = difference(angle_, std::abs(d), from, to);
        return d < 0 ? -result : result;
    }
    /// B's difference, for |d| < reach.
    double flow(double d, double from, double to) const {
        return difference(flow_, std::abs(d), std::max(from, -reach_), std::min(to, reach_));
    }

private:
    struct Cell {
        int first;
        double weight[4];
    };
    double nodeAt(int i) const;

    Cell cellOf(double x) const {
        const double at = std::log(1 + x * inverse_width_) * inverse_step_;
        const int first = std::clamp(static_cast<int>(at) - 1, 0, nodes_ - 4);
        const double a = at - first, b = a - 1, c = a - 2, d = a - 3; // from nodes 0 1 2 3
        return {first,
                {b * c * d * (-1.0 / 6), a * c * d * 0.5, a * b * d * -0.5, a * b * c * (1.0 / 6)}};
    }

    double lookUp(const double* table, const Cell& d, double s) const {
        const Cell e = cellOf(std::abs(s));
        double sum[4] = {0, 0, 0, 0};
        for (int i = 0; i < 4; ++i) {
            const double* row = table + (d.first + i) * nodes_ + e.first;
            for (int k = 0; k < 4; ++k)
                sum[k] += d.weight[i] * row[k];
        }
        const double value = e.weight[0] * sum[0] + e.weight[1] * sum[1] + e.weight[2] * sum[2] +
                             e.weight[3] * sum[3];
        return s < 0 ? -value : value;
    }

    double difference(const std::vector<double>& table, double d, double from, double to) const {
        const Cell cell = cellOf(d);
        return lookUp(table.data(), cell, to) - lookUp(table.data(), cell, from);
    }

    double width_, reach_, step_, inverse_width_, inverse_step_;
    int nodes_;
    std::vector<double> angle_, flow_; ///< [d][s]
};

} // namespace ibl
