#include "convolve/near_edges.h"

#include "convolve/peaks.h"

#include <algorithm>
#include <cmath>

namespace ibl {

std::vector<PixelEdge> edgesOfNear(const Block& block) {
    std::vector<PixelEdge> edges;
    const NearWeights& w = block.weights;
    const NearField& field = block.field;
    const double row_step = kPi / field.height, column_step = 2 * kPi / field.width;
    // From (theta, psi) on.
    const auto add = [&](int before, int after, double theta, double psi, double dtheta,
                         double dpsi) {
        if (!block.isNear(before) && !block.isNear(after)) return;
        const double longest = std::max(std::abs(dtheta), std::abs(dpsi));
        const int n = std::max(1, static_cast<int>(std::ceil(longest / kLongest)));
        const auto place = [&](double k) {
            return polarDirection(theta + dtheta * k / n, psi + dpsi * k / n);
        };
        V3d from = place(0);
        for (int k = 0; k < n; ++k) {
            const V3d to = place(k + 1);
            edges.push_back({before, after, {from, place(k + 0.5), to}});
            from = to;
        }
    };
    const bool all_around = w.columns == field.width;
    for (int j = 0; j <= w.rows; ++j) {
        const int row = w.row + j;
        const double theta = row_step * row;
        for (int i = 0; i <= w.columns; ++i) {
            const double psi = column_step * (w.column + i);
            if (i < w.columns && row > 0 && row < field.height)
                add(block.at(j - 1, i), block.at(j, i), theta, psi, 0, column_step);
            if (j < w.rows && !(all_around && i == w.columns))
                add(block.at(j, i - 1), block.at(j, i), theta + row_step, psi, -row_step, 0);
        }
    }
    return edges;
}

std::vector<Arc> pixelOutline(int width, int height, int column, int row) {
    const double row_step = kPi / height, column_step = 2 * kPi / width;
    const double top = row_step * row, bottom = top + row_step;
    const double west = column_step * column, east = west + column_step;
    std::vector<Arc> outline;
    const auto add = [&](double theta, double psi, double to_theta, double to_psi) {
        const auto place = [&](double t) {
            return polarDirection(theta + (to_theta - theta) * t, psi + (to_psi - psi) * t);
        };
        addCurve(place, 0, 1, 1, kLongest, outline);
    };
    add(bottom, west, bottom, east);
    add(bottom, east, top, east);
    add(top, east, top, west);
    add(top, west, bottom, west);
    return outline;
}

} // namespace ibl
