// Lat-long to lat-long. Area filter and interpolation are both products of one weight along the
// parallel and one along the meridian, and so is their blend.
#include "panorama/latlong_moments.h"
#include "panorama/resample_parts.h"

#include "core/parallel.h"

namespace ibl {
namespace {

struct Tap {
    int index;
    double weight;
    double moment = 0; ///< of an area: weight times its middle's way from that of the new pixel, in
                       ///< columns, and in parts of the new row's height in z
};

/// Overlaps thinner than this part of a pixel are rounding of none.
constexpr double kNoOverlap = 1e-10;

int wrapped(long k, int columns) {
    return static_cast<int>(((k % columns) + columns) % columns);
}

/// Where column x of `to` takes its value along the parallel; weights sum to 1.
std::vector<Tap> columnTaps(const LatlongGrid& from, const LatlongGrid& to, int x,
                            Enlarging enlarging) {
    const double scale = static_cast<double>(from.columns) / to.columns;
    const double share = areaShare(scale, enlarging);
    std::vector<Tap> taps;
    if (share > 0) {
        const double begin = (x + to.first) * from.columns / to.columns - from.first;
        const double end = (x + 1 + to.first) * from.columns / to.columns - from.first;
        for (double a = begin; end - a > kNoOverlap;) {
            const double cell = std::floor(a + kNoOverlap), b = std::min(end, cell + 1);
            const double part = (b - a) / (end - begin);
            const double off = (0.5 * (a + b) - 0.5 * (begin + end)) / (end - begin);
            taps.push_back(
                {wrapped(static_cast<long>(cell), from.columns), part * share, part * share * off});
            a = b;
        }
    }
    if (share < 1) {
        const double at = (x + 0.5 + to.first) * from.columns / to.columns - from.first - 0.5;
        const double cell = std::floor(at), f = at - cell;
        const long k = static_cast<long>(cell);
        taps.push_back({wrapped(k, from.columns), (1 - f) * (1 - share)});
        if (f > 0) taps.push_back({wrapped(k + 1, from.columns), f * (1 - share)});
    }
    return taps;
}

struct Meridian {
    LatlongGrid grid;
    bool border;
};

/// Where row y of `to` takes its value along the meridian: rows of `from`, or -1 and rows() for the
/// means at its poles.
std::vector<Tap> rowTaps(const Meridian& from, const Meridian& to, int y, Enlarging enlarging) {
    const int rows = from.grid.rows();
    const double share = areaShare(
        centrePitch(1, to.grid.rows(), to.border) / centrePitch(1, rows, from.border), enlarging);
    std::vector<Tap> taps;
    if (share > 0) {
        const auto k = static_cast<std::size_t>(y);
        const double top = to.grid.theta[k], bottom = to.grid.theta[k + 1];
        const auto band = [](double a, double b) {
            return 2 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
        };
        const std::vector<double>& theta = from.grid.theta;
        const auto after = std::upper_bound(theta.begin(), theta.end(), top);
        double sum = 0;
        for (auto row = static_cast<std::size_t>(after - theta.begin()) - 1;
             row + 1 < theta.size() && theta[row] < bottom; ++row) {
            const double a = std::max(top, theta[row]), b = std::min(bottom, theta[row + 1]);
            if (b - a <= kNoOverlap * (theta[row + 1] - theta[row])) continue;
            const double part = band(a, b);
            const double off = (0.5 * (band(top, a) + band(top, b))) / band(top, bottom) - 0.5;
            taps.push_back({static_cast<int>(row), part, part * off});
            sum += part;
        }
        for (Tap& tap : taps) {
            tap.weight *= share / sum;
            tap.moment *= share / sum;
        }
    }
    if (share < 1) {
        // Nodes are the rows' centres and the poles, half a row outside them, or, by the border
        // rule, in place of the first and the last.
        const double v = centreAt(y, to.grid.rows(), to.border);
        const double at = from.border && rows > 1 ? v * (rows - 1) : v * rows - 0.5;
        const double cell = std::clamp(std::floor(at), -1.0, rows - 1.0);
        double f = at - cell;
        if (cell < 0) f = 2 * (f - 0.5);
        if (cell == rows - 1) f *= 2;
        const auto node = [&](int row) {
            if (from.border && row == 0) return -1;
            return from.border && row == rows - 1 ? rows : row;
        };
        const int row = static_cast<int>(cell);
        taps.push_back({node(row), (1 - f) * (1 - share)});
        if (f > 0) taps.push_back({node(row + 1), f * (1 - share)});
    }
    return taps;
}

V3d mean(const float* row, int columns) {
    V3d sum(0);
    for (int x = 0; x < columns; ++x)
        sum += V3d(row[3 * x], row[3 * x + 1], row[3 * x + 2]);
    return sum / columns;
}

} // namespace

LatlongPixels::LatlongPixels(const Panorama& p) : image_(&p.image) {
    const int columns = p.image.width - 1;
    if (p.layout != Layout::exrLatlong || columns < 1) return;
    folded_ = Image(columns, p.image.height);
    for (int y = 0; y < p.image.height; ++y) {
        std::copy_n(p.image.row(y), 3 * columns, folded_.row(y));
        const float* last = p.image.at(columns, y);
        for (int c = 0; c < 3; ++c)
            folded_.at(0, y)[c] = 0.5f * folded_.at(0, y)[c] + 0.5f * last[c];
    }
    image_ = &folded_;
}

void latlongToLatlong(const Panorama& source, Panorama& result, Enlarging enlarging, int threads,
                      Image* down) {
    const bool from_border = hasBorderRule(source.layout), to_border = hasBorderRule(result.layout);
    const Meridian from{latlongGrid(source.image.width, source.image.height, from_border),
                        from_border};
    const Meridian to{latlongGrid(result.image.width, result.image.height, to_border), to_border};
    const LatlongPixels pixels(source);
    const int columns = from.grid.columns, rows = from.grid.rows();
    const V3d north = mean(pixels.row(0), columns), south = mean(pixels.row(rows - 1), columns);

    std::vector<std::vector<Tap>> across(static_cast<std::size_t>(to.grid.columns));
    for (int x = 0; x < to.grid.columns; ++x) {
        across[static_cast<std::size_t>(x)] = columnTaps(from.grid, to.grid, x, enlarging);
    }
    parallelFor(static_cast<std::size_t>(to.grid.rows()), threads, [&](std::size_t y) {
        std::vector<V3d> sums(static_cast<std::size_t>(columns), V3d(0));
        std::vector<V3d> lower(down ? sums.size() : 0, V3d(0));
        for (const Tap& tap : rowTaps(from, to, static_cast<int>(y), enlarging)) {
            const bool pole = tap.index < 0 || tap.index >= rows;
            const V3d at_pole = tap.index < 0 ? north : south;
            const float* row = pole ? nullptr : pixels.row(tap.index);
            for (std::size_t x = 0; x < sums.size(); ++x) {
                const V3d value = pole ? at_pole : V3d(row[3 * x], row[3 * x + 1], row[3 * x + 2]);
                sums[x] += value * tap.weight;
                if (down) lower[x] += value * tap.moment;
            }
        }
        if (down) {
            std::vector<MomentSum> moments(across.size());
            for (std::size_t x = 0; x < across.size(); ++x) {
                MomentSum& sum = moments[x];
                for (const Tap& tap : across[x]) {
                    sum.add(sums[tap.index], tap.weight, tap.moment, 0);
                    sum.down += lower[tap.index] * tap.weight;
                }
            }
            storeRow(moments, static_cast<int>(y), result.image, *down);
            return;
        }
        for (std::size_t x = 0; x < across.size(); ++x) {
            V3d value(0);
            for (const Tap& tap : across[x])
                value += sums[static_cast<std::size_t>(tap.index)] * tap.weight;
            setPixel(result.image.at(static_cast<int>(x), static_cast<int>(y)), value);
        }
    });
}

} // namespace ibl
