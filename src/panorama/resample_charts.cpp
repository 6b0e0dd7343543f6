// Between lat-longs and cubes, by the exact overlaps of their pixels where it shrinks.
#include "panorama/latlong_moments.h"
#include "panorama/lookup.h"
#include "panorama/overlap_means.h"
#include "panorama/overlap_rows.h"
#include "panorama/resample_parts.h"

#include "core/parallel.h"

namespace ibl {
namespace {

/// Square root of a texel's solid angle: its area on the face times cos^3 of the angle from the
/// face's axis.
double texelPitch(double pitch_on_face, const V3d& direction) {
    const double longest =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    const double cosine = longest / direction.length();
    return pitch_on_face * cosine * std::sqrt(cosine);
}

} // namespace

void latlongToCube(const Panorama& source, Panorama& result, Enlarging enlarging, int threads) {
    const bool from_border = hasBorderRule(source.layout), to_border = hasBorderRule(result.layout);
    const CubePlacement place(result);
    const int edge = place.edge;
    const double pitch_on_face = centrePitch(2, edge, to_border);
    const double row_pitch = centrePitch(kPi, source.image.height, from_border);
    CubeLatlongOverlaps overlaps;
    if (areaShare(pitch_on_face / row_pitch, enlarging) > 0) {
        overlaps = cubeLatlongOverlaps(
            cubeGrid(edge, to_border),
            latlongGrid(source.image.width, source.image.height, from_border), threads);
    }
    const LatlongPixels pixels(source);
    if (overlaps.edge > 0) overlapMeans(overlaps, pixels, place, result.image, threads);
    // The corners' texels are the smallest.
    const double least = texelPitch(pitch_on_face, V3d(1)) / row_pitch;
    if (areaShare(least, enlarging) == 1) return;
    const Sampler sampler = makeSampler(source);
    parallelFor(static_cast<std::size_t>(6 * edge), threads, [&](std::size_t task) {
        const int face = static_cast<int>(task) / edge, j = static_cast<int>(task) % edge;
        const double t = 2 * centreAt(j, edge, to_border) - 1;
        for (int i = 0; i < edge; ++i) {
            const V3d direction = cubeDirection({face, 2 * centreAt(i, edge, to_border) - 1, t});
            const double pitch = texelPitch(pitch_on_face, direction);
            const double share = areaShare(pitch / row_pitch, enlarging);
            if (share == 1) continue;
            const V2i at = place.pixel(face, i, j);
            float* texel = result.image.at(at.x, at.y);
            V3d value = radianceAt(sampler, direction, pitch) * (1 - share);
            if (share > 0) value += V3d(texel[0], texel[1], texel[2]) * share;
            setPixel(texel, value);
        }
    });
}

void cubeToLatlong(const Panorama& source, Panorama& result, Enlarging enlarging, int threads,
                   Image* down) {
    const bool from_border = hasBorderRule(source.layout), to_border = hasBorderRule(result.layout);
    const CubePlacement place(source);
    const int edge = place.edge;
    const LatlongGrid grid = latlongGrid(result.image.width, result.image.height, to_border);
    const double pitch_on_face = centrePitch(2, edge, from_border);
    const double row_pitch = centrePitch(kPi, grid.rows(), to_border);

    CubeLatlongOverlaps overlaps;
    if (areaShare(row_pitch / texelPitch(pitch_on_face, V3d(1)), enlarging) > 0)
        overlaps = cubeLatlongOverlaps(cubeGrid(edge, from_border), grid, threads);
    const CubeLatlongRows by_rows = byRows(overlaps);
    const Sampler sampler = makeSampler(source);
    std::vector<V3d> equator(static_cast<std::size_t>(grid.columns));
    for (int x = 0; x < grid.columns; ++x) {
        equator[static_cast<std::size_t>(x)] =
            latlongDirection((x + 0.5 + grid.first) / grid.columns, 0.5);
    }
    parallelFor(static_cast<std::size_t>(grid.rows()), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const double v = centreAt(y, grid.rows(), to_border);
        const double sine = std::sin(kPi * v), cosine = std::cos(kPi * v);
        if (down) {
            std::vector<MomentSum> moments(grid.columns);
            forEachOverlapInRow(
                overlaps, by_rows, y,
                [&](int face, int i, int j, int column, double area, double right, double lower) {
                    const V2i at = place.pixel(face, i, j);
                    moments[column].add(source.image.at(at.x, at.y), area, right, lower);
                });
            storeRow(moments, y, result.image, *down);
            return;
        }
        std::vector<AreaSum> sums(overlaps.edge > 0 ? grid.columns : 0);
        if (!sums.empty()) {
            forEachOverlapInRow(
                overlaps, by_rows, y,
                [&](int face, int i, int j, int column, double area, double, double) {
                    const V2i at = place.pixel(face, i, j);
                    sums[column].add(source.image.at(at.x, at.y), area);
                });
        }
        for (int x = 0; x < grid.columns; ++x) {
            if (enlarging == Enlarging::hold) {
                setPixel(result.image.at(x, y), sums[x].mean());
                continue;
            }
            const V3d& level = equator[static_cast<std::size_t>(x)];
            const V3d direction(level.x * sine, cosine, level.z * sine);
            const double share =
                areaShare(row_pitch / texelPitch(pitch_on_face, direction), enlarging);
            V3d value(0);
            if (share > 0) value += sums[x].mean() * share;
            if (share < 1) value += radianceAt(sampler, direction) * (1 - share);
            setPixel(result.image.at(x, y), value);
        }
    });
}

} // namespace ibl
