// To and from square maps, and whatever has no closed form: a texel of the result is a polygon on
// the sphere, cut where the source's image has seams, folds and singular points, carried into that
// image (chart.h) and cut into its pixels there. Neighbouring texels share their sides' vertices,
// so the polygons tile the source and every pixel gives away its whole area: of lat-longs, where
// area is solid angle, to rounding; of others to what a pixel's solid angle differs from its
// density at the middle of each part.
#include "panorama/chart.h"
#include "panorama/latlong_moments.h"
#include "panorama/lookup.h"
#include "panorama/resample_parts.h"
#include "panorama/square_maps.h"

#include "core/parallel.h"

#include <limits>

namespace ibl {
namespace {

/// Sides of texels are followed to this part of the source's mean pixel and of the texel, and of
/// texels larger than pixels to as many times less, and their area kept. A lamp on a side is shared
/// out wrongly by that much, and counts for the more the fewer texels there are: with 1e-3 of a
/// pixel an angular map of 9 of a night was off by 1.5e-5, in half the time.
constexpr double kFollow = 1e-3;

using Polygon = std::vector<V2d>;

/// Cuts a polygon in two along a line across an axis (Sutherland and Hodgman 1974).
void cut(const Polygon& polygon, int axis, double line, Polygon& below, Polygon& above) {
    below.clear();
    above.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const V2d &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
        const double over_p = p[axis] - line, over_q = q[axis] - line;
        if (over_p <= 0) below.push_back(p);
        if (over_p >= 0) above.push_back(p);
        if ((over_p < 0 && over_q > 0) || (over_p > 0 && over_q < 0)) {
            const V2d at = p + (q - p) * (over_p / (over_p - over_q));
            below.push_back(at);
            above.push_back(at);
        }
    }
}

class AreaReader {
public:
    /// `cells` is the result, or where that has borders that run through centres one in pixels of
    /// half the width, of which its texels are made.
    AreaReader(const Panorama& source, const Panorama& cells)
        : source_(source),
          result_(cells),
          sectors_(sectorsOf(source.layout)),
          width_(source.image.width),
          height_(source.image.height),
          tolerance_(kFollow * std::sqrt(4 * kPi * pixelsOf(cells.image)) /
                     std::max(pixelsOf(source.image), pixelsOf(cells.image))) {
        for (int j = 0; j <= height_ && source.layout == Layout::latlong; ++j)
            rows_.push_back(-std::cos(kPi * j / height_));
    }

    /// Mean of the source over what belongs to a texel; false if nothing was found.
    bool mean(int x, int y, V3d& value) {
        sum_ = {};
        const int n = result_.image.width;
        if (!isBallMap(result_.layout)) {
            read(x, y, 1);
        } else if (n == 1) { // the disc touches the texel's sides alone
            for (int k = 0; k < 4; ++k)
                read(0.5 * (k % 2), 0.5 * (k / 2), 0.5);
        } else {
            for (int j = std::max(0, y - 1); j <= std::min(n - 1, y + 1); ++j) {
                for (int i = std::max(0, x - 1); i <= std::min(n - 1, x + 1); ++i) {
                    if (owningTexel(result_.layout, n, i, j) == V2i(x, y)) read(i, j, 1);
                }
            }
        }
        return meanOfSum(value);
    }

    /// The same of the cells in those columns and rows.
    bool mean(const std::vector<int>& columns, const std::vector<int>& rows, V3d& value) {
        sum_ = {};
        for (const int y : rows)
            for (const int x : columns)
                read(x, y, 1);
        return meanOfSum(value);
    }

    /// What a lat-long's pixel (x, y) is made of, its area not above 0 where nothing was found.
    MomentSum moments(int x, int y) {
        sum_ = {};
        pixel_ = V2i(x, y);
        read(x, y, 1);
        return sum_;
    }

private:
    static double pixelsOf(const Image& image) {
        return static_cast<double>(image.width) * image.height;
    }

    bool meanOfSum(V3d& value) const {
        if (sum_.area == 0) return false;
        value = sum_.radiance / sum_.area;
        return true;
    }

    void read(double x, double y, double size) {
        outline_.clear();
        appendCell(result_, x, y, size, tolerance_, outline_);
        for (const Sector& sector : sectors_) {
            clipTo(sector, outline_, part_);
            if (part_.size() < 3) continue;
            carry(source_, sector, part_, flat_);
            if (flat_.size() >= 3) readFlat();
        }
    }

    int rowAt(double y) const {
        if (rows_.empty()) return static_cast<int>(std::floor(y));
        const auto row = static_cast<int>(std::acos(std::clamp(-y, -1.0, 1.0)) / kPi * height_);
        return row - (y < rows_[static_cast<std::size_t>(std::clamp(row, 0, height_))] ? 1 : 0);
    }
    double rowTop(int row) const {
        return rows_.empty() ? row : rows_[static_cast<std::size_t>(row)];
    }

