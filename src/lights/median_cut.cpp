#include "lights/median_cut.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace ibl {
namespace {

/// The column of least energy: where the circle of longitudes is opened.
int openingColumn(const SummedAreaTable& table) {
    int best = 0;
    std::int64_t least = table.energy({0, 0, 1, table.height()});
    for (int x = 1; x < table.width(); ++x) {
        const std::int64_t energy = table.energy({x, 0, 1, table.height()});
        if (energy < least) {
            least = energy;
            best = x;
        }
    }
    return best;
}

bool cutsLongitude(const SummedAreaTable& table, const PixelRegion& r) {
    if (r.height == 1) return true;
    if (r.width == 1) return false;
    const double middle_theta = kPi * (r.y + 0.5 * r.height) / table.height();
    const double across = 2 * kPi * r.width / table.width() * std::sin(middle_theta);
    const double down = kPi * r.height / table.height();
    return across >= down;
}

std::pair<PixelRegion, PixelRegion> cutAt(const SummedAreaTable& table, const PixelRegion& r,
                                          bool longitude, int first) {
    if (longitude) {
        return {{r.x, r.y, first, r.height},
                {(r.x + first) % table.width(), r.y, r.width - first, r.height}};
    }
    return {{r.x, r.y, r.width, first}, {r.x, r.y + first, r.width, r.height - first}};
}

/// Cuts a region of more than one pixel where the two sides' energies are most nearly equal. The
/// first side's energy grows with the cut, so the place is found by bisection. Where it does not
/// matter (an empty region, or all energy in one row) the middle of the equal places is taken.
std::pair<PixelRegion, PixelRegion> cutRegion(const SummedAreaTable& table, const PixelRegion& r) {
    const bool longitude = cutsLongitude(table, r);
    const int length = longitude ? r.width : r.height;
    const std::int64_t total = table.energy(r);
    // Twice the first side's energy less the total: its sign says on which side the median lies.
    const auto imbalance = [&](int first) {
        return 2 * (table.energy(cutAt(table, r, longitude, first).first) - total / 2) - total % 2;
    };
    const auto firstWhere = [&](auto reached) {
        int low = 1, high = length - 1; // the answer, or length - 1 when there is none below
        while (low < high) {
            const int middle = low + (high - low) / 2;
            if (reached(imbalance(middle)))
                high = middle;
            else
                low = middle + 1;
        }
        return low;
    };
    int cut = firstWhere([](std::int64_t d) { return d >= 0; });
    if (cut > 1 && std::abs(imbalance(cut - 1)) <= std::abs(imbalance(cut))) --cut;
    const std::int64_t reached = imbalance(cut);
    const int begin = firstWhere([&](std::int64_t d) { return d >= reached; });
    int end = firstWhere([&](std::int64_t d) { return d > reached; });
    if (imbalance(end) > reached) --end;
    return cutAt(table, r, longitude, begin + (end - begin) / 2);
}

/// Integral of the direction over each pixel of row j, as factors: x and z are `horizontal` times
/// the integral of (sin phi, cos phi) over the pixel, y is `vertical`.
struct RowMoments {
    double solid_angle;
    double horizontal;
    double vertical;
};

RowMoments rowMoments(int width, int height, int j) {
    const double top = kPi * j / height, bottom = kPi * (j + 1) / height;
    const double dphi = 2 * kPi / width;
    return {latlongPixelSolidAngle(width, height, j),
            0.5 * (bottom - top) - 0.5 * std::sin(bottom - top) * std::cos(bottom + top),
            dphi * 0.5 * std::sin(bottom - top) * std::sin(bottom + top)};
}

/// sin and cos of the longitude of each column's centre, times the chord 2 sin(dphi/2): the
/// integral of (sin phi, cos phi) over the column. (phi falls from left to right.)
struct ColumnMoments {
    std::vector<double> sine;
    std::vector<double> cosine;
};

ColumnMoments columnMoments(int width) {
    ColumnMoments columns;
    const double chord = 2 * std::sin(kPi / width);
    for (int i = 0; i < width; ++i) {
        const double phi = 2 * kPi * (0.5 - (i + 0.5) / width);
        columns.sine.push_back(chord * std::sin(phi));
        columns.cosine.push_back(chord * std::cos(phi));
    }
    return columns;
}

V3d directionOf(const V3d& moment, double longitude, double latitude) {
    const double length = moment.length();
    // A centroid near the sphere's centre points nowhere: take the middle of the region.
    if (length > 1e-9) return moment / length;
    const double phi = longitude * kPi / 180, lat = latitude * kPi / 180;
    return {std::cos(lat) * std::sin(phi), std::sin(lat), std::cos(lat) * std::cos(phi)};
}

Light lightOf(const Image& latlong, const ColumnMoments& columns, const PixelRegion& r) {
    const int width = latlong.width, height = latlong.height;
    V3d irradiance(0), moment(0);
    double solid_angle = 0, energy = 0;
    for (int j = r.y; j < r.y + r.height; ++j) {
        const RowMoments row = rowMoments(width, height, j);
        V3d sum(0);
        double luminance_sum = 0, along_x = 0, along_z = 0;
        for (int k = 0; k < r.width; ++k) {
            const int i = (r.x + k) % width;
            const float* rgb = latlong.at(i, j);
            const V3d radiance(rgb[0], rgb[1], rgb[2]);
            sum += radiance;
            const double luminance =
                std::max(0.0, radiance.dot({kLuminanceRed, kLuminanceGreen, kLuminanceBlue}));
            luminance_sum += luminance;
            along_x += luminance * columns.sine[static_cast<std::size_t>(i)];
            along_z += luminance * columns.cosine[static_cast<std::size_t>(i)];
        }
        irradiance += sum * row.solid_angle;
        moment +=
            V3d(along_x * row.horizontal, luminance_sum * row.vertical, along_z * row.horizontal);
        energy += luminance_sum * row.solid_angle;
        solid_angle += row.solid_angle * r.width;
    }
    Light light;
    light.irradiance = irradiance;
    light.solid_angle = solid_angle;
    // Columns run against longitude: the region's left edge is its greatest longitude.
    light.longitude[1] = 180 - 360.0 * r.x / width;
    light.longitude[0] = light.longitude[1] - 360.0 * r.width / width;
    if (light.longitude[0] < -180) {
        light.longitude[0] += 360;
        light.longitude[1] += 360;
    }
    light.latitude[0] = 90 - 180.0 * (r.y + r.height) / height;
    light.latitude[1] = 90 - 180.0 * r.y / height;
    light.direction = directionOf(energy > 0 ? moment / energy : V3d(0),
                                  0.5 * (light.longitude[0] + light.longitude[1]),
                                  0.5 * (light.latitude[0] + light.latitude[1]));
    return light;
}

} // namespace

