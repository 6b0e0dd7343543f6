#include "lights/moment_table.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

/// Energy and moments of a pixel are its luminance times `row` times its column's (1, sin, 1, cos).
IBL_MULTIVERSION
void addMomentRow(const float* rgb, const ColumnMoments& columns, const double (&row)[4],
                  const MomentTable::Sums* above, MomentTable::Sums* below) {
    const int width = static_cast<int>(columns.sine.size());
    const Lanes weights = loadLanes(row);
    LongLanes sum{};
    below[0] = {};
    const auto addPixel = [&](int i, double luminance) __attribute__((always_inline)) {
        const std::size_t column = static_cast<std::size_t>(i);
        const Lanes place{1, columns.sine[column], 1, columns.cosine[column]};
        sum += rounded(luminance * weights * place);
        LongLanes up;
        __builtin_memcpy(&up, above + i + 1, sizeof up);
        up += sum;
        __builtin_memcpy(below + i + 1, &up, sizeof up);
    };
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        const Lanes luminance = litLuminance(pixelLanes(rgb + 3 * i));
        for (int k = 0; k < kLanes; ++k)
            addPixel(i + k, luminance[k]);
    }
    if (i == width) return;
    const Lanes luminance = litLuminance(lastPixelLanes(rgb + 3 * i, width - i));
    for (int k = 0; i + k < width; ++k)
        addPixel(i + k, luminance[k]);
}

} // namespace

MomentTable::MomentTable(const Image& latlong, double lit_energy, int threads)
    : table_(latlong.width, latlong.height) {
    const int width = latlong.width, height = latlong.height;
    const double scale = lit_energy > 0 ? std::ldexp(1.0, 62) / lit_energy : 0.0;
    const ColumnMoments columns = columnMoments(width);
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(static_cast<int>(band), [&](int j, const Sums* above, Sums* below) {
            const RowMoments row = rowMoments(width, height, j);
            const double weights[4] = {scale * row.solid_angle, scale * row.horizontal,
                                       scale * row.vertical, scale * row.horizontal};
            addMomentRow(latlong.row(j), columns, weights, above, below);
        });
    });
    table_.addUpBands();
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
