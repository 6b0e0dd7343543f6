// The probe is gathered on a grid of points, theta_r = pi (r + 0.5) / rows and psi_c = 2 pi c /
// columns. Interpolating Y_lm cubically between the grid's points, Y(x) = sum_g w_g(x) Y(x_g), a
// source at x is the same as sources w_g(x) at the grid's points: so every pixel is spread over
// 4 x 4 of them. Rows are integrated over theta by Gauss points; in psi a pixel is a point, and
// sinc(m dpsi / 2) makes it an area.
#include "core/parallel.h"
#include "lights/harmonic_sums.h"
#include "lights/lit_lanes.h"

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

/// A grid row of the probe's floats: its source rows, weighted and added, four at a time so that
/// the sums are read and written less often.
IBL_MULTIVERSION
void addRows(const Image& probe, const std::vector<RowTap>& taps, float* line) {
    const std::size_t size = probe.rowFloats();
    std::size_t t = 0;
    for (; t + 4 <= taps.size(); t += 4) {
        const float *a = probe.row(taps[t].row), *b = probe.row(taps[t + 1].row),
                    *c = probe.row(taps[t + 2].row), *d = probe.row(taps[t + 3].row);
        float w[4];
        for (std::size_t k = 0; k < 4; ++k)
            w[k] = static_cast<float>(taps[t + k].weight);
        for (std::size_t k = 0; k < size; ++k)
            line[k] += (w[0] * a[k] + w[1] * b[k]) + (w[2] * c[k] + w[3] * d[k]);
    }
    for (; t < taps.size(); ++t) {
        const float* a = probe.row(taps[t].row);
        const float w = static_cast<float>(taps[t].weight);
        for (std::size_t k = 0; k < size; ++k)
            line[k] += w * a[k];
    }
}

/// Spreads the line's pixels (RGB, and one float after the last) over the grid's columns of four
/// floats, which are zero before; the taps reach one column beyond the left, three the right. The
/// four columns that pixels go to are kept in registers until no pixel goes to them any more, in
/// two sums for pixels in turn, so that one addition need not wait for the other.
IBL_MULTIVERSION
void spreadColumns(const float* line, const std::vector<ColumnTap>& columns, float* grid) {
    FloatLanes sums[2][4]{};
    int first = columns[0].first;
    const auto put = [&](std::size_t k) __attribute__((always_inline)) {
        const FloatLanes sum = sums[0][k] + sums[1][k];
        __builtin_memcpy(grid + 4 * (first++ + 1), &sum, sizeof sum);
    };
    const auto add = [&](std::size_t i, FloatLanes * to) __attribute__((always_inline)) {
        FloatLanes pixel;
        __builtin_memcpy(&pixel, line + 3 * i, sizeof pixel);
        for (std::size_t k = 0; k < 4; ++k)
            to[k] += columns[i].weight[k] * pixel;
    };
    for (std::size_t i = 0; i < columns.size();) {
        while (first < columns[i].first) {
            put(0);
            for (FloatLanes* half : sums) {
                for (std::size_t k = 0; k < 3; ++k)
                    half[k] = half[k + 1];
                half[3] = FloatLanes{};
            }
        }
        add(i, sums[0]);
        if (++i == columns.size() || columns[i].first != first) continue;
        add(i, sums[1]);
        ++i;
    }
    for (std::size_t k = 0; k < 4; ++k)
        put(k);
}

/// A row of the grid, four floats a column, after one that is not part of it.
std::vector<float> gridRow(const Image& probe, const std::vector<RowTap>& rows,
                           const std::vector<ColumnTap>& columns, int grid_columns) {
    std::vector<float> line(probe.rowFloats() + 1, 0.f);
    addRows(probe, rows, line.data());
    const std::size_t around = 4 * static_cast<std::size_t>(grid_columns);
    std::vector<float> ring(around + 16, 0.f);
    spreadColumns(line.data(), columns, ring.data());
    for (std::size_t k = 0; k < 4; ++k)
        ring[around + k] += ring[k];
    for (std::size_t k = 4; k < 16; ++k)
        ring[k] += ring[around + k];
    return ring;
}

/// Vectors of floats, which are exact enough: what they leave of a coefficient's error is spread
/// over all rows.
constexpr int kWaves = 8;
typedef float WaveLanes __attribute__((vector_size(kWaves * sizeof(float))));

