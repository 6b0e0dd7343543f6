#include "lights/summed_area.h"

#include "core/parallel.h"
#include "lights/light.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
double litEnergy(const Image& latlong, int threads) {
    std::vector<double> rows(static_cast<std::size_t>(latlong.height));
    parallelFor(rows.size(), threads, [&](std::size_t j) {
        const float* rgb = latlong.row(static_cast<int>(j));
        double sum = 0;
        for (int i = 0; i < latlong.width; ++i)
            sum += litLuminance(rgb + 3 * i);
        rows[j] = sum * latlongPixelSolidAngle(latlong.width, latlong.height, static_cast<int>(j));
    });
    double total = 0;
    for (const double row : rows)
        total += row;
    return total;
}

SummedAreaTable::SummedAreaTable(const Image& latlong, int threads)
    : width_(latlong.width), height_(latlong.height) {
    const std::size_t stride = static_cast<std::size_t>(width_) + 1;
    sums_.resize(stride * (static_cast<std::size_t>(height_) + 1));
    std::fill_n(sums_.begin(), stride, 0);
    const double total = litEnergy(latlong, threads);
    if (total > 0) scale_ = std::ldexp(1.0, 62) / total;

    // Prefix sums along the rows, then down the columns.
    parallelFor(static_cast<std::size_t>(height_), threads, [&](std::size_t j) {
        const float* rgb = latlong.row(static_cast<int>(j));
        std::int64_t* out = &sums_[(j + 1) * stride];
        const double weight = scale_ * latlongPixelSolidAngle(width_, height_, static_cast<int>(j));
        std::int64_t sum = 0;
        out[0] = 0;
        for (int i = 0; i < width_; ++i) {
            sum += static_cast<std::int64_t>(weight * litLuminance(rgb + 3 * i) + 0.5);
            out[i + 1] = sum;
        }
    });
    constexpr std::size_t kColumns = 256;
    parallelForRuns(stride, kColumns, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = 1; j < static_cast<std::size_t>(height_); ++j) {
            const std::int64_t* above = &sums_[j * stride];
            std::int64_t* below = &sums_[(j + 1) * stride];
            for (std::size_t i = begin; i < end; ++i)
                below[i] += above[i];
        }
    });
}

std::int64_t SummedAreaTable::energy(const PixelRegion& r) const {
    const int y1 = r.y + r.height;
    const auto columns = [&](int x0, int x1) {
        return corner(x1, y1) - corner(x0, y1) - corner(x1, r.y) + corner(x0, r.y);
    };
    const int x1 = r.x + r.width;
    return x1 <= width_ ? columns(r.x, x1) : columns(r.x, width_) + columns(0, x1 - width_);
}

} // namespace ibl
