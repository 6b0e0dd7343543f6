#include "convolve/near_edges.h"

namespace ibl {

std::vector<EdgePiece> edgesAbout(const Block& block, const V3d& origin, double radius) {
    std::vector<EdgePiece> edges;
    const Plane plane(origin);
    const NearWeights& w = block.weights;
    const auto add = [&](EdgePiece edge, double theta, double psi, double dtheta, double dpsi) {
        if (!block.isNear(edge.before) && !block.isNear(edge.after)) return;
        const double length = std::max(std::abs(dtheta), std::abs(dpsi) * std::sin(theta));
        const int n = std::max(1, static_cast<int>(std::ceil(length / kPiece)));
        const double room = radius + length / n;
        V3d from = polarDirection(theta, psi);
        for (int k = 1; k <= n; ++k) {
            const V3d to = polarDirection(theta + dtheta * k / n, psi + dpsi * k / n);
            if ((from - origin).length2() < room * room) {
                edge.a = plane(from);
                const V2d along = plane(to) - edge.a;
                edge.length = along.length();
                edge.along = along / std::max(edge.length, 1e-300);
                if (edge.length > 0) edges.push_back(edge);
            }
            from = to;
        }
    };
    const double row_step = block.theta(1), column_step = block.psi(1);
    for (int j = 0; j <= w.rows; ++j) {
        if (w.row + j == 0 || w.row + j == block.field.height) continue; // a pole
        const double theta = block.theta(w.row + j), sin = std::sin(theta);
        // Chords run up to half^2 sin cos / 2 nearer to the pole than the parallel, two thirds of
        // that in the mean.
        const double half =
            0.5 * column_step / std::max(1.0, std::ceil(column_step * sin / kPiece));
        const double chord = theta + half * half * sin * std::cos(theta) / 3;
        for (int i = 0; i < w.columns; ++i)
            add({block.at(j - 1, i), block.at(j, i), true, theta, {}, {}, 0}, chord,
                block.psi(w.column + i + 1), 0, -column_step);
    }
    const bool all_around = w.columns == block.field.width;
    for (int i = 0; i <= w.columns - (all_around ? 1 : 0); ++i) {
        const double psi = block.psi(w.column + i);
        const int west = i == 0 && all_around ? w.columns - 1 : i - 1;
        for (int j = 0; j < w.rows; ++j)
            add({block.at(j, west), block.at(j, i), false, psi, {}, {}, 0}, block.theta(w.row + j),
                psi, row_step, 0);
    }
    return edges;
}

} // namespace ibl