    /// Cuts a polygon of the chart into pixels, by halves: a vertex is met once a halving.
    void readFlat() {
        const auto [top, bottom] = extent(flat_, 1);
        readRows(flat_, std::clamp(rowAt(top), 0, height_ - 1),
                 std::clamp(rowAt(bottom), 0, height_ - 1), 0);
    }

    static std::pair<double, double> extent(const Polygon& polygon, int axis) {
        const auto [least, most] = std::ranges::minmax_element(
            polygon, [axis](const V2d& p, const V2d& q) { return p[axis] < q[axis]; });
        return {(*least)[axis], (*most)[axis]};
    }

    void readRows(const Polygon& polygon, int first, int last, std::size_t depth) {
        if (polygon.size() < 3) return;
        if (first == last) {
            const auto [left, right] = extent(polygon, 0);
            const auto column = [&](double x) {
                return std::clamp(static_cast<int>(std::floor(x)), 0, width_ - 1);
            };
            readColumns(polygon, first, column(left), column(right), depth);
            return;
        }
        const int middle = (first + last + 1) / 2;
        auto& [upper, lower] = halves_[depth];
        cut(polygon, 1, rowTop(middle), upper, lower);
        readRows(upper, first, middle - 1, depth + 1);
        readRows(lower, middle, last, depth + 1);
    }

    void readColumns(const Polygon& polygon, int row, int first, int last, std::size_t depth) {
        if (polygon.size() < 3) return;
        if (first == last) {
            addPiece(polygon, first, row);
            return;
        }
        const int middle = (first + last + 1) / 2;
        auto& [left, right] = halves_[depth];
        cut(polygon, 0, middle, left, right);
        readColumns(left, row, first, middle - 1, depth + 1);
        readColumns(right, row, middle, last, depth + 1);
    }

    /// Of a polygon whose lines are great circles, because the image is seen in planes from the
    /// middle of an octahedron or a cube: by Van Oosterom and Strackee (1983), without its sign.
    double greatCircles(const Polygon& p, const V2d& middle) const {
        const double below = std::clamp(std::floor(middle.y / width_), 0.0, 5.0); // faces
        const auto direction = [&](const V2d& at) {
            if (source_.layout == Layout::octahedral)
                return *squareMapDirection(Layout::octahedral, at.x / width_, at.y / width_);
            return V3d(2 * at.x / width_ - 1, 2 * (at.y / width_ - below) - 1, 1).normalized();
        };
        double sum = 0;
        const V3d a = direction(p[0]);
        for (std::size_t i = 1; i + 1 < p.size(); ++i) {
            const V3d b = direction(p[i]), c = direction(p[i + 1]);
            sum += 2 * std::atan2((b - a).cross(c - a).dot(a), 1 + a.dot(b) + b.dot(c) + c.dot(a));
        }
        return std::abs(sum);
    }

    /// Of a piece of a pixel, but for a factor: of large ones exactly, else of the density about
    /// its middle by its moments, exact up to the second degree.
    double solidAngle(const Polygon& p, V2d& middle) const {
        double zeroth = 0, xx = 0, xy = 0, yy = 0;
        V2d first(0);
        for (std::size_t i = 1; i + 1 < p.size(); ++i) { // triangles about p[0]
            const V2d a = p[i] - p[0], b = p[i + 1] - p[0], sum = a + b;
            const double twice = a.x * b.y - a.y * b.x;
            zeroth += twice;
            first += sum * twice;
            xx += (a.x * a.x + b.x * b.x + sum.x * sum.x) * twice;
            xy += (a.x * a.y + b.x * b.y + sum.x * sum.y) * twice;
            yy += (a.y * a.y + b.y * b.y + sum.y * sum.y) * twice;
        }
        if (zeroth == 0) return 0;
        const V2d off = first / (3 * zeroth); // of gravity, inside: on one side of a fold
        middle = p[0] + off;
        if (source_.layout == Layout::latlong || source_.layout == Layout::mirrorBall)
            return 0.5 * zeroth;
        const bool planes = source_.layout == Layout::octahedral || source_.layout == Layout::faces;
        constexpr double kLarge = 1e-3; // steradians, about: below, the fourth degree is 1e-7
        const double unit = 2.0 / width_;
        if (planes && 0.5 * std::abs(zeroth) * unit * unit > kLarge)
            return std::copysign(greatCircles(p, middle) / (unit * unit), zeroth);
        const ChartDensity density = chartDensity(source_, middle);
        // Second moments about the middle.
        xx = xx / 24 - 0.5 * zeroth * off.x * off.x;
        xy = xy / 24 - 0.5 * zeroth * off.x * off.y;
        yy = yy / 24 - 0.5 * zeroth * off.y * off.y;
        return 0.5 * zeroth * density.value +
               0.5 * (density.xx * xx + 2 * density.xy * xy + density.yy * yy);
    }

