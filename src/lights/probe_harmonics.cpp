// The probe is gathered on a grid of points, theta_r = pi (r + 0.5) / rows and psi_c = 2 pi c /
// columns. Interpolating Y_lm cubically between the grid's points, Y(x) = sum_g w_g(x) Y(x_g), a
// source at x is the same as sources w_g(x) at the grid's points: so every pixel is spread over
// 4 x 4 of them. Rows are integrated over theta by Gauss points; in psi a pixel is a point, and
// sinc(m dpsi / 2) makes it an area.
#include "core/parallel.h"
#include "lights/light_harmonics.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr int kMargin = 2; ///< grid rows beyond each pole

/// Cubic Lagrange weights of the four points at -1, 0, 1, 2 for a place t in [0, 1).
std::array<double, 4> cubicWeights(double t) {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6};
}

/// A source row's part in a grid row.
struct RowTap {
    int row;
    double weight;
};

/// For each grid row, margins included, the source rows that it takes from. The weight has the
/// measure sin theta dtheta; two Gauss points to each grid spacing.
std::vector<std::vector<RowTap>> rowTaps(int height, int rows) {
    std::vector<std::vector<RowTap>> taps(static_cast<std::size_t>(rows + 2 * kMargin));
    const int pieces = (rows + height - 1) / height;
    const double step = kPi / height / pieces, offset = 0.5 / std::sqrt(3.0);
    for (int j = 0; j < height; ++j) {
        for (int point = 0; point < 2 * pieces; ++point) {
            const double side = point % 2 ? offset : -offset;
            const double theta = kPi * j / height + step * (point / 2 + 0.5 + side);
            const double place = theta / kPi * rows - 0.5;
            const double base = std::floor(place);
            const auto weights = cubicWeights(place - base);
            for (int k = 0; k < 4; ++k) {
                auto& row = taps[static_cast<std::size_t>(base) + kMargin - 1 + k];
                const double weight = 0.5 * step * std::sin(theta) * weights[k];
                if (!row.empty() && row.back().row == j)
                    row.back().weight += weight;
                else
                    row.push_back({j, weight});
            }
        }
    }
    return taps;
}

/// Where each column of the source goes.
struct ColumnTap {
    int first; ///< grid column of the first of four weights, not yet wrapped
    std::array<float, 4> weight;
};

std::vector<ColumnTap> columnTaps(int width, int columns) {
    std::vector<ColumnTap> taps;
    for (int i = 0; i < width; ++i) {
        const double place = (i + 0.5) / width * columns;
        const double base = std::floor(place);
        const auto w = cubicWeights(place - base);
        taps.push_back({static_cast<int>(base) - 1,
                        {static_cast<float>(w[0]), static_cast<float>(w[1]),
                         static_cast<float>(w[2]), static_cast<float>(w[3])}});
    }
    return taps;
}

/// cos and sin of m psi_c for c = 0 .. columns / 4, m fastest.
struct WaveTable {
    int waves;
    std::vector<double> cosine, sine;
};

WaveTable waveTable(int degree, int columns) {
    WaveTable table{degree + 1, {}, {}};
    for (int c = 0; c <= columns / 4; ++c) {
        for (int m = 0; m <= degree; ++m) {
            const double angle = 2 * kPi * ((static_cast<long>(c) * m) % columns) / columns;
            table.cosine.push_back(std::cos(angle));
            table.sine.push_back(std::sin(angle));
        }
    }
    return table;
}

/// sum_c x_c exp(-i m psi_c) for all m of one channel. Columns half a turn apart differ by the sign
/// (-1)^m, and those mirrored at a quarter turn by the sign of cosine or sine: a quarter is left.
void waves(const WaveTable& table, const std::vector<float>& x, int channel, double* re,
           double* im) {
    const int columns = static_cast<int>(x.size()) / 4, half = columns / 2, quarter = half / 2;
    const auto at = [&](int c) { return double{x[4 * static_cast<std::size_t>(c) + channel]}; };
    std::fill_n(re, table.waves, 0.0);
    std::fill_n(im, table.waves, 0.0);
    for (int c = 0; c <= quarter; ++c) {
        const bool alone = c == 0 || c == quarter;
        const double plus = at(c) + at(c + half), minus = at(c) - at(c + half);
        const int d = half - c;
        const double plus_d = alone ? 0 : at(d) + at(d + half);
        const double minus_d = alone ? 0 : at(d) - at(d + half);
        const double even_cos = plus + plus_d, even_sin = plus - plus_d;
        const double odd_cos = minus - minus_d, odd_sin = minus + minus_d;
        const double* cosine = &table.cosine[static_cast<std::size_t>(c) * table.waves];
        const double* sine = &table.sine[static_cast<std::size_t>(c) * table.waves];
        int m = 0;
        for (; m + 1 < table.waves; m += 2) {
            re[m] += even_cos * cosine[m];
            im[m] -= even_sin * sine[m];
            re[m + 1] += odd_cos * cosine[m + 1];
            im[m + 1] -= odd_sin * sine[m + 1];
        }
        re[m] += even_cos * cosine[m]; // the degree is even
        im[m] -= even_sin * sine[m];
    }
}

