#include "core/parallel.h"
#include "lights/cut_tree.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"

#include <algorithm>

namespace ibl {
namespace {

/// Where the pixels are, worked out once for all regions.
struct Moments {
    ColumnMoments columns;
    std::vector<RowMoments> rows;
};

/// Luminance alone, and times the columns' sine and cosine; summed over a row's pixels.
struct LaneSums {
    Lanes red{}, green{}, blue{}, luminance{}, along_x{}, along_z{};
};

IBL_INLINE void addPixels(const PixelLanes& p, const Lanes& sine, const Lanes& cosine,
                          LaneSums& sums) {
    const Lanes luminance = litLuminance(p);
    sums.red += p.red;
    sums.green += p.green;
    sums.blue += p.blue;
    sums.luminance += luminance;
    sums.along_x += luminance * sine;
    sums.along_z += luminance * cosine;
}

IBL_INLINE void addColumns(const float* row, const ColumnMoments& columns, int begin, int end,
                           LaneSums& sums) {
    const double *sine = columns.sine.data(), *cosine = columns.cosine.data();
    int i = begin;
    for (; i + kLanes <= end; i += kLanes)
        addPixels(pixelLanes(row + 3 * i), loadLanes(sine + i), loadLanes(cosine + i), sums);
    if (i >= end) return;
    double last[2][kLanes]{};
    std::copy(sine + i, sine + end, last[0]);
    std::copy(cosine + i, cosine + end, last[1]);
    addPixels(lastPixelLanes(row + 3 * i, end - i), loadLanes(last[0]), loadLanes(last[1]), sums);
}

IBL_INLINE void fetchAhead(const float* row, const PixelRegion& r, int width) {
    constexpr int kStep = 16; // floats in a cache line
    const int end = 3 * std::min(width, r.x + r.width);
    for (int i = 3 * r.x; i < end; i += kStep)
        __builtin_prefetch(row + i);
}

IBL_MULTIVERSION
void addRegion(const Image& latlong, const Moments& moments, const PixelRegion& r,
               RegionSums& sums) {
    const int width = latlong.width;
    LaneSums all; // with the rows' factors
    Lanes along_y{};
    for (int j = r.y; j < r.y + r.height; ++j) {
        const RowMoments& row = moments.rows[static_cast<std::size_t>(j)];
        const float* pixels = latlong.row(j);
        // Narrow regions jump from row to row, which the machine does not foresee.
        if (j + 2 < r.y + r.height) fetchAhead(latlong.row(j + 2), r, width);
        LaneSums line;
        addColumns(pixels, moments.columns, r.x, std::min(width, r.x + r.width), line);
        addColumns(pixels, moments.columns, 0, r.x + r.width - width, line);
        all.red += line.red * row.solid_angle;
        all.green += line.green * row.solid_angle;
        all.blue += line.blue * row.solid_angle;
        all.luminance += line.luminance * row.solid_angle;
        all.along_x += line.along_x * row.horizontal;
        all.along_z += line.along_z * row.horizontal;
        along_y += line.luminance * row.vertical;
        sums.solid_angle += row.solid_angle * r.width;
    }
    sums.irradiance = {sumOf(all.red), sumOf(all.green), sumOf(all.blue)};
    sums.moment = {sumOf(all.along_x), sumOf(along_y), sumOf(all.along_z)};
    sums.energy = sumOf(all.luminance);
}

} // namespace

RegionSums& RegionSums::operator+=(const RegionSums& other) {
    irradiance += other.irradiance;
    moment += other.moment;
    energy += other.energy;
    solid_angle += other.solid_angle;
    return *this;
}

std::vector<RegionSums> regionSums(const Image& latlong, const std::vector<PixelRegion>& regions,
                                   int threads) {
    Moments moments{columnMoments(latlong.width), {}};
    for (int j = 0; j < latlong.height; ++j)
        moments.rows.push_back(rowMoments(latlong.width, latlong.height, j));
    std::vector<RegionSums> sums(regions.size());
    parallelFor(sums.size(), threads,
                [&](std::size_t i) { addRegion(latlong, moments, regions[i], sums[i]); });
    return sums;
}

} // namespace ibl
