#include "lights/moment_table.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

/// Makes the row's blocks, which stand where its sums will, those sums.
IBL_MULTIVERSION
void addBlockRow(int width, double scale, const MomentTable::Sums* above,
                 MomentTable::Sums* below) {
    LongLanes sum{};
    below[0] = {};
    for (int i = 1; i <= width; ++i) {
        Lanes block;
        __builtin_memcpy(&block, below[i].parts, sizeof block);
        sum += rounded(scale * block);
        LongLanes up;
        __builtin_memcpy(&up, above[i].parts, sizeof up);
        up += sum;
        __builtin_memcpy(below[i].parts, &up, sizeof up);
    }
}

} // namespace

MomentTable::MomentTable(const Image& latlong, int shift, int threads)
    : blocks_{latlong.width, latlong.height, shift}, table_(blocks_.width(), blocks_.height()) {
    static_assert(sizeof(Sums) == 4 * sizeof(double));
    const ColumnMoments columns = columnMoments(latlong.width);
    std::vector<double> energies(static_cast<std::size_t>(height()));
    parallelForRuns(energies.size(), 32, threads, [&](std::size_t begin, std::size_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            double* blocks = reinterpret_cast<double*>(table_.place(y));
            std::fill_n(blocks, 4 * static_cast<std::size_t>(width()), 0.0);
            for (int j = y << shift; j < std::min(latlong.height, (y + 1) << shift); ++j) {
                const RowMoments row = rowMoments(latlong.width, latlong.height, j);
                const double weights[4] = {row.solid_angle, row.horizontal, row.vertical,
                                           row.horizontal};
                addPixelRow(latlong.row(j), columns, weights, shift, blocks);
            }
            for (int i = 0; i < width(); ++i)
                energies[static_cast<std::size_t>(y)] += blocks[4 * i];
        }
    });
    const double energy = std::accumulate(energies.begin(), energies.end(), 0.0);
    const double scale = energy > 0 ? std::ldexp(1.0, 62) / energy : 0.0;
    parallelFor(static_cast<std::size_t>(table_.bands()), threads, [&](std::size_t band) {
        table_.fillBand(static_cast<int>(band), [&](int, const Sums* above, Sums* below) {
            addBlockRow(width(), scale, above, below);
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
