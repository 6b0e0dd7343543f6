// The transform against libsharp: the same rings, band limits, three channels and threads.
//
// Both synthesise random coefficients up to degree L on 2 (L + 1) rings (Fejer's first rule) of
// twice as many columns, and analyse what comes of it by Fejer's weights. They take turns, so that
// both meet the same machine; `ratio` is libsharp's median time over ours, `cpu_ratio` the same of
// processor time, which a busy machine sways less (libsharp's second thread spins while it waits,
// so it means little with two). `error` is the relative RMS of our round trip, `sharp_error` that
// of libsharp's, `difference` that between the two.
#include "convolve/analysis.h"
#include "convolve/synthesis.h"
#include "convolve/theta_resample.h"
#include "core/parallel.h"

#include "bench_support.h"

#include <libsharp/sharp.h>
#include <libsharp/sharp_almhelpers.h>
#include <libsharp/sharp_geomhelpers.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <ctime>
#include <numbers>
#include <thread>

namespace {

using namespace ibl;
using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

struct Seconds {
    std::vector<double> wall, cpu;

    /// The second of two runs: a processor that has slept takes milliseconds to come to work.
    void add(const auto& work) {
        work();
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t cpu_start = std::clock();
        work();
        cpu.push_back(static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
        wall.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
};

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + values.size() / 2);
    return values[values.size() / 2];
}

std::vector<double> flat(const Harmonics& f) {
    return {f.coefficients.front().data(),
            f.coefficients.front().data() + 6 * f.coefficients.size()};
}

/// libsharp's transforms of three maps; it has the Condon-Shortley sign, ours are without.
class Sharp {
public:
    Sharp(int degree, int rings, int threads) : degree_(degree), rings_(rings) {
        omp_set_num_threads(threads);
        sharp_make_triangular_alm_info(degree, degree, 1, &alm_);
        sharp_make_fejer1_geom_info(rings, 2 * rings, 0, 1, 2 * rings, &geometry_);
        for (int c = 0; c < 3; ++c) {
            coefficients_[c].resize(static_cast<std::size_t>(sharp_alm_count(alm_)));
            maps_[c].resize(static_cast<std::size_t>(2) * rings * rings);
        }
    }
    Sharp(const Sharp&) = delete;
    Sharp& operator=(const Sharp&) = delete;
    ~Sharp() {
        sharp_destroy_alm_info(alm_);
        sharp_destroy_geom_info(geometry_);
    }

    void execute(sharp_jobtype job) {
        for (int c = 0; c < 3; ++c) {
            void *alm = coefficients_[c].data(), *map = maps_[c].data();
            sharp_execute(job, 0, &alm, &map, geometry_, alm_, SHARP_DP, nullptr, nullptr);
        }
    }
    void setHarmonics(const Harmonics& f) {
        forAll([&](int l, int m, int c, Complex& a) {
            a = sign(m) * Complex(f.at(l, m)[2 * c], f.at(l, m)[2 * c + 1]);
        });
    }
    Harmonics harmonics() {
        Harmonics f(degree_);
        forAll([&](int l, int m, int c, Complex& a) {
            f.at(l, m)[2 * c] = sign(m) * a.real();
            f.at(l, m)[2 * c + 1] = sign(m) * a.imag();
        });
        return f;
    }
    /// [channel][ring][column]
    std::vector<double> map() const {
        std::vector<double> result;
        for (const std::vector<double>& plane : maps_)
            result.insert(result.end(), plane.begin(), plane.end());
        return result;
    }
    void setMap(const std::vector<double>& values) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto plane = values.begin() + static_cast<std::ptrdiff_t>(c * maps_[c].size());
            std::copy_n(plane, maps_[c].size(), maps_[c].begin());
        }
    }
    /// Fejer's weight of each ring's samples.
    std::vector<double> weights() const {
        std::vector<double> result(static_cast<std::size_t>(rings_));
        for (int i = 0; i < geometry_->npairs; ++i) {
            const sharp_ringpair& pair = geometry_->pair[i];
            result[pair.r1.ofs / (2 * rings_)] = pair.r1.weight;
            if (pair.r2.nph > 0) result[pair.r2.ofs / (2 * rings_)] = pair.r2.weight;
        }
        return result;
    }

private:
    static double sign(int m) { return m % 2 == 0 ? 1 : -1; }
    void forAll(const auto& body) {
        for (int m = 0; m <= degree_; ++m) {
            for (int l = m; l <= degree_; ++l) {
                for (int c = 0; c < 3; ++c)
                    body(l, m, c, coefficients_[c][sharp_alm_index(alm_, l, m)]);
            }
        }
    }

    int degree_, rings_;
    sharp_alm_info* alm_ = nullptr;
    sharp_geom_info* geometry_ = nullptr;
    std::array<std::vector<Complex>, 3> coefficients_;
    std::array<std::vector<double>, 3> maps_;
};

