#include "lights/moment_table.h"

#include "core/parallel.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

/// Adds to `blocks` what kLanes pixels weigh, of which the first is pixel i of its row.
IBL_INLINE void addPixels(const Lanes& value, const Lanes& weights, const ColumnMoments& columns,
                          int i, int shift, double* blocks) {
    Lanes v[kLanes];
    for (int k = 0; k < kLanes; ++k)
        v[k] = value[k] * weights * Lanes{1, columns.sine[i + k], 1, columns.cosine[i + k]};
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

IBL_INLINE Lanes magnitude(const Lanes& v) {
    return v > 0 ? v : -v;
}

/// Adds a row of pixels to its blocks' energies and moments, four doubles each, of luminance, red
/// and blue. A pixel's are its value times `row` times its column's (1, sin, 1, cos).
IBL_MULTIVERSION
void addPixelRow(const float* rgb, const ColumnMoments& columns, const double (&row)[4], int shift,
                 const std::array<double*, 3>& blocks) {
    const int width = static_cast<int>(columns.sine.size());
    const Lanes weights = loadLanes(row);
    const auto values = [](const PixelLanes& p) {
        return std::array<Lanes, 3>{absoluteLuminance(p), magnitude(kLuminanceRed * p.red),
                                    magnitude(kLuminanceBlue * p.blue)};
    };
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        fetchAhead(rgb + 3 * i);
        const std::array<Lanes, 3> v = values(pixelLanes(rgb + 3 * i));
        for (std::size_t c = 0; c < 3; ++c)
            addPixels(v[c], weights, columns, i, shift, blocks[c]);
    }
    if (i == width) return;
    const std::array<Lanes, 3> v = values(lastPixelLanes(rgb + 3 * i, width - i));
    for (int k = 0; i < width; ++i, ++k) {
        const Lanes moments{1, columns.sine[i], 1, columns.cosine[i]};
        for (std::size_t c = 0; c < 3; ++c)
            addTo(blocks[c] + 4 * (i >> shift), v[c][k] * weights * moments);
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
    : blocks_{latlong.width, latlong.height, shift},
      table_(blocks_.width(), blocks_.height()),
      red_(blocks_.width(), blocks_.height()),
      blue_(blocks_.width(), blocks_.height()) {
    static_assert(sizeof(Sums) == 4 * sizeof(double));
    const std::array<PrefixTable<Sums>*, 3> tables{&table_, &red_, &blue_};
    const ColumnMoments columns = columnMoments(latlong.width);
    std::vector<std::array<double, 3>> energies(static_cast<std::size_t>(height()));
    parallelForRuns(energies.size(), 32, threads, [&](std::size_t begin, std::size_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            std::array<double*, 3> blocks{};
            for (std::size_t c = 0; c < 3; ++c) {
                blocks[c] = reinterpret_cast<double*>(tables[c]->place(y));
                std::fill_n(blocks[c], 4 * static_cast<std::size_t>(width()), 0.0);
            }
            for (int j = y << shift; j < std::min(latlong.height, (y + 1) << shift); ++j) {
                const RowMoments row = rowMoments(latlong.width, latlong.height, j);
                const double weights[4] = {row.solid_angle, row.horizontal, row.vertical,
                                           row.horizontal};
                addPixelRow(latlong.row(j), columns, weights, shift, blocks);
            }
            for (std::size_t c = 0; c < 3; ++c) {
                for (int i = 0; i < width(); ++i)
                    energies[static_cast<std::size_t>(y)][c] += blocks[c][4 * i];
            }
        }
    });
    std::array<double, 3> scales{};
    for (std::size_t c = 0; c < 3; ++c) {
        double energy = 0;
        for (const std::array<double, 3>& row : energies)
            energy += row[c];
        scales[c] = energy > 0 ? std::ldexp(1.0, 62) / energy : 0.0;
    }
    red_unit_ = scales[1] > 0 ? scales[0] / scales[1] : 0;
    blue_unit_ = scales[2] > 0 ? scales[0] / scales[2] : 0;
    const std::size_t bands = static_cast<std::size_t>(table_.bands());
    parallelFor(3 * bands, threads, [&](std::size_t task) {
        const std::size_t c = task / bands;
        tables[c]->fillBand(static_cast<int>(task % bands),
                            [&](int, const Sums* above, Sums* below) {
                                addBlockRow(width(), scales[c], above, below);
                            });
    });
    for (PrefixTable<Sums>* table : tables)
        table->addUpBands();
}

double MomentTable::colourDisplacement(const PixelRegion& region) const {
    const Sums whole = table_.sum(region);
    if (whole.parts[0] <= 0) return 0;
    const double w = static_cast<double>(whole.parts[0]);
    // Weighted by their parts in luminance, the channels' displacements sum to nothing.
    const auto displaced = [&](const Sums& s, double unit) {
        V3d d;
        for (int k = 0; k < 3; ++k) {
            d[k] = unit * (static_cast<double>(s.parts[k + 1]) -
                           static_cast<double>(whole.parts[k + 1]) *
                               (static_cast<double>(s.parts[0]) / w));
        }
        return d;
    };
    const V3d red = displaced(red_.sum(region), red_unit_);
    const V3d blue = displaced(blue_.sum(region), blue_unit_);
    const double squares = (red / kLuminanceRed).length2() +
                           ((red + blue) / kLuminanceGreen).length2() +
                           (blue / kLuminanceBlue).length2();
    return std::sqrt(squares / 3);
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
