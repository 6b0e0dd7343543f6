#include "panorama/resample.h"

#include "panorama/lookup.h"
#include "panorama/resample_parts.h"
#include "panorama/square_maps.h"

#include "core/error.h"
#include "core/parallel.h"

#include <map>

namespace ibl {
namespace {

bool isCube(Layout layout) {
    return isCubeFamily(layout) || layout == Layout::exrCube;
}

/// A cube in another arrangement of the same texels.
void permute(const Panorama& source, Panorama& result, int threads) {
    const CubePlacement from(source), to(result);
    parallelFor(static_cast<std::size_t>(6 * to.edge), threads, [&](std::size_t task) {
        const int face = static_cast<int>(task) / to.edge, j = static_cast<int>(task) % to.edge;
        for (int i = 0; i < to.edge; ++i) {
            const V2i a = from.pixel(face, i, j), b = to.pixel(face, i, j);
            std::copy_n(source.image.at(a.x, a.y), 3, result.image.at(b.x, b.y));
        }
    });
}

/// A stretch of a face's edge within one texel of each of two grids.
struct Segment {
    double begin;
    double end;
    int from;
    int to;
};

std::vector<Segment> commonSegments(const std::vector<double>& from,
                                    const std::vector<double>& to) {
    // Lines nearer than this are the same line: an edge has at most 65536 texels.
    constexpr double kSameLine = 1e-12;
    std::vector<Segment> segments;
    std::size_t a = 0, b = 0;
    double at = -1;
    while (a + 1 < from.size() && b + 1 < to.size()) {
        const double end = std::min(from[a + 1], to[b + 1]);
        if (end - at > kSameLine) {
            segments.push_back({at, end, static_cast<int>(a), static_cast<int>(b)});
        }
        at = end;
        if (from[a + 1] - end <= kSameLine) ++a;
        if (to[b + 1] - end <= kSameLine) ++b;
    }
    return segments;
}

/// Integral of the solid angle's density from the middle of the face to the corners between
/// segments, along the line t (see cubeRectangleSolidAngle).
void cornerRow(const std::vector<Segment>& segments, double t, std::vector<double>& corners) {
    corners.resize(segments.size() + 1);
    for (std::size_t k = 0; k <= segments.size(); ++k) {
        const double s = k < segments.size() ? segments[k].begin : segments[k - 1].end;
        corners[k] = std::atan2(s * t, std::sqrt(1 + s * s + t * t));
    }
}

} // namespace

void cubeToCube(const Panorama& source, Panorama& result, Enlarging enlarging, int threads) {
    const CubePlacement from(source), to(result);
    const bool from_border = hasBorderRule(source.layout), to_border = hasBorderRule(result.layout);
    const double share = areaShare(
        centrePitch(2, to.edge, to_border) / centrePitch(2, from.edge, from_border), enlarging);
    const std::vector<Segment> segments =
        commonSegments(cubeGrid(from.edge, from_border).lines, cubeGrid(to.edge, to_border).lines);
    const Sampler sampler = makeSampler(source);

    const auto areaRow = [&](int j, std::vector<V3d>& sums, std::vector<double>& weights) {
        const auto n = static_cast<std::size_t>(to.edge);
        sums.assign(6 * n, V3d(0));
        weights.assign(n, 0.0);
        std::vector<double> above, below;
        for (const Segment& t : segments) {
            if (t.to != j) continue;
            cornerRow(segments, t.begin, above);
            cornerRow(segments, t.end, below);
            for (std::size_t k = 0; k < segments.size(); ++k) {
                const Segment& s = segments[k];
                const double area =
                    std::max(0.0, above[k] - above[k + 1] - below[k] + below[k + 1]);
                weights[static_cast<std::size_t>(s.to)] += area;
                for (int face = 0; face < 6; ++face) {
                    const V2i at = from.pixel(face, s.from, t.from);
                    const float* p = source.image.at(at.x, at.y);
                    sums[static_cast<std::size_t>(face) * n + static_cast<std::size_t>(s.to)] +=
                        V3d(p[0], p[1], p[2]) * area;
                }
            }
        }
    };
    parallelFor(static_cast<std::size_t>(to.edge), threads, [&](std::size_t row) {
        const int j = static_cast<int>(row);
        std::vector<V3d> sums;
        std::vector<double> weights;
        if (share > 0) areaRow(j, sums, weights);
        for (int face = 0; face < 6; ++face) {
            for (int i = 0; i < to.edge; ++i) {
                const auto k = static_cast<std::size_t>(i);
                V3d value(0);
                if (share > 0) {
                    const auto at = static_cast<std::size_t>(face * to.edge) + k;
                    value += sums[at] / weights[k] * share;
                }
                if (share < 1) {
                    const double s = 2 * centreAt(i, to.edge, to_border) - 1;
                    const double t = 2 * centreAt(j, to.edge, to_border) - 1;
                    value += radianceAt(sampler, cubeDirection({face, s, t})) * (1 - share);
                }
                const V2i at = to.pixel(face, i, j);
                setPixel(result.image.at(at.x, at.y), value);
            }
        }
    });
}

namespace {

/// What square maps are converted from and to directly: other cubes of the family are put into
/// faces on the way.
Layout plainLayout(Layout layout) {
    return isCubeFamily(layout) ? Layout::faces : layout;
}

/// The same areas in halfPixelsOf them.
Panorama ofHalfPixels(const Panorama& source, int threads) {
    Panorama halves = halfPixelsOf(source);
    if (source.layout == Layout::exrCube) {
        cubeToCube(source, halves, Enlarging::hold, threads);
        return halves;
    }
    const LatlongPixels pixels(source);
    for (int y = 0; y < halves.image.height; ++y)
        for (int x = 0; x < halves.image.width; ++x)
            std::copy_n(pixels.at((x + 1) / 2 % pixels.columns(), (y + 1) / 2), 3,
                        halves.image.at(x, y));
    return halves;
}

} // namespace

Panorama halfPixelsOf(const Panorama& panorama) {
    const auto halved = [](int pixels) { return std::max(1, 2 * (pixels - 1)); };
    const Image& image = panorama.image;
    const int width = halved(image.width);
    if (panorama.layout == Layout::exrCube) return {Layout::faces, Image(width, 6 * width)};
    return {Layout::latlong, Image(width, halved(image.height))};
}

void mergeBorder(Panorama& panorama) {
    if (!hasBorderRule(panorama.layout)) return;
    Image& image = panorama.image;
    if (panorama.layout == Layout::exrLatlong) {
        const int last = image.width - 1;
        for (int y = 0; y < image.height; ++y) {
            std::copy_n(image.at(0, y), 3, image.at(last, y));
        }
        if (image.height == 1) return;
        for (int y : {0, image.height - 1}) {
            V3d sum(0);
            const int columns = std::max(1, last);
            for (int x = 0; x < columns; ++x) {
                const float* p = image.at(x, y);
                sum += V3d(p[0], p[1], p[2]);
            }
            for (int x = 0; x <= last; ++x)
                setPixel(image.at(x, y), sum / columns);
        }
        return;
    }
    const CubePlacement place(panorama);
    const int edge = place.edge, last = edge - 1;
    if (edge == 1) return;
    // Directions on the cube of half edge `last` are whole numbers, hence keys.
    struct Meeting {
        V3d sum{0, 0, 0};
        int count = 0;
    };
    std::map<std::array<int, 3>, Meeting> meetings;
    const auto forEachOnEdge = [&](auto use) {
        for (int face = 0; face < 6; ++face) {
            for (int j = 0; j < edge; ++j) {
                for (int i = 0; i < edge; i += j % last == 0 ? 1 : last) {
                    const V3d d = cubeDirection({face, 2.0 * i / last - 1, 2.0 * j / last - 1}) *
                                  static_cast<double>(last);
                    const V2i at = place.pixel(face, i, j);
                    use(meetings[{static_cast<int>(std::lround(d.x)),
                                  static_cast<int>(std::lround(d.y)),
                                  static_cast<int>(std::lround(d.z))}],
                        image.at(at.x, at.y));
                }
            }
        }
    };
    forEachOnEdge([](Meeting& m, const float* p) {
        m.sum += V3d(p[0], p[1], p[2]);
        ++m.count;
    });
    forEachOnEdge([](const Meeting& m, float* p) { setPixel(p, m.sum / m.count); });
}

Panorama resample(const Panorama& source, Layout to, int size, int threads, Enlarging enlarging) {
    // What images are read up to, so that every result can be an input.
    constexpr int kLargestEdge = 65536;
    constexpr long long kMostPixels = 1LL << 30;
    if (size < 1) {
        throw Error(ExitCode::usage, "size " + std::to_string(size) +
                                         ": no image is so small; "
                                         "ask for 1 or more");
    }
    const V2i extent = size <= kLargestEdge ? layoutExtent(to, size) : V2i(size);
    if (std::max(extent.x, extent.y) > kLargestEdge ||
        static_cast<long long>(extent.x) * extent.y > kMostPixels) {
        throw Error(ExitCode::usage, "size " + std::to_string(size) +
                                         ": the image is beyond 65536 "
                                         "pixels an edge or 2^30 in all; ask for less");
    }
    if (to == source.layout && extent == V2i(source.image.width, source.image.height))
        return source;

    if (isSquareMap(source.layout) || isSquareMap(to)) {
        const Layout from_plain = plainLayout(source.layout), to_plain = plainLayout(to);
        const bool halved = hasBorderRule(source.layout);
        if (from_plain != source.layout) {
            const int source_size =
                *layoutSize(source.layout, source.image.width, source.image.height);
            return resample(resample(source, from_plain, source_size, threads, enlarging), to, size,
                            threads, enlarging);
        }
        if (to_plain != to) {
            return resample(resample(source, to_plain, size, threads, enlarging), to, size, threads,
                            enlarging);
        }
        const V2i plain = layoutExtent(to, size);
        Panorama result{to, Image(plain.x, plain.y)};
        std::fill(result.image.pixels.begin(), result.image.pixels.end(), 0.0f);
        if (halved) {
            throughSquareMap(source, ofHalfPixels(source, threads), result, enlarging, threads);
        } else {
            throughSquareMap(source, source, result, enlarging, threads);
        }
        mergeBorder(result);
        return result;
    }
    Panorama result{to, Image(extent.x, extent.y)};
    if (to == Layout::vcross || to == Layout::hcross) {
        std::fill(result.image.pixels.begin(), result.image.pixels.end(), 0.0f);
    }
    const bool from_cube = isCube(source.layout), to_cube = isCube(to);
    if (isCubeFamily(source.layout) && isCubeFamily(to) &&
        *layoutSize(source.layout, source.image.width, source.image.height) == size) {
        permute(source, result, threads);
    } else if (from_cube && to_cube) {
        cubeToCube(source, result, enlarging, threads);
    } else if (from_cube) {
        cubeToLatlong(source, result, enlarging, threads);
    } else if (to_cube) {
        latlongToCube(source, result, enlarging, threads);
    } else {
        latlongToLatlong(source, result, enlarging, threads);
    }
    mergeBorder(result);
    return result;
}

} // namespace ibl