/// The Fourier coefficients of the grid's rows: [row][channel re, im][m].
struct GridWaves {
    int rows;
    int columns;
    int waves;
    std::vector<double> values;

    double* at(int row, int part) {
        return &values[(static_cast<std::size_t>(row) * 6 + part) * waves];
    }
};

GridWaves gridWaves(const Image& probe, int degree, int threads) {
    GridWaves grid{4 * degree, 8 * degree, degree + 1, {}};
    const int all_rows = grid.rows + 2 * kMargin;
    grid.values.resize(static_cast<std::size_t>(all_rows) * 6 * grid.waves);
    const auto rows = rowTaps(probe.height, grid.rows);
    const auto columns = columnTaps(probe.width, grid.columns);
    const WaveTable table = waveTable(degree, grid.columns);
    parallelFor(static_cast<std::size_t>(all_rows), threads, [&](std::size_t r) {
        std::vector<float> line(probe.rowFloats(), 0.f);
        for (const RowTap& tap : rows[r]) {
            const float* in = probe.row(tap.row);
            const float weight = static_cast<float>(tap.weight);
            for (std::size_t k = 0; k < line.size(); ++k)
                line[k] += weight * in[k];
        }
        // Four floats to a column; the taps reach one column beyond the left, three the right.
        std::vector<float> spread(4 * static_cast<std::size_t>(grid.columns + 4), 0.f);
        for (std::size_t i = 0; i < columns.size(); ++i) {
            float* out = &spread[4 * static_cast<std::size_t>(columns[i].first + 1)];
            const float rgb[4] = {line[3 * i], line[3 * i + 1], line[3 * i + 2], 0};
            for (int k = 0; k < 4; ++k) {
                for (int c = 0; c < 4; ++c)
                    out[4 * k + c] += columns[i].weight[k] * rgb[c];
            }
        }
        std::vector<float> ring(spread.begin() + 4, spread.begin() + 4 + 4 * grid.columns);
        for (int c = 0; c < 4; ++c) {
            ring[ring.size() - 4 + c] += spread[c];
            for (int k = 0; k < 3; ++k)
                ring[4 * k + c] += spread[4 * (grid.columns + 1 + k) + c];
        }
        for (int c = 0; c < 3; ++c) {
            waves(table, ring, c, grid.at(static_cast<int>(r), 2 * c),
                  grid.at(static_cast<int>(r), 2 * c + 1));
        }
    });
    return grid;
}

/// Rows beyond a pole are those before it, half a turn away.
void foldMargins(GridWaves& grid) {
    for (int k = 0; k < kMargin; ++k) {
        for (int part = 0; part < 6; ++part) {
            const double *north = grid.at(k, part), *south = grid.at(grid.rows + kMargin + k, part);
            double *to_north = grid.at(2 * kMargin - 1 - k, part),
                   *to_south = grid.at(grid.rows + kMargin - 1 - k, part);
            for (int m = 0; m < grid.waves; ++m) {
                const double sign = m % 2 ? -1 : 1;
                to_north[m] += sign * north[m];
                to_south[m] += sign * south[m];
            }
        }
    }
}

} // namespace

LightHarmonics probeHarmonics(const Image& latlong, int degree, int threads) {
    GridWaves grid = gridWaves(latlong, degree, threads);
    foldMargins(grid);
    LightHarmonics harmonics(degree);
    parallelFor(static_cast<std::size_t>(degree) + 1, threads, [&](std::size_t wave) {
        const int m = static_cast<int>(wave);
        const double half_angle = kPi * m / latlong.width;
        const double pixel =
            2 * kPi / latlong.width * (m == 0 ? 1 : std::sin(half_angle) / half_angle);
        LightHarmonics::Parts* column = harmonics.even.data() + harmonics.column(m);
        // P_mm = sqrt((2m + 1)!! / (2m)!! / (4 pi)) sin^m theta
        double norm = std::sqrt(1 / (4 * kPi));
        for (int k = 1; k <= m; ++k)
            norm *= std::sqrt((2.0 * k + 1) / (2.0 * k));
        for (int r = 0; r < grid.rows; ++r) {
            const double theta = kPi * (r + 0.5) / grid.rows;
            LightHarmonics::Parts source;
            for (int part = 0; part < 6; ++part)
                source[static_cast<std::size_t>(part)] = pixel * grid.at(r + kMargin, part)[m];
            const auto add = [&](double p, LightHarmonics::Parts& out) {
                for (std::size_t k = 0; k < 6; ++k)
                    out[k] += p * source[k];
            };
            LightHarmonics::Parts* out = column;
            legendreColumn(m, degree, std::cos(theta), norm * std::pow(std::sin(theta), m),
                           [&](int l, double p) {
                               if (l == 1) add(p, harmonics.first[wave]);
                               if (l % 2 == 0) add(p, *out++);
                           });
        }
    });
    return harmonics;
}

} // namespace ibl
