// Integrals of a narrow kernel along straight edges, in a table.
//
// In the plane, let M(r) be a kernel's mass within r of its axis, m all of it. About a point at the
// distance d from a line, whose foot is s = 0,
//
//     A(d, s) = int_0^s M(r) d / r^2 ds',   r^2 = d^2 + s'^2,
//
// is 2 pi times the kernel's mass over the triangle between the point and the edge: summed around a
// polygon it is 2 pi times the mass over it. And with
//
//     Phi(r) = int_r^oo (m - M(r')) / (2 pi r') dr',   laplacian of Phi = K - m delta,
//
//     B(d, s) = int_0^s Phi(r) ds'
//
// is what flows between half-planes: see soft_texels.h. Both vary over the lobe's width near the
// point and in proportion to the distance farther out, so the table's nodes are evenly spaced in
// log(1 + d / width) and log(1 + s / width).
#pragma once

#include <functional>
#include <vector>

namespace ibl {

class EdgeTable {
public:
    /// `mass_beyond` is m - M(r), r in radians; 0 from `reach` on. Of lines nearer than `width` the
    /// integrals vary over `width`; A is asked for up to `extent` >= reach.
    EdgeTable(const std::function<double(double)>& mass_beyond, double width, double reach,
              double extent);

    /// A's difference between `from` and `to` on a line at the signed distance d.
    double angle(double d, double from, double to) const;
    /// B's difference, for |d| < reach.
    double flow(double d, double from, double to) const;

private:
    struct Cell;
    double nodeAt(int i) const;
    Cell cellOf(double x) const;
    double lookUp(const std::vector<double>& table, const Cell& d, double s) const;

    double width_, reach_, step_;
    int nodes_;
    std::vector<double> angle_, flow_; ///< [d][s]
};

} // namespace ibl
