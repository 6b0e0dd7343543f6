// To and from square maps, and whatever has no closed form: a texel of the result is cut into
// cells, whose corners and middles of edges are carried into the source's image and joined by
// straight lines there. Neighbouring cells share them, so they tile the source's plane and every
// source pixel gives away its whole area (to 5e-3; beside -Z on ball maps to 2.4e-2). A cell with
// an edge whose middle is not the mean of its ends, or whose own middle is not that of its corners
// (bent, or across a fold, rim or edge of a face), is quartered. The edges must be looked at: where
// the map is harmonic, as longitude nearly is about a pole, the corners' mean is the middle however
// much the edges bend.
#include "panorama/lookup.h"
#include "panorama/resample_parts.h"
#include "panorama/square_maps.h"

#include "core/parallel.h"

namespace ibl {
namespace {

/// Cells' edges and middles bend by no more than this many source pixels, so that the two halves of
/// an edge bend by no more than a quarter of it...
constexpr double kBend = 0.01;
/// ...unless a cell has less than this part of a source pixel's solid angle: then the source is
/// read at its middle.
constexpr double kSmallest = 1.0 / 4096;
/// Bounds the recursion where lat-long pixels shrink to nothing, at their poles.
constexpr int kMostQuarterings = 24;
/// Corners stand this much inside, because texels' edges are where cubes' faces meet and discs end.
constexpr double kInside = 1e-9;

double area(const std::vector<V2d>& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const V2d &a = p[i], &b = p[(i + 1) % p.size()];
        sum += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(sum);
}

/// The part of a polygon between two lines across an axis (Sutherland and Hodgman 1974).
void cutBetween(const std::vector<V2d>& polygon, int axis, double low, double high,
                std::vector<V2d>& kept) {
    std::vector<V2d> half;
    const auto cut = [axis](const std::vector<V2d>& from, double limit, double sign,
                            std::vector<V2d>& to) {
        to.clear();
        for (std::size_t i = 0; i < from.size(); ++i) {
            const V2d &p = from[i], &q = from[(i + 1) % from.size()];
            const double over_p = sign * (p[axis] - limit), over_q = sign * (q[axis] - limit);
            if (over_p <= 0) to.push_back(p);
            if ((over_p < 0 && over_q > 0) || (over_p > 0 && over_q < 0))
                to.push_back(p + (q - p) * (over_p / (over_p - over_q)));
        }
    };
    cut(polygon, low, -1, half);
    cut(half, high, 1, kept);
}

class AreaReader {
public:
    AreaReader(const Panorama& source, const Panorama& result)
        : source_(source),
          result_(result),
          width_(source.image.width),
          height_(source.image.height),
          columns_(source.layout == Layout::latlong ? source.image.width : 0),
          steradians_(steradiansPerPixel(source.layout, width_, height_)),
          mean_pixel_(4 * kPi / (static_cast<double>(width_) * height_)) {}

    /// Mean of the source over what belongs to a texel; false if nothing was found.
    bool mean(int x, int y, V3d& value) {
        sum_ = V3d(0);
        weight_ = 0;
        const Image& image = result_.image;
        if (!isBallMap(result_.layout)) {
            read(x, y, 1, 0);
        } else {
            for (int j = std::max(0, y - 1); j <= std::min(image.height - 1, y + 1); ++j) {
                for (int i = std::max(0, x - 1); i <= std::min(image.width - 1, x + 1); ++i) {
                    if (owningTexel(result_.layout, image.width, i, j) == V2i(x, y))
                        read(i, j, 1, 0);
                }
            }
        }
        if (!(weight_ > 0)) return false;
        value = sum_ / weight_;
        return true;
    }

private:
    /// Direction of a point of the result; outside a disc that of its rim.
    V3d direction(double x, double y) const {
        const Image& image = result_.image;
        return texelDirection(result_.layout, image.width, image.height, x, y)
            .value_or(V3d(0, 0, -1));
    }

