#include "core/parallel.h"
#include "lights/cut_tree.h"
#include "lights/lit_lanes.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <array>
#include <numeric>

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
    for (; i + kLanes <= end; i += kLanes) {
        fetchAhead(row + 3 * i);
        addPixels(pixelLanes(row + 3 * i), loadLanes(sine + i), loadLanes(cosine + i), sums);
    }
    if (i >= end) return;
    if (end >= kLanes) {
        addPixels(endPixelLanes(row, end, end - i), loadLanes(sine + end - kLanes),
                  loadLanes(cosine + end - kLanes), sums);
        return;
    }
    double last[2][kLanes]{};
    std::copy(sine + i, sine + end, last[0]);
    std::copy(cosine + i, cosine + end, last[1]);
    addPixels(lastPixelLanes(row + 3 * i, end - i), loadLanes(last[0]), loadLanes(last[1]), sums);
}

/// What some rows of a region hold, kLanes sums of each.
struct BandSums {
    int region;
    double solid_angle = 0;
    std::array<double, kLanes> red{}, green{}, blue{}, luminance{}, along_x{}, along_y{}, along_z{};
};

double sumOf(const std::array<double, kLanes>& v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

/// Rows [begin, end), one after the other over all the band's regions, so that pixels are read in
/// the order in which they lie.
IBL_MULTIVERSION
void addBand(const Image& latlong, const Moments& moments, const std::vector<PixelRegion>& regions,
             int begin, int end, std::vector<BandSums>& band) {
    const int width = latlong.width;
    for (int j = begin; j < end; ++j) {
        const RowMoments& row = moments.rows[static_cast<std::size_t>(j)];
        const float* pixels = latlong.row(j);
        for (BandSums& sums : band) {
            const PixelRegion& r = regions[static_cast<std::size_t>(sums.region)];
            if (j < r.y || j >= r.y + r.height) continue;
            LaneSums line;
            addColumns(pixels, moments.columns, r.x, std::min(width, r.x + r.width), line);
            addColumns(pixels, moments.columns, 0, r.x + r.width - width, line);
            addTo(sums.red.data(), line.red * row.solid_angle);
            addTo(sums.green.data(), line.green * row.solid_angle);
            addTo(sums.blue.data(), line.blue * row.solid_angle);
            addTo(sums.luminance.data(), line.luminance * row.solid_angle);
            addTo(sums.along_x.data(), line.along_x * row.horizontal);
            addTo(sums.along_z.data(), line.along_z * row.horizontal);
            addTo(sums.along_y.data(), line.luminance * row.vertical);
            sums.solid_angle += row.solid_angle * r.width;
        }
    }
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
    constexpr int kBand = 32;
    std::vector<std::vector<BandSums>> bands(
        static_cast<std::size_t>((latlong.height + kBand - 1) / kBand));
    std::vector<int> from_left(regions.size());
    std::iota(from_left.begin(), from_left.end(), 0);
    std::ranges::stable_sort(from_left, {}, [&](int i) { return regions[i].x; });
    for (const int i : from_left) {
        const PixelRegion& r = regions[static_cast<std::size_t>(i)];
        for (int band = r.y / kBand; band * kBand < r.y + r.height; ++band)
            bands[static_cast<std::size_t>(band)].push_back({.region = i});
    }
    parallelFor(bands.size(), threads, [&](std::size_t band) {
        const int begin = static_cast<int>(band) * kBand;
        addBand(latlong, moments, regions, begin, std::min(latlong.height, begin + kBand),
                bands[band]);
    });
    std::vector<RegionSums> sums(regions.size());
    for (const std::vector<BandSums>& band : bands) {
        for (const BandSums& part : band) {
            sums[static_cast<std::size_t>(part.region)] +=
                {{sumOf(part.red), sumOf(part.green), sumOf(part.blue)},
                 {sumOf(part.along_x), sumOf(part.along_y), sumOf(part.along_z)},
                 sumOf(part.luminance),
                 part.solid_angle};
        }
    }
    return sums;
}

} // namespace ibl
