#include "convolve/sh_window.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

V3d onSphere(double theta, double alpha) {
    const double across = std::sin(theta);
    return {across * std::cos(alpha), across * std::sin(alpha), std::cos(theta)};
}

/// Values of each band on a grid of `rings` rings and 2 `rings` columns, so that any window of them
/// is a short sum.
struct BandGrid {
    int order;
    int rings;
    std::vector<double> values; ///< [point][channel][band]

    int columns() const { return 2 * rings; }
    V3d direction(int ring, int column) const {
        return onSphere(kPi * (ring + 0.5) / rings, kPi * column / rings);
    }
};

BandGrid makeGrid(const ShCoefficients& coefficients) {
    const int order = coefficients.order;
    BandGrid grid{order, std::max(16, 8 * order), {}};
    grid.values.reserve(std::size_t{6} * grid.rings * grid.rings * order);
    for (int ring = 0; ring < grid.rings; ++ring) {
        for (int column = 0; column < grid.columns(); ++column) {
            std::array<double, kMaxShOrder * kMaxShOrder> basis;
            shBasis(order, grid.direction(ring, column), basis);
            for (int c = 0; c < 3; ++c) {
                for (int l = 0; l < order; ++l) {
                    double sum = 0;
                    for (int i = l * l; i < (l + 1) * (l + 1); ++i)
                        sum += coefficients.values[i][c] * basis[i];
                    grid.values.push_back(sum);
                }
            }
        }
    }
    return grid;
}

double valueAt(const ShCoefficients& f, int channel, const V3d& d) {
    std::array<double, kMaxShOrder * kMaxShOrder> basis;
    shBasis(f.order, d, basis);
    double sum = 0;
    for (std::size_t i = 0; i < f.values.size(); ++i)
        sum += f.values[i][channel] * basis[i];
    return sum;
}

/// The least value near `d`: Newton steps in the tangent plane, derivatives by central differences
/// of width `step`, which halves when no step goes lower. At the end the value is within
/// n^2 M step^2 of the minimum.
double refine(const ShCoefficients& f, int channel, V3d d, double step) {
    double least = valueAt(f, channel, d);
    for (int i = 0; step > 1e-6 && i < 200; ++i) {
        const V3d a =
            (std::abs(d.z) < 0.5 ? d.cross(V3d(0, 0, 1)) : d.cross(V3d(1, 0, 0))).normalized();
        const V3d b = d.cross(a);
        const auto at = [&](double s, double t) {
            return valueAt(f, channel, (d + step * (s * a + t * b)).normalized());
        };
        const double right = at(1, 0), left = at(-1, 0), up = at(0, 1), down = at(0, -1);
        const double gs = (right - left) / 2, gt = (up - down) / 2;
        const double ss = right + left - 2 * least, tt = up + down - 2 * least;
        const double st = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4;
        const double det = ss * tt - st * st;
        double s = -gs, t = -gt; // downhill where the surface is no bowl
        if (ss > 0 && det > 0) {
            s = (st * gt - tt * gs) / det;
            t = (st * gs - ss * gt) / det;
        }
        const double length = std::hypot(s, t);
        if (length > 1 || (!(ss > 0 && det > 0) && length > 0)) {
            s /= length;
            t /= length;
        }
        const V3d next = (d + step * (s * a + t * b)).normalized();
        const double value = valueAt(f, channel, next);
        if (value < least) {
            least = value;
            d = next;
            if (length > 0.5) continue;
        }
        step /= 2;
    }
    return least;
}