    V2d placeOf(const V3d& d) const { return texelPoint(source_.layout, width_, height_, d); }

    /// Quarters of the square of edge `size` at (x, y), as often as they need it.
    void read(double x, double y, double size, int depth) {
        if (isOutside(x, y, size)) return;
        const double half = 0.5 * size, end = size - kInside;
        const auto middle = texelDirection(result_.layout, result_.image.width,
                                           result_.image.height, x + half, y + half);
        const V3d d = middle.value_or(V3d(0, 0, -1));
        const V2d centre = placeOf(d);
        if (middle) {
            // Corners, and middles of edges after them, around the cell.
            const std::array<V2d, 8> steps{
                V2d(kInside, kInside), V2d(half, kInside), V2d(end, kInside), V2d(end, half),
                V2d(end, end),         V2d(half, end),     V2d(kInside, end), V2d(kInside, half)};
            std::array<V2d, 8> around;
            std::transform(steps.begin(), steps.end(), around.begin(), [&](const V2d& step) {
                return placeOf(direction(x + step.x, y + step.y));
            });
            if (isFlat(centre, around)) return readCell(around);
        }
        const double unit = size * size * unitDensity();
        if (depth < kMostQuarterings && unit > kSmallest * pixelSolidAngle(d)) {
            for (int k = 0; k < 4; ++k)
                read(x + k % 2 * half, y + k / 2 * half, half, depth + 1);
        } else if (middle) {
            add(static_cast<int>(centre.x), static_cast<int>(centre.y),
                unit * solidAngleDensity(result_.layout, d));
        }
    }

    /// Of the source's pixels about a direction; of square maps and faces the mean.
    double pixelSolidAngle(const V3d& d) const {
        if (source_.layout != Layout::latlong) return mean_pixel_;
        return solidAngleDensity(source_.layout, d) * steradians_;
    }

    /// Whether a square lies outside a ball map's disc.
    bool isOutside(double x, double y, double size) const {
        if (!isBallMap(result_.layout)) return false;
        const double middle = 0.5 * result_.image.width;
        return std::hypot(std::clamp(middle, x, x + size) - middle,
                          std::clamp(middle, y, y + size) - middle) > middle;
    }

    /// Steradians to a pixel of the result where its density is 1.
    double unitDensity() const {
        return steradiansPerPixel(result_.layout, result_.image.width, result_.image.height);
    }

    /// Brings a cell's points to the side of a lat-long's seam where its middle is.
    bool isFlat(const V2d& centre, std::array<V2d, 8>& around) const {
        for (V2d& p : around) {
            if (columns_ > 0) {
                if (p.x - centre.x > 0.5 * columns_) p.x -= columns_;
                if (centre.x - p.x > 0.5 * columns_) p.x += columns_;
            } else if (source_.layout == Layout::faces &&
                       std::floor(p.y / width_) != std::floor(centre.y / width_)) {
                return false;
            }
        }
        const auto near = [](const V2d& a, const V2d& b) {
            return std::abs(a.x - b.x) < kBend && std::abs(a.y - b.y) < kBend;
        };
        for (std::size_t i = 0; i < 8; i += 2) {
            if (!near(around[i + 1], (around[i] + around[(i + 2) % 8]) * 0.5)) return false;
        }
        return near(centre, (around[0] + around[2] + around[4] + around[6]) * 0.25);
    }

    void readCell(const std::array<V2d, 8>& around) {
        const std::vector<V2d> cell(around.begin(), around.end());
        double left = cell[0].x, right = left, top = cell[0].y, bottom = top;
        for (const V2d& p : cell) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
        }
        std::vector<V2d> strip, part;
        for (int y = static_cast<int>(std::floor(top)); y < bottom; ++y) {
            cutBetween(cell, 1, y, y + 1, strip);
            for (int x = static_cast<int>(std::floor(left)); x < right; ++x) {
                cutBetween(strip, 0, x, x + 1, part);
                if (part.size() >= 3) addPart(x, y, part);
            }
        }
    }

