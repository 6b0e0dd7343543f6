// Sums over rectangles of pixels (Crow 1984), filled in one pass.
#pragma once

#include "image/image.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ibl {

/// A rectangle of lat-long pixels: columns [x, x + width), wrapping at the image's width, and rows
/// [y, y + height).
struct PixelRegion {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

/// Sums from the upper left corner to every pixel's corner. They begin anew in each band of rows,
/// so that bands are filled side by side and each only once; what lies above a band is kept once a
/// band. `Sum` has + and -, and a default value of zero.
template <class Sum>
class PrefixTable {
public:
    PrefixTable(int width, int height)
        : width_(width), height_(height), stride_(static_cast<std::size_t>(width) + 1) {
        within_.resize(stride_ * (static_cast<std::size_t>(height) + 1));
        std::fill_n(within_.begin(), stride_, Sum{});
        above_.resize(stride_ * static_cast<std::size_t>(bands() + 1));
    }

    int width() const { return width_; }
    int height() const { return height_; }
    int bands() const { return (height_ + kBand - 1) / kBand; }

    /// Where row j's sums will stand, but for the first, which is 0. Free for other use until
    /// fillBand() comes to the row.
    Sum* place(int j) { return &within_[(static_cast<std::size_t>(j) + 1) * stride_ + 1]; }

    /// Fills band `band`: `row(j, above, below)` sets below[i] = above[i] + the sum of row j's
    /// pixels left of i, for i = 0 .. width.
    template <class Row>
    void fillBand(int band, Row row) {
        const Sum* above = within_.data(); // the table's first row is zero
        for (int j = band * kBand; j < std::min(height_, (band + 1) * kBand); ++j) {
            Sum* below = &within_[(static_cast<std::size_t>(j) + 1) * stride_];
            row(j, above, below);
            above = below;
        }
    }

    /// After all bands are filled.
    void addUpBands() {
        std::fill_n(above_.begin(), std::min(above_.size(), 2 * stride_), Sum{});
        for (int band = 1; band < bands(); ++band) {
            const Sum* last = &within_[static_cast<std::size_t>(band) * kBand * stride_];
            const Sum* before = &above_[static_cast<std::size_t>(band) * stride_];
            Sum* after = &above_[(static_cast<std::size_t>(band) + 1) * stride_];
            for (std::size_t i = 0; i < stride_; ++i)
                after[i] = before[i] + last[i];
        }
    }

    Sum sum(const PixelRegion& r) const {
        const int x1 = r.x + r.width;
        return x1 <= width_ ? columns(r, r.x, x1)
                            : columns(r, r.x, width_) + columns(r, 0, x1 - width_);
    }

private:
    static constexpr int kBand = 32;

    Sum corner(int x, int y) const {
        const std::size_t band = static_cast<std::size_t>((y + kBand - 1) / kBand);
        const std::size_t column = static_cast<std::size_t>(x);
        return within_[static_cast<std::size_t>(y) * stride_ + column] +
               above_[band * stride_ + column];
    }
    Sum columns(const PixelRegion& r, int x0, int x1) const {
        const int y1 = r.y + r.height;
        return (corner(x1, y1) - corner(x0, y1)) - (corner(x1, r.y) - corner(x0, r.y));
    }

    int width_;
    int height_;
    std::size_t stride_;
    std::vector<Sum, UninitialisedAllocator<Sum>> within_; ///< (height + 1)(width + 1)
    std::vector<Sum, UninitialisedAllocator<Sum>> above_;  ///< (bands + 1)(width + 1)
};

} // namespace ibl
