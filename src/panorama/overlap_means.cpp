// An octant's cells stand for sixteen texels each, of the four side faces or of +-Y, whose overlaps
// are the same but for where columns and rows begin: they are summed side by side, from one pass
// over the table.
#include "panorama/overlap_means.h"

#include "core/parallel.h"
#include "core/simd.h"

namespace ibl {
namespace {

/// What an octant's table means on one of the sphere's sixteen octants: strides are in floats.
struct OctantImage {
    std::vector<std::ptrdiff_t> column; ///< where the pixels of a column stand in their row
    const float* row;                   ///< pixels of row 0
    std::ptrdiff_t row_step;
    float* texel; ///< of cell (0, 0)
    std::ptrdiff_t a_step, b_step;
};

constexpr int kOctants = 16;

/// The octants that use one table.
struct OctantImages {
    std::array<OctantImage, kOctants> images;
    int count = 0;
};

/// Cell (a, b) of all those octants.
IBL_INLINE void fillCell(const OctantTable& table, const OctantImages& octants, int a, int b) {
    const OctantOverlap* const parts = table.overlaps[a].data();
    const int count = octants.count;
    Lanes sums[kOctants];
    for (int o = 0; o < count; ++o)
        sums[o] = Lanes{};
    double area = 0;
    for (int k = table.begin[a][b]; k < table.begin[a][b + 1]; ++k) {
        const OctantOverlap& part = parts[k];
        area += part.area;
        for (int o = 0; o < count; ++o) {
            const OctantImage& octant = octants.images[o];
            const float* p = octant.row + part.row * octant.row_step + octant.column[part.column];
            sums[o] += part.area * Lanes{p[0], p[1], p[2], 0};
        }
    }
    const double inverse = 1 / area;
    for (int o = 0; o < count; ++o) {
        const OctantImage& octant = octants.images[o];
        float* texel = octant.texel + a * octant.a_step + b * octant.b_step;
        for (int c = 0; c < 3; ++c)
            texel[c] = static_cast<float>(sums[o][c] * inverse);
    }
}

// Along the lat-long's rows, more or less, which are far apart in memory.
IBL_MULTIVERSION
void fillSideRow(const OctantTable& table, const OctantImages& octants, int b, int first,
                 int cells) {
    for (int a = first; a < cells; ++a)
        fillCell(table, octants, a, b);
}

IBL_MULTIVERSION
void fillPoleRow(const OctantTable& table, const OctantImages& octants, int a, int first) {
    for (int b = first; b < a; ++b)
        fillCell(table, octants, a, b);
}

/// Texel (i, j) of a face that several octants share.
void fillTexel(const CubeLatlongOverlaps& overlaps, const LatlongPixels& pixels, int face, int i,
               int j, float* texel) {
    AreaSum sum;
    forEachOverlap(overlaps, face, i, j,
                   [&](int x, int y, double area) { sum.add(pixels.at(x, y), area); });
    setPixel(texel, sum.mean());
}

/// The octants of every table, of the side faces and of +-Y.
struct AllOctants {
    std::array<OctantImages, 4> side, pole;
};

AllOctants octantsOf(const CubeLatlongOverlaps& overlaps, const LatlongPixels& pixels,
                     const CubePlacement& cube, Image& image) {
    AllOctants all;
    for (const OctantPlace& place : octantPlaces(overlaps.rows)) {
        const CubeLatlongOverlaps::Wedge& wedge = overlaps.wedges[place.axis][place.higher];
        OctantImages& octants = (place.pole ? all.pole : all.side)[wedge.table];
        OctantImage& octant = octants.images[octants.count++];
        for (int n = 0; n < overlaps.columns / 8 + 3; ++n)
            octant.column.push_back(std::ptrdiff_t{3} * overlaps.column(wedge, n));
        octant.row = pixels.row(place.first_row);
        octant.row_step = std::ptrdiff_t{3} * pixels.columns() * (place.rows_down ? 1 : -1);
        const auto texel = [&](int a, int b) {
            const V2i in_face = place.texel(overlaps.edge, a, b);
            const V2i at = cube.pixel(place.face, in_face.x, in_face.y);
            return (std::ptrdiff_t{at.y} * image.width + at.x) * 3;
        };
        octant.texel = image.pixels.data() + texel(0, 0);
        octant.a_step = texel(1, 0) - texel(0, 0);
        octant.b_step = texel(0, 1) - texel(0, 0);
    }
    return all;
}

} // namespace

void overlapMeans(const CubeLatlongOverlaps& overlaps, const LatlongPixels& pixels,
                  const CubePlacement& place, Image& image, int threads) {
    const AllOctants all = octantsOf(overlaps, pixels, place, image);
    const int edge = overlaps.edge, cells = (edge + 1) / 2;
    const int own = edge % 2; // the first cell that is no half of a middle texel
    parallelFor(static_cast<std::size_t>(cells), threads, [&](std::size_t task) {
        const int row = static_cast<int>(task);
        for (int table = 0; table < 4 && row >= own; ++table) {
            if (all.side[table].count == 0) continue;
            fillSideRow(overlaps.side[table], all.side[table], row, own, cells);
            fillPoleRow(overlaps.pole[table], all.pole[table], row, own);
        }
    });
    // What octants share: the middle rows and columns, and the diagonals of +-Y.
    parallelFor(static_cast<std::size_t>(edge), threads, [&](std::size_t task) {
        const int i = static_cast<int>(task);
        const auto fill = [&](int face, int j) {
            const V2i at = place.pixel(face, i, j);
            fillTexel(overlaps, pixels, face, i, j, image.at(at.x, at.y));
        };
        for (int face = 0; face < 6; ++face) {
            const bool pole = face / 2 == 1;
            if (own == 1 && 2 * i + 1 == edge) {
                for (int j = 0; j < edge; ++j)
                    fill(face, j);
                continue;
            }
            if (own == 1) fill(face, edge / 2);
            if (pole) fill(face, i);
            if (pole) fill(face, edge - 1 - i);
        }
    });
}

} // namespace ibl
