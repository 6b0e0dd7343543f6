#include "lights/moment_table.h"

#include "core/parallel.h"
#include "lights/light.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <cmath>

namespace ibl {

MomentTable::MomentTable(const Image& latlong, int threads)
    : width_(latlong.width), height_(latlong.height) {
    const std::size_t stride = static_cast<std::size_t>(width_) + 1;
    sums_.resize(stride * (static_cast<std::size_t>(height_) + 1));
    std::fill_n(sums_.begin(), stride, Sums{});
    const double total = litEnergy(latlong, threads);
    const double scale = total > 0 ? std::ldexp(1.0, 62) / total : 0.0;
    const ColumnMoments columns = columnMoments(width_);

    // Prefix sums along the rows, then down the columns.
    parallelFor(static_cast<std::size_t>(height_), threads, [&](std::size_t j) {
        const float* rgb = latlong.row(static_cast<int>(j));
        Sums* out = &sums_[(j + 1) * stride];
        const RowMoments row = rowMoments(width_, height_, static_cast<int>(j));
        Sums sum{};
        out[0] = sum;
        for (int i = 0; i < width_; ++i) {
            const double y = scale * litLuminance(rgb + 3 * i);
            const double across = y * row.horizontal;
            sum[0] += static_cast<std::int64_t>(y * row.solid_angle + 0.5);
            sum[1] += static_cast<std::int64_t>(across * columns.sine[i]);
            sum[2] += static_cast<std::int64_t>(y * row.vertical);
            sum[3] += static_cast<std::int64_t>(across * columns.cosine[i]);
            out[i + 1] = sum;
        }
    });
    constexpr std::size_t kColumns = 64;
    parallelForRuns(stride, kColumns, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = 1; j < static_cast<std::size_t>(height_); ++j) {
            const Sums* above = &sums_[j * stride];
            Sums* below = &sums_[(j + 1) * stride];
            for (std::size_t i = begin; i < end; ++i) {
                for (int c = 0; c < 4; ++c)
                    below[i][c] += above[i][c];
            }
        }
    });
}

MomentTable::Sums MomentTable::sums(const PixelRegion& r) const {
    const int y1 = r.y + r.height;
    Sums sums{};
    const auto addColumns = [&](int x0, int x1) {
        const Sums &a = corner(x1, y1), &b = corner(x0, y1), &c = corner(x1, r.y),
                   &d = corner(x0, r.y);
        for (int k = 0; k < 4; ++k)
            sums[k] += (a[k] - b[k]) - (c[k] - d[k]);
    };
    const int x1 = r.x + r.width;
    if (x1 <= width_) {
        addColumns(r.x, x1);
    } else {
        addColumns(r.x, width_);
        addColumns(0, x1 - width_);
    }
    return sums;
}

double MomentTable::variance(const PixelRegion& region) const {
    const Sums s = sums(region);
    if (s[0] <= 0) return 0;
    const double w = static_cast<double>(s[0]);
    double squared = 0;
    for (int k = 1; k < 4; ++k) {
        const double m = static_cast<double>(s[k]) / w;
        squared += m * m;
    }
    return std::max(0.0, w * (1 - squared));
}

} // namespace ibl
