// To and from square maps, and whatever has no closed form: a texel of the result is cut into
// quadrilaterals, whose corners are carried into the source's image and joined by straight lines
// there. Neighbouring quadrilaterals share their corners, so they tile the source's plane and every
// source pixel gives away its whole area. A quadrilateral whose middle is not where its corners'
// mean is (bent, or across a fold, rim or edge of a face) is quartered.
#include "panorama/lookup.h"
#include "panorama/resample_parts.h"
#include "panorama/square_maps.h"

#include "core/parallel.h"

namespace ibl {
namespace {

/// Quadrilaterals bend by no more than this many source pixels...
constexpr double kBend = 0.01;
/// ...unless they have been quartered this often: then by this many, and beyond, across a fold, rim
/// or face, the source is read at their middle.
constexpr int kMostQuarterings = 6;
constexpr double kMostBend = 0.5;
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
          columns_(source.layout == Layout::latlong ? source.image.width : 0) {}

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
        const double x0 = x + kInside, x1 = x + size - kInside;
        const double y0 = y + kInside, y1 = y + size - kInside;
        const Image& image = result_.image;
        if (isOutside(x, y, size)) return;
        const auto middle = texelDirection(result_.layout, image.width, image.height,
                                           x + 0.5 * size, y + 0.5 * size);
        const V2d centre = middle ? placeOf(*middle) : V2d(0);
        std::vector<V2d> quad{placeOf(direction(x0, y0)), placeOf(direction(x1, y0)),
                              placeOf(direction(x1, y1)), placeOf(direction(x0, y1))};
        if (middle && isFlat(centre, quad, depth < kMostQuarterings ? kBend : kMostBend))
            return readQuad(quad);
        if (depth < kMostQuarterings) {
            const double half = 0.5 * size;
            for (int k = 0; k < 4; ++k)
                read(x + k % 2 * half, y + k / 2 * half, half, depth + 1);
            return;
        }
        if (!middle) return;
        const double solid_angle =
            size * size * solidAngleDensity(result_.layout, *middle) * unitDensity();
        add(static_cast<int>(centre.x), static_cast<int>(centre.y), solid_angle);
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

    bool isFlat(const V2d& centre, std::vector<V2d>& quad, double bend) const {
        V2d mean(0);
        for (V2d& corner : quad) {
            if (columns_ > 0) {
                if (corner.x - centre.x > 0.5 * columns_) corner.x -= columns_;
                if (centre.x - corner.x > 0.5 * columns_) corner.x += columns_;
            } else if (source_.layout == Layout::faces &&
                       std::floor(corner.y / width_) != std::floor(centre.y / width_)) {
                return false;
            }
            mean += corner * 0.25;
        }
        return std::abs(mean.x - centre.x) < bend && std::abs(mean.y - centre.y) < bend;
    }

    void readQuad(const std::vector<V2d>& quad) {
        double left = quad[0].x, right = left, top = quad[0].y, bottom = top;
        for (const V2d& p : quad) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
        }
        std::vector<V2d> strip, part;
        for (int y = static_cast<int>(std::floor(top)); y < bottom; ++y) {
            cutBetween(quad, 1, y, y + 1, strip);
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
        add(x, y,
            area(part) * solidAngleDensity(source_.layout, *d) *
                steradiansPerPixel(source_.layout, width_, height_));
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
    int columns_; ///< around, of lat-longs
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