/// cos and sin of m psi_c for c = 0 .. columns / 4, m fastest, `waves` of them a column.
struct WaveTable {
    int waves; ///< degree + 1, rounded up to whole vectors
    std::vector<float> cosine, sine;
};

WaveTable waveTable(int degree, int columns) {
    WaveTable table{(degree + kWaves) / kWaves * kWaves, {}, {}};
    std::vector<float> cosine, sine;
    for (int k = 0; k < columns; ++k) {
        cosine.push_back(static_cast<float>(std::cos(2 * kPi * k / columns)));
        sine.push_back(static_cast<float>(std::sin(2 * kPi * k / columns)));
    }
    for (std::vector<float>* values : {&table.cosine, &table.sine})
        values->reserve(static_cast<std::size_t>(columns / 4 + 1) * table.waves);
    for (int c = 0; c <= columns / 4; ++c) {
        for (int m = 0, place = 0; m < table.waves; ++m) { // place = c m, modulo the columns
            table.cosine.push_back(cosine[static_cast<std::size_t>(place)]);
            table.sine.push_back(sine[static_cast<std::size_t>(place)]);
            place = place + c < columns ? place + c : place + c - columns;
        }
    }
    return table;
}

/// For even and odd m.
using EvenOdd = std::array<float, 2>;

/// Columns half a turn apart differ by the sign (-1)^m, and those mirrored at a quarter turn by the
/// sign of cosine or sine: a quarter of them is left.
struct Folded {
    EvenOdd cosine[3], sine[3]; ///< by channel
};

std::vector<Folded> fold(const float* grid, int columns) {
    const int half = columns / 2, quarter = half / 2;
    std::vector<Folded> folded(static_cast<std::size_t>(quarter) + 1);
    for (int c = 0; c <= quarter; ++c) {
        const bool alone = c == 0 || c == quarter;
        const int d = half - c;
        for (int channel = 0; channel < 3; ++channel) {
            const auto at = [&](int column) { return grid[4 * column + channel]; };
            const float plus = at(c) + at(c + half), minus = at(c) - at(c + half);
            const float plus_d = alone ? 0 : at(d) + at(d + half);
            const float minus_d = alone ? 0 : at(d) - at(d + half);
            Folded& f = folded[static_cast<std::size_t>(c)];
            f.cosine[channel] = {plus + plus_d, minus - minus_d};
            f.sine[channel] = {plus - plus_d, minus + minus_d};
        }
    }
    return folded;
}

/// Even, odd, even, odd, ...
IBL_INLINE WaveLanes repeated(const EvenOdd& values) {
    double both;
    __builtin_memcpy(&both, values.data(), sizeof both);
    return reinterpret_cast<WaveLanes>(Lanes{both, both, both, both});
}