    void addPiece(const Polygon& piece, int x, int y) {
        const auto at = owningTexel(source_.layout, width_, x, y);
        if (!at) return;
        V2d middle(0);
        const double weight = solidAngle(piece, middle);
        const V2d off = pixel_ ? fromMiddle(middle) * weight : V2d(0);
        sum_.add(source_.image.at(at->x, at->y), weight, off.x, off.y);
    }

    /// Where a point of the source's image is in the lat-long's pixel, in its sizes.
    V2d fromMiddle(const V2d& p) const {
        const int width = result_.image.width, height = result_.image.height;
        const auto d = texelDirection(source_.layout, width_, height_, p.x, p.y);
        if (!d) return V2d(0); // on the rim
        const double column = (0.5 - std::atan2(d->x, d->z) / (2 * kPi)) * width;
        const double top = std::cos(kPi * pixel_->y / height),
                     bottom = std::cos(kPi * (pixel_->y + 1) / height);
        return {std::remainder(column - pixel_->x - 0.5, width),
                (0.5 * (top + bottom) - d->y) / (top - bottom)};
    }

    const Panorama& source_;
    const Panorama& result_;
    std::vector<Sector> sectors_;
    int width_, height_;
    double tolerance_;         ///< radians
    std::vector<double> rows_; ///< of a lat-long: -cos(theta) of its rows' edges
    MomentSum sum_; ///< negative where texels run the other way around than the source's pixels
    std::optional<V2i> pixel_; ///< of the lat-long, when moments are asked for
    SpherePolygon outline_, part_;
    Polygon flat_;
    std::array<std::pair<Polygon, Polygon>, 40> halves_; ///< 2^17 rows and columns at most
};

/// Distance between the centres of an image's pixels about (x, y), radians: of lat-longs from row
/// to row, of angular maps from ring to ring; a mirror ball's rings widen towards its rim.
double pitchAt(const Panorama& p, int x, int y) {
    const int width = p.image.width, height = p.image.height;
    if (p.layout == Layout::latlong) return kPi / height;
    if (p.layout == Layout::exrLatlong) return centrePitch(kPi, height, true);
    if (p.layout == Layout::exrCube) { // of whole texels at borders too
        const V3d d = *texelDirection(p.layout, width, height, x + 0.5, y + 0.5);
        return centrePitch(2, width, true) * std::sqrt(solidAngleDensity(p.layout, d));
    }
    if (p.layout == Layout::angular) return 2 * kPi / width;
    if (p.layout == Layout::mirrorBall) {
        const double rho = std::hypot((2.0 * x + 1) / width - 1, (2.0 * y + 1) / width - 1);
        return 4.0 / width / std::sqrt(std::max(1.0 / width, 1 - rho * rho));
    }
    return std::sqrt(texelSolidAngle(p.layout, width, height, x, y));
}

/// By no more than how many pixels' widths to a radian a square map's image stretches what lies
/// within `radius` radians of a direction.
double stretch(Layout layout, double width, const V3d& d, double radius) {
    if (layout == Layout::octahedral) { // d / |d|_1 moves by sqrt(3) / |d|_1^2 at most
        const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z) - std::sqrt(3.0) * radius;
        return 0.5 * width * std::sqrt(3.0) / (sum * sum);
    }
    // Along the parallels, which are of sin(theta) and become circles of theta / pi and
    // sin(theta / 2).
    const double theta = std::acos(std::clamp(d.z, -1.0, 1.0)) + radius;
    if (theta >= kPi) return std::numeric_limits<double>::infinity();
    return layout == Layout::angular ? 0.5 * width / kPi * theta / std::sin(theta)
                                     : 0.25 * width / std::cos(0.5 * theta);
}

/// Whether all of the lat-long's pixel about a direction, which is `p` in the square map's image,
/// lies in one of its pixels: for sure where true.
bool isWithinOnePixel(const Panorama& source, const Panorama& latlong, const V3d& d, const V2d& p) {
    if (latlong.layout != Layout::latlong || !isSquareMap(source.layout)) return false;
    const double radius =
        std::sqrt(0.5) * kPi / std::min(latlong.image.height, latlong.image.width / 2);
    const auto within = [](double x) { return 0.5 - std::abs(x - std::floor(x) - 0.5); };
    const double room = std::min(within(p.x), within(p.y));
    return radius < 0.1 && radius * stretch(source.layout, source.image.width, d, radius) < room;
}