std::vector<PixelRegion> medianCutRegions(const SummedAreaTable& table, int count) {
    std::vector<PixelRegion> regions{{openingColumn(table), 0, table.width(), table.height()}};
    const auto isLit = [&](const PixelRegion& r) { return table.energy(r) > 0; };
    std::size_t lit = isLit(regions[0]) ? 1 : 0;
    while (lit < static_cast<std::size_t>(count)) {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            if (isLit(regions[i]) && (regions[i].width > 1 || regions[i].height > 1)) {
                order.push_back(i);
            }
        }
        if (order.empty()) break;
        const std::size_t wanted = static_cast<std::size_t>(count) - lit;
        if (order.size() > wanted) {
            std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
                return table.energy(regions[a]) > table.energy(regions[b]);
            });
            order.resize(wanted);
        }
        for (const std::size_t i : order) {
            const auto [first, second] = cutRegion(table, regions[i]);
            regions[i] = first;
            regions.push_back(second);
            if (isLit(first) && isLit(second)) ++lit;
        }
    }
    return regions;
}

std::vector<Light> medianCut(const Image& latlong, int count, int threads) {
    const SummedAreaTable table(latlong, threads);
    const std::vector<PixelRegion> regions = medianCutRegions(table, count);
    const ColumnMoments columns = columnMoments(latlong.width);
    std::vector<Light> all(regions.size());
    parallelFor(all.size(), threads,
                [&](std::size_t i) { all[i] = lightOf(latlong, columns, regions[i]); });

    std::vector<Light> lights;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (table.energy(regions[i]) > 0) lights.push_back(all[i]);
    }
    if (lights.empty()) return lights;
    // A region without luminance is no light; what colour it has all the same (negative pixels, a
    // radiance below the table's resolution) belongs to the light beside it.
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (table.energy(regions[i]) > 0 || all[i].irradiance == V3d(0)) continue;
        const auto nearest =
            std::max_element(lights.begin(), lights.end(), [&](const Light& a, const Light& b) {
                return a.direction.dot(all[i].direction) < b.direction.dot(all[i].direction);
            });
        nearest->irradiance += all[i].irradiance;
    }
    const V3d weights(kLuminanceRed, kLuminanceGreen, kLuminanceBlue);
    std::stable_sort(lights.begin(), lights.end(), [&](const Light& a, const Light& b) {
        return a.irradiance.dot(weights) > b.irradiance.dot(weights);
    });
    return lights;
}

V3d totalIrradiance(const std::vector<Light>& lights) {
    return std::accumulate(
        lights.begin(), lights.end(), V3d(0),
        [](const V3d& sum, const Light& light) { return sum + light.irradiance; });
}

} // namespace ibl
