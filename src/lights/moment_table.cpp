#include "lights/moment_table.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

/// Adds a row of pixels to its blocks' energies and moments, four doubles each. A pixel's are its
/// luminance times `row` times its column's (1, sin, 1, cos).
IBL_MULTIVERSION
void addPixelRow(const float* rgb, const ColumnMoments& columns, const double (&row)[4], int shift,
                 double* blocks) {
    const int width = static_cast<int>(columns.sine.size());
    const Lanes weights = loadLanes(row);
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        fetchAhead(rgb + 3 * i);
        const Lanes luminance = absoluteLuminance(pixelLanes(rgb + 3 * i));
        Lanes v[kLanes];
        for (int k = 0; k < kLanes; ++k)
            v[k] = luminance[k] * weights * Lanes{1, columns.sine[i + k], 1, columns.cosine[i + k]};
        if (shift >= 2) {
            addTo(blocks + 4 * (i >> shift), (v[0] + v[1]) + (v[2] + v[3]));
        } else if (shift == 1) {
            addTo(blocks + 2 * i, v[0] + v[1]);
            addTo(blocks + 2 * i + 4, v[2] + v[3]);
        } else {
            for (int k = 0; k < kLanes; ++k)
                addTo(blocks + 4 * (i + k), v[k]);
        }
    }
    if (i == width) return;
    const Lanes luminance = absoluteLuminance(lastPixelLanes(rgb + 3 * i, width - i));
    for (int k = 0; i < width; ++i, ++k) {
        addTo(blocks + 4 * (i >> shift),
              luminance[k] * weights * Lanes{1, columns.sine[i], 1, columns.cosine[i]});
    }
}

IBL_MULTIVERSION
void addBlockRow(const double* blocks, int width, const MomentTable::Sums* above,
                 MomentTable::Sums* below) {
    LongLanes sum{};
    below[0] = {};
    for (int i = 0; i < width; ++i) {
        sum += rounded(loadLanes(blocks + 4 * i));
        LongLanes up;
        __builtin_memcpy(&up, above[i + 1].parts, sizeof up);
        up += sum;
        __builtin_memcpy(below[i + 1].parts, &up, sizeof up);
    }
}

int blocksAcross(int pixels, int shift) {
    return ((pixels - 1) >> shift) + 1;
}

} // namespace

MomentTable::MomentTable(const Image& latlong, double absolute_energy, int shift, int threads)
    : pixel_width_(latlong.width),
      pixel_height_(latlong.height),
      shift_(shift),
      table_(blocksAcross(latlong.width, shift), blocksAcross(latlong.height, shift)) {
    const double scale = absolute_energy > 0 ? std::ldexp(1.0, 62) / absolute_energy : 0.0;
    const ColumnMoments columns = columnMoments(pixel_width_);
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        std::vector<double> blocks(4 * static_cast<std::size_t>(width()));
        table_.fillBand(static_cast<int>(band), [&](int y, const Sums* above, Sums* below) {
            std::fill(blocks.begin(), blocks.end(), 0.0);
            for (int j = y << shift_; j < std::min(pixel_height_, (y + 1) << shift_); ++j) {
                const RowMoments row = rowMoments(pixel_width_, pixel_height_, j);
                const double weights[4] = {scale * row.solid_angle, scale * row.horizontal,
                                           scale * row.vertical, scale * row.horizontal};
                addPixelRow(latlong.row(j), columns, weights, shift_, blocks.data());
            }
            addBlockRow(blocks.data(), width(), above, below);
        });
    });
    table_.addUpBands();
}

PixelRegion MomentTable::pixels(const PixelRegion& r) const {
    const int end = r.x + r.width;
    const int right = end <= width() ? std::min(pixel_width_, end << shift_)
                                     : pixel_width_ + ((end - width()) << shift_);
    const int x = r.x << shift_, y = r.y << shift_;
    return {x, y, std::min(right - x, pixel_width_),
            std::min(pixel_height_, (r.y + r.height) << shift_) - y};
}

double MomentTable::variance(const PixelRegion& region) const {
    const Sums s = table_.sum(region);
    if (s.parts[0] <= 0) return 0;
    const double w = static_cast<double>(s.parts[0]);
    double squared = 0;
    for (std::size_t k = 1; k < 4; ++k) {
        const double m = static_cast<double>(s.parts[k]) / w;
        squared += m * m;
    }
    return std::max(0.0, w * (1 - squared));
}

} // namespace ibl
