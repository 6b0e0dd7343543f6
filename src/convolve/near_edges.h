// Pixels about a texel and their edges.
#pragma once

#include "convolve/arcs.h"
#include "convolve/near_weights.h"

#include <vector>

namespace ibl {

/// Curves are cut in pieces of at most this many radians, and of this much of a turn.
inline constexpr double kLongest = 0.02;

/// Pixels about a texel.
struct Block {
    const NearField& field;
    NearWeights& weights;
    std::vector<char> near; ///< [rows][columns]: by edges

    /// Index of a pixel counted from the first, or -1 outside.
    int at(int row, int column) const {
        if (row < 0 || row >= weights.rows) return -1;
        if (weights.columns == field.width) { // all the way around
            column %= field.width;
            if (column < 0) column += field.width;
        }
        if (column < 0 || column >= weights.columns) return -1;
        return row * weights.columns + column;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) const {
        if (isNear(pixel)) weights.weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// A piece of a parallel, eastwards, or of a meridian, northwards: the pixel in the north or west
/// lies on its left as seen from outside.
struct PixelEdge {
    int before, after; ///< the pixels on the left and on the right, -1 outside the block
    Arc arc;
};

/// All edges of the near pixels.
std::vector<PixelEdge> edgesOfNear(const Block& block);

/// The outline of a pixel of a width x height lat-long, which lies on the left.
std::vector<Arc> pixelOutline(int width, int height, int column, int row);

} // namespace ibl