/// The least value of one channel of `grid` under the window; `f` are the windowed coefficients.
double leastOfChannel(const BandGrid& grid, const ShCoefficients& f, double lambda, int channel) {
    const int rings = grid.rings, columns = grid.columns();
    std::array<double, kMaxShOrder> window;
    for (int l = 0; l < grid.order; ++l)
        window[l] = shWindow(lambda, l);
    std::vector<double> value(static_cast<std::size_t>(rings) * columns);
    for (std::size_t p = 0; p < value.size(); ++p) {
        const double* band = &grid.values[(3 * p + channel) * grid.order];
        for (int l = 0; l < grid.order; ++l)
            value[p] += window[l] * band[l];
    }
    double least = *std::ranges::min_element(value);
    double size = 0;
    for (const double v : value)
        size = std::max(size, std::abs(v));
    // No direction is farther from a grid point than half a cell's diagonal. M is at most twice the
    // largest grid value on a grid this fine.
    const double n = grid.order - 1, h = kPi / rings / std::numbers::sqrt2;
    const double highest = least + size * n * n * h * h;
    const auto at = [&](int r, int c) {
        return value[static_cast<std::size_t>(r) * columns + (c + columns) % columns];
    };
    for (int r = 0; r < rings; ++r) {
        for (int c = 0; c < columns; ++c) {
            const double v = at(r, c);
            const bool local = v <= at(r, c - 1) && v <= at(r, c + 1) &&
                               (r == 0 || v <= at(r - 1, c)) &&
                               (r == rings - 1 || v <= at(r + 1, c));
            if (local && v <= highest && n > 0) {
                least = std::min(least, refine(f, channel, grid.direction(r, c), h));
            }
        }
    }
    return least;
}

/// In the orthonormal basis, whatever the convention.
ShCoefficients orthonormal(const ShCoefficients& f) {
    ShCoefficients result = f;
    if (f.convention != ShConvention::filament) return result;
    const ShCoefficients ones = toConvention(
        {ShConvention::radiance, f.order, std::vector(f.values.size(), std::array{1.0, 1.0, 1.0})},
        ShConvention::filament);
    for (std::size_t i = 0; i < f.values.size(); ++i) {
        const int l = static_cast<int>(std::sqrt(static_cast<double>(i)));
        for (int c = 0; c < 3; ++c)
            result.values[i][c] *= cosineFactor(l) / kPi / ones.values[i][c];
    }
    return result;
}

/// A channel that is exactly constant is its own minimum: nothing to search.
bool isFlat(const ShCoefficients& f, int channel) {
    return std::all_of(f.values.begin() + 1, f.values.end(),
                       [&](const auto& rgb) { return rgb[channel] == 0; });
}

} // namespace

double shWindow(double lambda, int l) {
    return 1 / (1 + lambda * l * l * (l + 1.0) * (l + 1.0));
}

ShCoefficients damp(const ShCoefficients& coefficients, double lambda) {
    ShCoefficients result = coefficients;
    for (int l = 1; l < result.order; ++l) {
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
            for (double& value : result.values[i])
                value *= shWindow(lambda, l);
        }
    }
    return result;
}

std::array<double, 3> leastOverSphere(const ShCoefficients& coefficients) {
    const ShCoefficients f = orthonormal(coefficients);
    const BandGrid grid = makeGrid(f);
    return {leastOfChannel(grid, f, 0, 0), leastOfChannel(grid, f, 0, 1),
            leastOfChannel(grid, f, 0, 2)};
}

double leastDamping(const ShCoefficients& coefficients, std::string_view subject) {
    const ShCoefficients f = orthonormal(coefficients);
    const BandGrid grid = makeGrid(f);
    double lambda = 0;
    for (int c = 0; c < 3; ++c) {
        const double mean = f.values[0][c] * std::sqrt(1 / (4 * kPi));
        if (mean < 0 || (mean == 0 && !isFlat(f, c))) {
            throw Error(ExitCode::input, std::string(subject) +
                                             ": a channel's mean is not above 0, which no window "
                                             "mends; repair the probe or use none");
        }
        const auto holds = [&](double tried) {
            return leastOfChannel(grid, damp(f, tried), tried, c) >= -1e-9 * mean;
        };
        if (isFlat(f, c) || holds(lambda)) continue;
        double low = lambda, high = std::max(1e-6, 2 * lambda);
        while (!holds(high)) {
            low = high;
            high *= 2;
        }
        while (high - low > 1e-4 * high) {
            const double middle = (low + high) / 2;
            (holds(middle) ? high : low) = middle;
        }
        lambda = high;
    }
    return lambda;
}

} // namespace ibl