    void addPart(int x, int y, const std::vector<V2d>& part) {
        V2d middle(0);
        for (const V2d& p : part)
            middle += p / static_cast<double>(part.size());
        if (columns_ > 0) middle.x -= std::floor(middle.x / columns_) * columns_;
        const auto d = texelDirection(source_.layout, width_, height_, middle.x, middle.y);
        if (!d) return;
        add(x, y, area(part) * solidAngleDensity(source_.layout, *d) * steradians_);
    }

    void add(int x, int y, double solid_angle) {
        if (columns_ > 0) x = ((x % columns_) + columns_) % columns_;
        x = std::clamp(x, 0, width_ - 1);
        y = std::clamp(y, 0, height_ - 1);
        const auto at = owningTexel(source_.layout, width_, x, y);
        if (!at) return;
        const float* p = source_.image.at(at->x, at->y);
        sum_ += V3d(p[0], p[1], p[2]) * solid_angle;
        weight_ += solid_angle;
    }

    static double steradiansPerPixel(Layout layout, int width, int height) {
        const double squared = static_cast<double>(width) * width;
        switch (layout) {
        case Layout::latlong:
            return 2 * kPi * kPi / (static_cast<double>(width) * height);
        case Layout::mirrorBall:
            return 16 / squared;
        case Layout::angular:
            return 4 * kPi * kPi / squared;
        default:
            return 4 / squared; // the octahedron's square, and faces, width pixels wide
        }
    }

    const Panorama& source_;
    const Panorama& result_;
    int width_, height_;
    int columns_;       ///< around, of lat-longs
    double steradians_; ///< to a pixel of the source where its density is 1
    double mean_pixel_; ///< steradians to a pixel of the source
    V3d sum_{0, 0, 0};
    double weight_ = 0;
};

/// Distance between the centres of an image's pixels about (x, y), radians: of lat-longs from row
/// to row, of angular maps from ring to ring; a mirror ball's rings widen towards its rim.
double pitchAt(const Panorama& p, int x, int y) {
    const int width = p.image.width, height = p.image.height;
    if (p.layout == Layout::latlong) return kPi / height;
    if (p.layout == Layout::angular) return 2 * kPi / width;
    if (p.layout == Layout::mirrorBall) {
        const double rho = std::hypot((2.0 * x + 1) / width - 1, (2.0 * y + 1) / width - 1);
        return 4.0 / width / std::sqrt(std::max(1.0 / width, 1 - rho * rho));
    }
    return std::sqrt(texelSolidAngle(p.layout, width, height, x, y));
}

} // namespace

void throughSquareMap(const Panorama& source, Panorama& result, Enlarging enlarging, int threads) {
    const Sampler sampler = makeSampler(source);
    const Image& from = source.image;
    Image& image = result.image;
    parallelFor(static_cast<std::size_t>(image.height), threads, [&](std::size_t row) {
        AreaReader reader(source, result);
        const int y = static_cast<int>(row);
        for (int x = 0; x < image.width; ++x) {
            const auto d =
                texelDirection(result.layout, image.width, image.height, x + 0.5, y + 0.5);
            if (!d) continue;
            const V2d p = texelPoint(source.layout, from.width, from.height, *d);
            const int i = std::clamp(static_cast<int>(p.x), 0, from.width - 1);
            const int j = std::clamp(static_cast<int>(p.y), 0, from.height - 1);
            const V2i at = owningTexel(source.layout, from.width, i, j).value_or(V2i(i, j));
            const double pitch = pitchAt(result, x, y);
            double share = areaShare(pitch / pitchAt(source, at.x, at.y), enlarging);
            V3d value(0), mean;
            if (share > 0) {
                if (reader.mean(x, y, mean)) {
                    value += mean * share;
                } else {
                    share = 0;
                }
            }
            if (share < 1) value += radianceAt(sampler, *d, pitch) * (1 - share);
            setPixel(image.at(x, y), value);
        }
    });
}

} // namespace ibl