/// The halves, of 2 (n - 1) between the first pixel's centre and the last one's, that pixel i of a
/// row or a column of n is made of; around the sphere the first and the last are one.
std::vector<int> halvesOf(int i, int n, bool around) {
    const int count = std::max(1, 2 * (n - 1));
    if (n == 1) return {0};
    std::vector<int> halves;
    for (const int half : {2 * i - 1, 2 * i}) {
        if (around) {
            halves.push_back((half + count) % count);
        } else if (half >= 0 && half < count) {
            halves.push_back(half);
        }
    }
    return halves;
}

/// Where a texel of OpenEXR's cube, whose faces are turned, lies on OpenGL's face.
struct CubeTexel {
    int face, column, row;
};

CubeTexel cubeTexel(const Panorama& exr_cube, int x, int y) {
    const int edge = exr_cube.image.width, row = y % edge;
    // Off the border, where the next faces begin, but nearer to no other texel.
    const auto inwards = [edge](int i) {
        return i == 0 ? 0.75 : i == edge - 1 ? i + 0.25 : i + 0.5;
    };
    const V3d d =
        *texelDirection(exr_cube.layout, edge, exr_cube.image.height, edge > 1 ? inwards(x) : 0.5,
                        y - row + (edge > 1 ? inwards(row) : 0.5));
    const CubePoint p = cubePoint(d);
    const auto nearest = [edge](double s) {
        return static_cast<int>(std::lround(0.5 * (s + 1) * (edge - 1)));
    };
    return {p.face, nearest(p.s), nearest(p.t)};
}

} // namespace

void throughSquareMap(const Panorama& source, const Panorama& areas, Panorama& result,
                      Enlarging enlarging, int threads, Image* down) {
    const Sampler sampler = makeSampler(source);
    const double pixel_size = hasBorderRule(source.layout) ? 2 : 1; // of the areas'
    const Image& from = areas.image;
    Image& image = result.image;
    const bool border = hasBorderRule(result.layout), around = result.layout == Layout::exrLatlong;
    const Panorama halves = border ? halfPixelsOf(result) : Panorama{};
    parallelFor(static_cast<std::size_t>(image.height), threads, [&](std::size_t row) {
        AreaReader reader(areas, border ? halves : result);
        const int y = static_cast<int>(row);
        std::vector<MomentSum> moments(down ? image.width : 0);
        const auto meanOfHalves = [&](int x, V3d& mean) {
            if (around) {
                return reader.mean(halvesOf(x, image.width, true), halvesOf(y, image.height, false),
                                   mean);
            }
            const CubeTexel texel = cubeTexel(result, x, y);
            std::vector<int> rows = halvesOf(texel.row, image.width, false);
            for (int& half : rows)
                half += texel.face * halves.image.width;
            return reader.mean(halvesOf(texel.column, image.width, false), rows, mean);
        };
        for (int x = 0; x < image.width; ++x) {
            const auto d =
                texelDirection(result.layout, image.width, image.height, x + 0.5, y + 0.5);
            if (!d) continue;
            const V2d p = texelPoint(areas.layout, from.width, from.height, *d);
            const int i = std::clamp(static_cast<int>(p.x), 0, from.width - 1);
            const int j = std::clamp(static_cast<int>(p.y), 0, from.height - 1);
            const V2i at = owningTexel(areas.layout, from.width, i, j).value_or(V2i(i, j));
            if (down) {
                if (!isWithinOnePixel(areas, result, *d, p)) moments[x] = reader.moments(x, y);
                if (moments[x].area == 0) moments[x].add(from.at(at.x, at.y), 1, 0, 0);
                continue;
            }
            const double pitch = enlarging == Enlarging::hold ? 0 : pitchAt(result, x, y);
            double share =
                enlarging == Enlarging::hold
                    ? 1
                    : areaShare(pitch / (pixel_size * pitchAt(areas, at.x, at.y)), enlarging);
            V3d value(0), mean;
            if (share > 0) {
                if (isWithinOnePixel(areas, result, *d, p)) {
                    const float* pixel = from.at(at.x, at.y);
                    value = V3d(pixel[0], pixel[1], pixel[2]) * share;
                } else if (border ? meanOfHalves(x, mean) : reader.mean(x, y, mean)) {
                    value += mean * share;
                } else {
                    share = 0;
                }
            }
            if (share < 1) value += radianceAt(sampler, *d, pitch) * (1 - share);
            setPixel(image.at(x, y), value);
        }
        if (down) storeRow(moments, y, image, *down);
    });
}

} // namespace ibl