/// sum over rings r and columns i of weight_r L_ri conj Y_lm(theta_r, 2 pi i / columns): the
/// library's analysis of rows as it stands, with the weight over sin theta in place of the area of
/// a row and nothing for the width of a pixel.
Harmonics analyseSamples(const Image& weighted, int degree, int threads) {
    const int h = weighted.height, w = weighted.width;
    const RowSpectrum rows =
        analyseRows(weighted, 1, std::numeric_limits<double>::infinity(), degree, threads);
    const int count = ringsFor(degree);
    const RingPairs rings = makeRings(count);
    ThetaResample plan = makeThetaResample(h, count, degree + 1, RingSource::pixel_rows);
    for (Complex& factor : plan.factors)
        factor *= 1 / (2.0 * h * std::abs(factor)); // without the row's height
    Harmonics f(degree);
    parallelFor(degree / kColumnsAtOnce + 1, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kColumnsAtOnce;
        const int orders = std::min(kColumnsAtOnce, degree + 1 - first);
        LaneVector<double> columns(static_cast<std::size_t>(kColumnsAtOnce) * kParts * count);
        thetaResample(plan, rows.values.data() + first * kParts * kLanes,
                      columnsTogether(degree + 1), orders, columns.data(), columnsApart(count));
        legendreAnalysis(rings, columns.data(), first, orders, f);
        for (int m = first; m < first + orders; ++m) {
            const double x = kPi * m / w; // the pixel's width and half-pixel phase, taken back
            const Complex back = std::polar((m == 0 ? 1 : x / std::sin(x)) * w / (2 * kPi), x);
            for (int l = m; l <= degree; ++l) {
                for (int c = 0; c < 6; c += 2) {
                    const Complex value = Complex(f.at(l, m)[c], f.at(l, m)[c + 1]) * back;
                    f.at(l, m)[c] = value.real();
                    f.at(l, m)[c + 1] = value.imag();
                }
            }
        }
    });
    return f;
}

/// The samples times weight_r h / (pi sin theta_r), as three images of floats that sum to them.
std::array<Image, 3> weightedImages(const std::vector<double>& map,
                                    const std::vector<double>& weights) {
    const int h = static_cast<int>(weights.size()), w = 2 * h;
    std::array<Image, 3> images{Image(w, h), Image(w, h), Image(w, h)};
    const std::size_t plane = map.size() / 3;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const std::size_t ring = i % plane / static_cast<std::size_t>(w);
        const std::size_t pixel = 3 * (i % plane) + i / plane;
        const double sine = std::sin(kPi * (static_cast<double>(ring) + 0.5) / h);
        double rest = map[i] * weights[ring] * h / (kPi * sine);
        for (Image& image : images) {
            image.pixels[pixel] = static_cast<float>(rest);
            rest -= image.pixels[pixel];
        }
    }
    return images;
}

/// Our round trip: the analysis is linear, so that of the sum is the sum of those of the parts.
Harmonics analyseParts(const std::array<Image, 3>& images, int degree, int threads) {
    Harmonics sum(degree);
    for (const Image& image : images) {
        const Harmonics f = analyseSamples(image, degree, threads);
        for (std::size_t i = 0; i < f.coefficients.size(); ++i) {
            for (int part = 0; part < kParts; ++part)
                sum.coefficients[i][part] += f.coefficients[i][part];
        }
    }
    return sum;
}

/// OpenMP's threads keep their cores busy for some milliseconds after libsharp has returned.
void letThreadsSleep() {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
}

void report(benchmark::State& state, const Seconds& ours, const Seconds& sharp) {
    state.counters["ours_ms"] = 1e3 * median(ours.wall);
    state.counters["sharp_ms"] = 1e3 * median(sharp.wall);
    state.counters["ratio"] = median(sharp.wall) / median(ours.wall);
    state.counters["cpu_ratio"] = median(sharp.cpu) / median(ours.cpu);
}

void synthesis(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
    const int rings = 2 * (degree + 1);
    const Harmonics f = randomHarmonics(degree);
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    Sharp sharp(degree, rings, threads);
    sharp.setHarmonics(f);
    std::vector<double> map(static_cast<std::size_t>(6) * rings * rings);
    Seconds ours_s, sharp_s;
    for (auto _ : state) {
        sharp_s.add([&] { sharp.execute(SHARP_Y); });
        letThreadsSleep();
        ours_s.add([&] { synthesiseGrid(f, ones, degree, rings, threads, map.data()); });
        state.SetIterationTime(ours_s.wall.back());
    }
    report(state, ours_s, sharp_s);
    holdError(state, "difference", relativeRms(map, sharp.map()), 1e-12);
}

void analysis(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
    const int rings = 2 * (degree + 1);
    const Harmonics f = randomHarmonics(degree);
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    Sharp sharp(degree, rings, threads);
    std::vector<double> map(static_cast<std::size_t>(6) * rings * rings);
    synthesiseGrid(f, ones, degree, rings, threads, map.data());
    const std::array<Image, 3> images = weightedImages(map, sharp.weights());
    sharp.setMap(map);
    Seconds ours_s, sharp_s;
    for (auto _ : state) {
        sharp_s.add([&] { sharp.execute(SHARP_YtW); });
        letThreadsSleep();
        ours_s.add([&] { benchmark::DoNotOptimize(analyseSamples(images[0], degree, threads)); });
        state.SetIterationTime(ours_s.wall.back());
    }
    report(state, ours_s, sharp_s);
    const std::vector<double> ours = flat(analyseParts(images, degree, threads));
    const std::vector<double> same_map = flat(sharp.harmonics());
    holdError(state, "difference", relativeRms(ours, same_map), 1e-13);
    sharp.setHarmonics(f);
    sharp.execute(SHARP_Y);
    sharp.execute(SHARP_YtW);
    const double sharp_error = relativeRms(flat(sharp.harmonics()), flat(f));
    state.counters["sharp_error"] = sharp_error;
    holdError(state, "error", relativeRms(ours, flat(f)), std::max(3 * sharp_error, 3e-15));
}

void arguments(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgsProduct({{255, 511, 1023}, {1, 2}})
        ->ArgNames({"degree", "threads"})
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}
BENCHMARK(synthesis)->Apply(arguments);
BENCHMARK(analysis)->Apply(arguments);

} // namespace

int main(int argc, char** argv) {
    return ibl::runBenchmarks(argc, argv);
}
