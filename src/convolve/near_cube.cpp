#include "convolve/near_cube.h"

#include "convolve/near_groups.h"
#include "convolve/near_texel.h"
#include "convolve/peaks.h"
#include "convolve/row_geometry.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace ibl {
namespace {

/// A face as a plane at the distance 1: place (s, t) is `middle + s * right + t * down`.
struct Plane {
    V3d middle, right, down;
    bool turned; ///< right to down is clockwise as seen from outside

    explicit Plane(int face)
        : middle(polar(cubeDirection({face, 0, 0}))),
          right(polar(cubeDirection({face, 1, 0})) - middle),
          down(polar(cubeDirection({face, 0, 1})) - middle),
          turned(right.cross(down).dot(middle) < 0) {}

    V3d at(double s, double t) const { return (middle + right * s + down * t).normalized(); }
};

/// The texels of the probe.
struct Grid {
    int edge;
    std::vector<double> solid_angle; ///< [row][column] of any face

    double line(int i) const { return 2.0 * i / edge - 1; }
    double areaOf(int row, int column) const {
        return solid_angle[static_cast<std::size_t>(row) * edge + column];
    }
};

/// Those texels of a face that are near a map's texel, and their weights in it.
struct FaceBlock {
    int face = 0;
    int row = 0, rows = 0, column = 0, columns = 0;
    std::vector<double> weight; ///< [row][column]
    std::vector<char> near;     ///< which are by edges

