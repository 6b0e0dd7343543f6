#include "panorama/latlong_moments.h"

#include "panorama/layouts.h"
#include "panorama/resample_parts.h"
#include "panorama/square_maps.h"

#include "core/parallel.h"

#include <cmath>

namespace ibl {
namespace {

/// Of a row between the parallels cos(theta) = z.
struct Band {
    double top, bottom;

    Band(int rows, int row)
        : top(std::cos(kPi * row / rows)), bottom(std::cos(kPi * (row + 1) / rows)) {}
    double height() const { return top - bottom; }
    double middle() const { return 0.5 * (top + bottom); }
};

/// Moves light between the rows above and below each until its moment is kept.
void spreadDown(const Image& down, int threads, Image& result) {
    const int rows = result.height, values = 3 * result.width;
    if (rows < 2) return;
    parallelFor(static_cast<std::size_t>(rows), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        float* out = result.row(y);
        for (const int from : {y - 1, y, y + 1}) {
            if (from < 0 || from >= rows) continue;
            const int above = std::max(0, from - 1), below = std::min(rows - 1, from + 1);
            if (y != above && y != below) continue;
            const Band band(rows, from);
            const double apart = Band(rows, above).middle() - Band(rows, below).middle();
            const double weight = (y == below ? 1 : -1) * band.height() * band.height() /
                                  (apart * Band(rows, y).height());
            const float* moments = down.row(from);
            for (int k = 0; k < values; ++k)
                out[k] = static_cast<float>(out[k] + weight * moments[k]);
        }
    });
}

} // namespace

void storeRow(const std::vector<MomentSum>& sums, int y, Image& result, Image& down) {
    const std::size_t width = sums.size();
    std::vector<V3d> means(width), right(width);
    for (std::size_t x = 0; x < width; ++x) {
        const MomentSum& sum = sums[x];
        means[x] = sum.radiance / sum.area;
        right[x] = (sum.right - means[x] * sum.area_right) / sum.area;
        setPixel(down.at(static_cast<int>(x), y), (sum.down - means[x] * sum.area_down) / sum.area);
    }
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t before = (x + width - 1) % width, after = (x + 1) % width;
        setPixel(result.at(static_cast<int>(x), y),
                 means[x] + (right[before] - right[after]) * 0.5);
    }
}

Panorama latlongOfMoments(const Panorama& probe, int rows, int threads) {
    const V2i extent = layoutExtent(Layout::latlong, rows);
    Panorama result{Layout::latlong, Image(extent.x, extent.y)};
    Image down(extent.x, extent.y);
    if (isSquareMap(probe.layout)) {
        throughSquareMap(probe, probe, result, Enlarging::hold, threads, &down);
    } else if (isCubeFamily(probe.layout) || probe.layout == Layout::exrCube) {
        cubeToLatlong(probe, result, Enlarging::hold, threads, &down);
    } else {
        latlongToLatlong(probe, result, Enlarging::hold, threads, &down);
    }
    spreadDown(down, threads, result.image);
    return result;
}

Image halveKeepingMoments(const Image& latlong, int threads) {
    Image halved((latlong.width + 1) / 2, (latlong.height + 1) / 2), down = halved;
    parallelFor(static_cast<std::size_t>(halved.height), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const int last = std::min(2 * y + 1, latlong.height - 1);
        const double top = Band(latlong.height, 2 * y).top;
        const double height = top - Band(latlong.height, last).bottom;
        std::vector<MomentSum> sums(halved.width);
        for (int j = 2 * y; j <= last; ++j) {
            const Band band(latlong.height, j);
            const double lower = (top - band.middle()) / height - 0.5;
            for (int i = 0; i < latlong.width; ++i) {
                const bool alone = i + 1 == latlong.width && i % 2 == 0;
                const double right = alone ? 0 : i % 2 == 0 ? -0.25 : 0.25;
                sums[i / 2].add(latlong.at(i, j), band.height(), right * band.height(),
                                lower * band.height());
            }
        }
        storeRow(sums, y, halved, down);
    });
    spreadDown(down, threads, halved);
    return halved;
}

} // namespace ibl