IBL_INLINE WaveLanes loadWaves(const float* from) {
    WaveLanes v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

/// sum_c x_c exp(-i m psi_c) of three channels: re, im, re, im, re, im, each of `waves` values.
IBL_MULTIVERSION
void waves(const WaveTable& table, const std::vector<Folded>& folded, float* out) {
    for (int m = 0; m < table.waves; m += kWaves) {
        WaveLanes sums[6]{};
        for (std::size_t c = 0; c < folded.size(); ++c) {
            const std::size_t at = c * static_cast<std::size_t>(table.waves) + m;
            const WaveLanes cosine = loadWaves(&table.cosine[at]),
                            sine = loadWaves(&table.sine[at]);
            for (std::size_t k = 0; k < 3; ++k) {
                sums[2 * k] += repeated(folded[c].cosine[k]) * cosine;
                sums[2 * k + 1] -= repeated(folded[c].sine[k]) * sine;
            }
        }
        for (int k = 0; k < 6; ++k)
            __builtin_memcpy(out + k * table.waves + m, &sums[k], sizeof sums[k]);
    }
}

/// The Fourier coefficients of the grid's rows: [row][channel re, im][m].
struct GridWaves {
    int rows;
    int columns;
    int waves;
    std::vector<float, UninitialisedAllocator<float>> values;

    float* at(int row, int part) {
        return &values[(static_cast<std::size_t>(row) * 6 + part) * waves];
    }
};

GridWaves gridWaves(const Image& probe, int degree, int threads) {
    const WaveTable table = waveTable(degree, 8 * degree);
    GridWaves grid{4 * degree, 8 * degree, table.waves, {}};
    const int all_rows = grid.rows + 2 * kMargin;
    grid.values.resize(static_cast<std::size_t>(all_rows) * 6 * grid.waves);
    const auto rows = rowTaps(probe.height, grid.rows);
    const auto columns = columnTaps(probe.width, grid.columns);
    constexpr int kRun = 4;
    const int runs = (all_rows + kRun - 1) / kRun;
    parallelFor(static_cast<std::size_t>(runs), threads, [&](std::size_t index) {
        const int run = static_cast<int>(index);
        for (int r = run * kRun; r < std::min(all_rows, (run + 1) * kRun); ++r) {
            const auto ring =
                gridRow(probe, rows[static_cast<std::size_t>(r)], columns, grid.columns);
            waves(table, fold(ring.data() + 4, grid.columns), grid.at(r, 0));
        }
    });
    return grid;
}

/// Rows beyond a pole are those before it, half a turn away.
void foldMargins(GridWaves& grid) {
    for (int k = 0; k < kMargin; ++k) {
        for (int part = 0; part < 6; ++part) {
            const float *north = grid.at(k, part), *south = grid.at(grid.rows + kMargin + k, part);
            float *to_north = grid.at(2 * kMargin - 1 - k, part),
                  *to_south = grid.at(grid.rows + kMargin - 1 - k, part);
            for (int m = 0; m < grid.waves; ++m) {
                const float sign = m % 2 ? -1 : 1;
                to_north[m] += sign * north[m];
                to_south[m] += sign * south[m];
            }
        }
    }
}

/// Grid rows [begin, end) of the northern half with their mirror images: for even l
/// P_lm(-x) = (-1)^m P_lm(x), so that the two are one source; for l = 1 the sign is the other.
void addRowPairs(GridWaves& grid, const std::vector<double>& pixel, int begin, int end,
                 LightHarmonics& harmonics) {
    HarmonicSources sources(static_cast<std::size_t>(end - begin));
    for (int r = begin; r < end; ++r) {
        const double theta = kPi * (r + 0.5) / grid.rows;
        sources.x[static_cast<std::size_t>(r - begin)] = std::cos(theta);
        sources.sine[static_cast<std::size_t>(r - begin)] = std::sin(theta);
    }
    for (int m = 0; m <= harmonics.degree; ++m) {
        const double sign = m % 2 ? -1 : 1, area = pixel[static_cast<std::size_t>(m)];
        for (int r = begin; r < end; ++r) {
            const std::size_t i = static_cast<std::size_t>(r - begin);
            for (int part = 0; part < 6; ++part) {
                const double north = area * grid.at(r + kMargin, part)[m];
                const double south = area * grid.at(grid.rows - 1 - r + kMargin, part)[m];
                const std::size_t k = static_cast<std::size_t>(part);
                sources.wave[k][i] = north + sign * south;
                if (m == 0) // P_10 = sqrt(3) x P_00
                    harmonics.first[0][k] +=
                        std::sqrt(3.0) * sources.x[i] * sources.sectoral[i] * (north - south);
                if (m == 1) harmonics.first[1][k] += sources.sectoral[i] * (north + south);
            }
        }
        addOrder(sources, m, harmonics.degree, harmonics.even.data() + harmonics.column(m));
        raiseSectoral(sources, m);
    }
}

} // namespace

LightHarmonics probeHarmonics(const Image& latlong, int degree, int threads) {
    GridWaves grid = gridWaves(latlong, degree, threads);
    foldMargins(grid);
    std::vector<double> pixel; // a pixel's extent in psi, for each wave
    for (int m = 0; m <= degree; ++m) {
        const double half_angle = kPi * m / latlong.width;
        pixel.push_back(2 * kPi / latlong.width * (m == 0 ? 1 : std::sin(half_angle) / half_angle));
    }
    constexpr int kRun = 32;
    const int half = grid.rows / 2, runs = (half + kRun - 1) / kRun;
    std::vector<LightHarmonics> parts(static_cast<std::size_t>(runs), LightHarmonics(degree));
    parallelFor(parts.size(), threads, [&](std::size_t run) {
        const int begin = static_cast<int>(run) * kRun;
        addRowPairs(grid, pixel, begin, std::min(half, begin + kRun), parts[run]);
    });
    LightHarmonics total(degree);
    for (const LightHarmonics& part : parts)
        total += part;
    return total;
}

} // namespace ibl