    int at(int j, int i) const {
        return j < 0 || i < 0 || j >= rows || i >= columns ? -1 : j * columns + i;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) {
        if (isNear(pixel)) weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// The range of s that a cap about `c` meets, for the plane with the axes `right` and `middle`;
/// nothing where it is empty.
std::optional<V2d> rangeWithin(const V3d& c, const V3d& right, const V3d& middle, double radius) {
    const double x = c.dot(right), z = c.dot(middle), length = std::hypot(x, z);
    if (std::sin(radius) >= length || radius >= 0.5 * kPi) return V2d(-1, 1);
    const double at = std::atan2(x, z), width = std::asin(std::sin(radius) / length);
    const double low = at - width, high = at + width;
    if (low >= 0.5 * kPi || high <= -0.5 * kPi) return std::nullopt;
    const V2d range(low <= -0.5 * kPi ? -1 : std::max(-1.0, std::tan(low)),
                    high >= 0.5 * kPi ? 1 : std::min(1.0, std::tan(high)));
    if (range.x >= range.y) return std::nullopt;
    return range;
}

std::vector<FaceBlock> blocksAbout(const Grid& grid, const V3d& centre, double radius) {
    std::vector<FaceBlock> blocks;
    for (int face = 0; face < 6; ++face) {
        const Plane plane(face);
        const auto s = rangeWithin(centre, plane.right, plane.middle, radius);
        const auto t = rangeWithin(centre, plane.down, plane.middle, radius);
        if (!s || !t) continue;
        const auto texel = [&](double place) {
            return std::clamp(static_cast<int>(0.5 * (place + 1) * grid.edge), 0, grid.edge - 1);
        };
        FaceBlock block;
        block.face = face;
        block.column = texel(s->x);
        block.columns = texel(s->y) + 1 - block.column;
        block.row = texel(t->x);
        block.rows = texel(t->y) + 1 - block.row;
        const std::size_t count = static_cast<std::size_t>(block.rows) * block.columns;
        block.weight.assign(count, 0.0);
        block.near.assign(count, 0);
        blocks.push_back(std::move(block));
    }
    return blocks;
}

/// The mean of the kernel over a texel of the probe and the points of the map's: by 2 x 2 points.
double meanOf(const RadialTable& value, const Grid& grid, const Plane& plane, int row, int column,
              const std::vector<TexelPoint>& texel) {
    const double half = 1.0 / grid.edge, off = half / std::numbers::sqrt3;
    double mean = 0, total = 0;
    for (const double t : {-off, off}) {
        for (const double s : {-off, off}) {
            const double x = grid.line(column) + half + s, y = grid.line(row) + half + t;
            const V3d d = plane.at(x, y);
            const double share = std::pow(1 + x * x + y * y, -1.5);
            for (const TexelPoint& point : texel)
                mean += share * point.share * value((d - point.at).length2());
            total += share;
        }
    }
    return mean / total;
}

/// Marks the texels that are near and sets the others' weights, as near_weights.cpp does.
void addFar(const NearField& field, const Grid& grid, const Texel& texel, FaceBlock& block) {
    const Plane plane(block.face);
    const double extent = 2.0 / grid.edge; // at most
    const double far = field.rules.far * std::hypot(1.4 * texel.radius, extent);
    const double reach = field.kernel.reach + texel.radius + extent;
    for (int j = 0; j < block.rows; ++j) {
        for (int i = 0; i < block.columns; ++i) {
            const int row = block.row + j, column = block.column + i;
            const auto at = static_cast<std::size_t>(block.at(j, i));
            const V3d middle =
                plane.at(grid.line(column) + 0.5 * extent, grid.line(row) + 0.5 * extent);
            const double distance = (middle - texel.centre).length();
            if (distance < far) {
                block.near[at] = 1;
            } else if (distance <= reach) {
                block.weight[at] = grid.areaOf(row, column) *
                                   meanOf(field.value, grid, plane, row, column, texel.four);
            }
        }
    }
}

/// Adds what all edges of the near texels carry.
void addNear(const Flow& flow, const Grid& grid, FaceBlock& block) {
    const Plane plane(block.face);
    // From (s, t) along `right` or `down`; `left` and `other` lie on its two sides.
    const auto carry = [&](int left, int other, double s, double t, double ds, double dt) {
        if (!block.isNear(left) && !block.isNear(other)) return;
        std::vector<Arc> arcs;
        addCurve([&](double k) { return plane.at(s + k * ds, t + k * dt); }, 0, 1, 1, kLongest,
                 arcs);
        if (plane.turned) std::swap(left, other);
        for (const Arc& arc : arcs) {
            const double carried = flow.across(arc);
            block.add(left, carried);
            block.add(other, -carried);
        }
    };
    const double step = 2.0 / grid.edge;
    for (int j = 0; j <= block.rows; ++j) {
        for (int i = 0; i <= block.columns; ++i) {
            const double s = grid.line(block.column + i), t = grid.line(block.row + j);
            // Counter-clockwise from right to down: what is farther down lies left of `right`.
            if (i < block.columns) carry(block.at(j, i), block.at(j - 1, i), s, t, step, 0);
            if (j < block.rows) carry(block.at(j, i - 1), block.at(j, i), s, t, 0, step);
        }
    }
}

/// A texel is area * (its area-filtered value) + sum of weight * pixel.
struct CubeWeights {
    double area = 0;
    std::vector<FaceBlock> blocks;
};

CubeWeights weightsOf(const NearField& field, const Grid& grid, const MapExtent& map, int x, int y,
                      const Footprint& of_map) {
    CubeWeights weights;
    const Footprint footprint = footprintOfTexel(of_map, map.layout, map.width, x, y);
    const Texel texel = texelOf(map, x, y, footprint.scale);
    if (texel.outline.empty()) { // the whole sphere in one texel
        weights.area = field.kernel.mass;
        return weights;
    }
    const double across = 2 * std::asin(std::min(1.0, 0.5 * texel.radius));
    weights.blocks = blocksAbout(grid, texel.centre, field.kernel.reach + across);
    const bool leaves_area = footprint.scale == 1;
    const Flow flow(field, map, x, y, footprint, texel,
                    leaves_area ? Potential::withoutArea : Potential::withArea);
    double sum = 0;
    for (FaceBlock& block : weights.blocks) {
        addFar(field, grid, texel, block);
        addNear(flow, grid, block);
        for (int j = 0; j < block.rows && !leaves_area; ++j)
            for (int i = 0; i < block.columns; ++i)
                block.add(block.at(j, i), field.kernel.mass / (4 * kPi) *
                                              grid.areaOf(block.row + j, block.column + i));
        for (const double w : block.weight)
            sum += w;
    }
    // Between what is near and what is far the sums are of two kinds.
    if (leaves_area) {
        weights.area = field.kernel.mass - sum;
    } else {
        for (FaceBlock& block : weights.blocks)
            for (double& w : block.weight)
                w *= field.kernel.mass / sum;
    }
    return weights;
}

/// A turn or reflection of the cube: the axes in another order, some of them the other way round.
struct Symmetry {
    std::array<int, 3> axis;
    std::array<double, 3> sign;

    V3d operator()(const V3d& d) const {
        return {sign[0] * d[axis[0]], sign[1] * d[axis[1]], sign[2] * d[axis[2]]};
    }
    V3d back(const V3d& d) const {
        V3d result;
        for (int k = 0; k < 3; ++k)
            result[axis[k]] = sign[k] * d[k];
        return result;
    }
};

std::vector<Symmetry> symmetriesOfCube() {
    std::vector<Symmetry> symmetries;
    std::array<int, 3> axis{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            const auto sign = [&](int k) { return signs >> k & 1 ? -1.0 : 1.0; };
            symmetries.push_back({axis, {sign(0), sign(1), sign(2)}});
        }
    } while (std::ranges::next_permutation(axis).found);
    return symmetries;
}

/// The texel whose weights are reckoned for another, y * width + x, and the symmetry that takes the
/// other to it.
struct Shared {
    int key = -1;
    int symmetry = 0;
};

/// Whether the symmetry takes texel (x, y) to (i, j), its shape too: centres alone may meet by
/// chance.
bool takesTo(const MapExtent& map, const Symmetry& symmetry, int x, int y, int i, int j) {
    constexpr double kSame = 1e-12;
    const auto place = [&](int column, int row, const V2d& off) {
        return texelDirection(map.layout, map.width, map.height, column + 0.5 + off.x,
                              row + 0.5 + off.y);
    };
    const auto is = [&](const V3d& d, const V2d& off) {
        const auto other = place(i, j, off);
        return other && (*other - d).length() < kSame;
    };
    if (!is(symmetry(*place(x, y, V2d(0))), V2d(0))) return false;
    constexpr double kA = 0.3, kB = 0.1; // of a texel, off its axes and its diagonals
    // A corner texel cut off by a ball map's rim belongs to one of its neighbours (square_maps.h),
    // which are mirrored but not exchanged.
    const bool may_exchange = !isBallMap(map.layout);
    for (const V2d& off : {V2d(kA, kB), V2d(-kB, kA)}) {
        const auto d = place(x, y, off);
        if (!d) return false;
        const V3d moved = symmetry(*d);
        bool found = false;
        for (const double a : {-1.0, 1.0}) {
            for (const double b : {-1.0, 1.0}) {
                found = found || is(moved, V2d(a * off.x, b * off.y)) ||
                        (may_exchange && is(moved, V2d(a * off.y, b * off.x)));
            }
        }
        if (!found) return false;
    }
    return true;
}

/// The first texel that any symmetry takes this one to.
Shared sharedOf(const MapExtent& map, const std::vector<Symmetry>& symmetries, int x, int y) {
    Shared shared{y * map.width + x, 0}; // symmetry 0 leaves all as it is
    const V3d d = *texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5);
    for (std::size_t k = 1; k < symmetries.size(); ++k) {
        const V2d p = texelPoint(map.layout, map.width, map.height, symmetries[k](d));
        const int i = static_cast<int>(p.x), j = static_cast<int>(p.y);
        if (i < 0 || j < 0 || i >= map.width || j >= map.height) continue;
        const int key = j * map.width + i;
        if (key >= shared.key || !takesTo(map, symmetries[k], x, y, i, j)) continue;
        shared.key = key;
        shared.symmetry = static_cast<int>(k);
    }
    return shared;
}

/// The weighted sum for a texel that `symmetry` takes to the one of the weights.
V3d weightedSum(const Image& faces, int edge, const CubeWeights& weights, const Symmetry& symmetry,
                const float* area) {
    V3d sum(weights.area * area[0], weights.area * area[1], weights.area * area[2]);
    for (const FaceBlock& block : weights.blocks) {
        // Where texels (0, 0), (1, 0) and (0, 1) of the face come from.
        const auto from = [&](double i, double j) {
            const V3d d =
                cubeDirection({block.face, (2 * i + 1) / edge - 1, (2 * j + 1) / edge - 1});
            const CubePoint p = cubePoint(symmetry.back(d));
            const int column = static_cast<int>(0.5 * (p.s + 1) * edge);
            return std::ptrdiff_t{3} *
                   (column + edge * (static_cast<std::ptrdiff_t>(0.5 * (p.t + 1) * edge) +
                                     std::ptrdiff_t{p.face} * edge));
        };
        const std::ptrdiff_t origin = from(0, 0);
        const std::ptrdiff_t right = edge > 1 ? from(1, 0) - origin : 0;
        const std::ptrdiff_t down = edge > 1 ? from(0, 1) - origin : 0;
        const double* weight = block.weight.data();
        for (int j = 0; j < block.rows; ++j) {
            const float* pixel =
                faces.pixels.data() + origin + (block.row + j) * down + block.column * right;
            for (int i = 0; i < block.columns; ++i, pixel += right, ++weight) {
                for (int c = 0; c < 3; ++c)
                    sum[c] += *weight * pixel[c];
            }
        }
    }
    return sum;
}

} // namespace

