// Pixels about a texel and the pieces of their edges, in planes that touch the sphere.
#pragma once

#include "convolve/near_weights.h"
#include "convolve/peaks.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibl {

/// Edges are cut in pieces this long (radians) at most: a parallel is off its chord by 3e-5 of it.
inline constexpr double kPiece = 0.015;

/// The plane that touches the sphere at a direction, x to the east, y to the south.
class Plane {
public:
    explicit Plane(const V3d& d) : out_(d) {
        const double psi = std::atan2(d.y, d.x), theta = std::atan2(std::hypot(d.x, d.y), d.z);
        east_ = V3d(-std::sin(psi), std::cos(psi), 0);
        south_ = polarDirection(theta + 0.5 * kPi, psi);
    }
    V2d operator()(const V3d& d) const {
        return V2d(d.dot(east_), d.dot(south_)) / std::max(d.dot(out_), 1e-3);
    }

private:
    V3d out_, east_, south_;
};

inline double cross(const V2d& a, const V2d& b) {
    return a.x * b.y - a.y * b.x;
}

/// Pixels about a texel.
struct Block {
    const NearField& field;
    NearWeights& weights;
    std::vector<char> near; ///< [rows][columns]: by edges

    double theta(int row) const { return kPi * row / field.height; }
    double psi(int column) const { return 2 * kPi * column / field.width; }
    /// Index of a pixel counted from the first, or -1 outside.
    int at(int row, int column) const {
        if (row < 0 || row >= weights.rows || column < 0) return -1;
        if (column >= weights.columns) {
            if (weights.columns < field.width) return -1;
            column -= weights.columns; // all the way around
        }
        return row * weights.columns + column;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) const {
        if (isNear(pixel)) weights.weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// A piece of a parallel, westwards, or of a meridian, southwards, in a plane: from a to b the
/// pixel in the north or west lies on the left, x going to y.
struct EdgePiece {
    int before, after; ///< the pixels on the left and on the right, -1 outside the block
    bool parallel;
    double line; ///< theta or psi
    V2d a, along;
    double length;
};

/// The pieces of the near pixels' edges that come within `radius` of the plane's origin.
std::vector<EdgePiece> edgesAbout(const Block& block, const V3d& origin, double radius);

} // namespace ibl
