#include "panorama/lookup.h"

#include "panorama/square_maps.h"

#include <algorithm>

namespace ibl {
namespace {

V3d rgb(const float* pixel) {
    return {pixel[0], pixel[1], pixel[2]};
}

bool isLatlong(Layout layout) {
    return layout == Layout::latlong || layout == Layout::exrLatlong;
}

/// Columns around a parallel: by the border rule the first and the last are one.
int columnsAround(const Panorama& p) {
    const bool border = p.layout == Layout::exrLatlong;
    return border ? std::max(1, p.image.width - 1) : p.image.width;
}

/// Column k of a row, around the seam; k at most one turn outside.
V3d wrapped(const Panorama& p, int columns, const float* row, long k) {
    const long c = k < 0 ? k + columns : (k >= columns ? k - columns : k);
    if (p.layout == Layout::exrLatlong && c == 0) {
        return (rgb(row) + rgb(row + 3L * (p.image.width - 1))) * 0.5;
    }
    return rgb(row + 3 * c);
}

/// Mean over [x - width/2, x + width/2] of the row's linear interpolant, x and width in columns
/// from the first one's centre; its value at x for width 0.
V3d alongRow(const Panorama& p, int columns, const float* row, double x, double width) {
    const auto at = [&](double position) {
        const double cell = std::floor(position), f = position - cell;
        return wrapped(p, columns, row, static_cast<long>(cell)) * (1 - f) +
               wrapped(p, columns, row, static_cast<long>(cell) + 1) * f;
    };
    if (width <= 0) return at(x);
    const double begin = x - 0.5 * width, end = x + 0.5 * width;
    V3d sum(0);
    // The interpolant is linear between centres: trapezia are exact.
    for (double a = begin; a < end;) {
        const double b = std::min(end, std::floor(a) + 1);
        sum += at(0.5 * (a + b)) * (b - a);
        a = b;
    }
    return sum / (end - begin);
}

V3d rowMean(const Panorama& p, int row) {
    const int columns = columnsAround(p);
    V3d sum(0);
    for (int k = 0; k < columns; ++k)
        sum += wrapped(p, columns, p.image.row(row), k);
    return sum / columns;
}

V3d latlongRadiance(const Sampler& sampler, const V3d& direction, double width) {
    const Panorama& p = *sampler.panorama;
    const bool border = p.layout == Layout::exrLatlong;
    const int columns = columnsAround(p), rows = p.image.height;
    const V2d point = latlongPoint(direction);
    double x = border ? point.x * columns : point.x * columns - 0.5;
    if (x >= columns) x -= columns;

    // One column's width is what interpolation smooths by anyway; all the way round stays all.
    double columns_wide = 0;
    if (width > 0 && columns > 1) {
        const double around = 2 * kPi *
                              std::sqrt(direction.x * direction.x + direction.z * direction.z) /
                              direction.length();
        const double covered = width < around ? width / around * columns : columns;
        columns_wide = std::max(0.0, covered - 1) * columns / (columns - 1);
    }
    // Rows are nodes of an interpolation whose first and last nodes are the poles.
    const auto node = [&](int row) {
        if (row < 0 || (border && row == 0)) return sampler.north;
        if (row >= rows || (border && row == rows - 1)) return sampler.south;
        return alongRow(p, columns, p.image.row(row), x, columns_wide);
    };
    if (border) {
        if (rows == 1) return sampler.north;
        const double y = point.y * (rows - 1);
        const int row = std::min(static_cast<int>(y), rows - 2);
        return node(row) * (row + 1 - y) + node(row + 1) * (y - row);
    }
    const double y = point.y * rows - 0.5;
    if (y < 0) return node(-1) * (-2 * y) + node(0) * (1 + 2 * y);
    if (y > rows - 1) {
        const double f = 2 * (y - (rows - 1));
        return node(rows - 1) * (1 - f) + node(rows) * f;
    }
    const int row = static_cast<int>(y);
    const double f = y - row;
    return f == 0 ? node(row) : node(row) * (1 - f) + node(row + 1) * f;
}

V3d faceTexel(const Sampler& sampler, int face, int i, int j) {
    const V2i pixel = sampler.faces[face].pixel(i, j);
    return rgb(sampler.panorama->image.at(pixel.x, pixel.y));
}

V3d bilinear(const V3d& a, const V3d& b, const V3d& c, const V3d& d, double fx, double fy) {
    return (a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy;
}

/// Texel (i, j) of a face, one of the two at most one step outside it: then its neighbour across
/// the edge. The direction of the imagined texel's centre meets the next face less than half a
/// texel from the neighbour's centre (at worst N / (2 (N + 1)) of one), so that it is found by
/// rounding.
V3d texelAcross(const Sampler& sampler, int face, int i, int j) {
    const int edge = sampler.edge;
    if (i >= 0 && j >= 0 && i < edge && j < edge) return faceTexel(sampler, face, i, j);
    const CubePoint p = cubePoint(cubeTexelDirection(face, i, j, edge));
    const auto index = [&](double s) {
        return std::clamp(static_cast<int>(0.5 * (s + 1) * edge), 0, edge - 1);
    };
    return faceTexel(sampler, p.face, index(p.s), index(p.t));
}

V3d cubeRadiance(const Sampler& sampler, const V3d& direction) {
    const int edge = sampler.edge;
    const CubePoint p = cubePoint(direction);
    const double x = 0.5 * (p.s + 1) * edge - 0.5, y = 0.5 * (p.t + 1) * edge - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const double fx = x - i, fy = y - j;
    if (i >= 0 && j >= 0 && i + 1 < edge && j + 1 < edge) {
        return bilinear(faceTexel(sampler, p.face, i, j), faceTexel(sampler, p.face, i + 1, j),
                        faceTexel(sampler, p.face, i, j + 1),
                        faceTexel(sampler, p.face, i + 1, j + 1), fx, fy);
    }
    std::array<V3d, 4> texels;
    int corner = -1;
    V3d sum(0);
    for (int k = 0; k < 4; ++k) {
        const int a = i + k % 2, b = j + k / 2;
        if ((a < 0 || a >= edge) && (b < 0 || b >= edge)) {
            corner = k;
            continue;
        }
        texels[k] = texelAcross(sampler, p.face, a, b);
        sum += texels[k];
    }
    if (corner >= 0) texels[corner] = sum / 3;
    return bilinear(texels[0], texels[1], texels[2], texels[3], fx, fy);
}

/// OpenEXR's faces carry their own edges, so that a lookup never leaves its face.
V3d borderCubeRadiance(const Sampler& sampler, const V3d& direction) {
    const int edge = sampler.edge;
    const CubePoint p = cubePoint(direction);
    if (edge == 1) return faceTexel(sampler, p.face, 0, 0);
    const double x = 0.5 * (p.s + 1) * (edge - 1), y = 0.5 * (p.t + 1) * (edge - 1);
    const int i = std::clamp(static_cast<int>(x), 0, edge - 2);
    const int j = std::clamp(static_cast<int>(y), 0, edge - 2);
    const double fx = x - i, fy = y - j;
    const auto at = [&](int a, int b) { return faceTexel(sampler, p.face, a, b); };
    return bilinear(at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1), fx, fy);
}

/// Texel (i, j) of an octahedral map, one step outside it at most: its edges are folded about their
/// middles.
V3d octahedralTexel(const Panorama& p, int i, int j) {
    const int n = p.image.width;
    if (i < 0 || i >= n) {
        i = i < 0 ? 0 : n - 1;
        j = n - 1 - j;
    }
    if (j < 0 || j >= n) {
        j = j < 0 ? 0 : n - 1;
        i = n - 1 - i;
    }
    return rgb(p.image.at(std::clamp(i, 0, n - 1), std::clamp(j, 0, n - 1)));
}

/// The texel of a ball map at (i, j), or, for one whose centre is as far outside the rim, what lies
/// as far within it on the other side, past -Z.
std::optional<V3d> ballTexel(const Panorama& p, int i, int j) {
    const int n = p.image.width;
    const V2d at((2.0 * i + 1) / n - 1, (2.0 * j + 1) / n - 1);
    const double rho = at.length();
    if (rho <= 1) return rgb(p.image.at(i, j));
    const V2d across = at * ((rho - 2) / rho);
    const auto index = [n](double s) {
        return std::clamp(static_cast<int>(0.5 * (s + 1) * n), 0, n - 1);
    };
    const auto owner = owningTexel(p.layout, n, index(across.x), index(across.y));
    if (!owner) return std::nullopt;
    return rgb(p.image.at(owner->x, owner->y));
}

V3d squareMapRadiance(const Panorama& p, const V3d& direction) {
    const V2d at = texelPoint(p.layout, p.image.width, p.image.height, direction) - V2d(0.5);
    const int i = static_cast<int>(std::floor(at.x)), j = static_cast<int>(std::floor(at.y));
    const double fx = at.x - i, fy = at.y - j;
    V3d sum(0);
    double weights = 0;
    for (int k = 0; k < 4; ++k) {
        const int a = i + k % 2, b = j + k / 2;
        const double weight = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
        const std::optional<V3d> texel =
            isBallMap(p.layout) ? ballTexel(p, a, b) : octahedralTexel(p, a, b);
        if (!texel) continue;
        sum += *texel * weight;
        weights += weight;
    }
    return sum / weights;
}

} // namespace

Sampler makeSampler(const Panorama& panorama) {
    Sampler sampler;
    sampler.panorama = &panorama;
    const Image& image = panorama.image;
    if (isLatlong(panorama.layout)) {
        sampler.north = rowMean(panorama, 0);
        sampler.south = rowMean(panorama, image.height - 1);
        return sampler;
    }
    if (isSquareMap(panorama.layout)) return sampler;
    sampler.edge = *layoutSize(panorama.layout, image.width, image.height);
    for (int face = 0; face < 6; ++face) {
        sampler.faces[face] = facePlacement(panorama.layout, sampler.edge, face);
    }
    return sampler;
}

V3d radianceAt(const Sampler& sampler, const V3d& direction, double width) {
    const Layout layout = sampler.panorama->layout;
    if (isLatlong(layout)) return latlongRadiance(sampler, direction, width);
    if (isSquareMap(layout)) return squareMapRadiance(*sampler.panorama, direction);
    if (layout == Layout::exrCube) return borderCubeRadiance(sampler, direction);
    return cubeRadiance(sampler, direction);
}

V3d radianceAt(const Panorama& panorama, const V3d& direction) {
    return radianceAt(makeSampler(panorama), direction);
}

} // namespace ibl