bool seesOwnTexels(const Panorama& probe, const Lobe& lobe) {
    constexpr double kWidest = 0.03, kTexels = 8;
    if (!isCubeFamily(probe.layout) || lobe.kernel == Kernel::charlie) return false;
    const int edge = layoutSize(probe.layout, probe.image.width, probe.image.height).value();
    return lobeWidth(lobe) < std::min(kWidest, kTexels * 0.5 * kPi / edge);
}

Image nearMapOfCube(const Panorama& cube, const NearField& field, const PrefilterRequest& request,
                    const Footprint& footprint, int threads, Progress* progress) {
    const int edge = layoutSize(cube.layout, cube.image.width, cube.image.height).value();
    if (isCubeFamily(request.layout) && request.layout != Layout::faces) {
        PrefilterRequest faces = request;
        faces.layout = Layout::faces;
        return resample(
                   {Layout::faces, nearMapOfCube(cube, field, faces, footprint, threads, progress)},
                   request.layout, request.size, threads)
            .image;
    }
    const Panorama faces = resample(cube, Layout::faces, edge, threads, Enlarging::hold);
    Grid grid{edge, std::vector<double>(static_cast<std::size_t>(edge) * edge)};
    for (int j = 0; j < edge; ++j)
        faceRowSolidAngles(edge, j, &grid.solid_angle[static_cast<std::size_t>(j) * edge]);
    const V2i size = layoutExtent(request.layout, request.size);
    const MapExtent map{request.layout, size.x, size.y, texelAngle(request)};
    const Image area = resample(cube, request.layout, request.size, threads, Enlarging::hold).image;
    const std::vector<Symmetry> symmetries = symmetriesOfCube();
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * size.x + x; };
    std::vector<Shared> shared(at(0, size.y));
    parallelFor(static_cast<std::size_t>(size.y), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < size.x; ++x) {
            if (texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5))
                shared[at(x, y)] = sharedOf(map, symmetries, x, y);
        }
    });
    std::vector<KeyedTexel> texels;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (shared[at(x, y)].key >= 0) texels.push_back({shared[at(x, y)].key, x, y});
    return sumByKeys(
        request.layout, size, std::move(texels), threads, progress,
        [&](int x, int y) { return weightsOf(field, grid, map, x, y, footprint); },
        [&](const CubeWeights& weights, int x, int y) {
            const auto symmetry = static_cast<std::size_t>(shared[at(x, y)].symmetry);
            return weightedSum(faces.image, edge, weights, symmetries[symmetry], area.at(x, y));
        });
}

} // namespace ibl
