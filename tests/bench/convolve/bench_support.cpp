#include "bench_support.h"

#include <cmath>
#include <string>

namespace ibl {
namespace {

bool& failed() {
    static bool value = false;
    return value;
}

} // namespace

void holdError(benchmark::State& state, const char* name, double error, double limit) {
    state.counters[name] = error;
    if (error <= limit) return;
    failed() = true;
    state.SkipWithError((std::string(name) + " " + std::to_string(error / limit) +
                         " times its limit: accuracy was lost")
                            .c_str());
}

int runBenchmarks(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    const std::size_t run = benchmark::RunSpecifiedBenchmarks();
    return run == 0 || failed() ? 1 : 0;
}

double Uniform::operator()() {
    // Knuth's linear congruence.
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
}

Harmonics randomHarmonics(int degree) {
    Harmonics f(degree);
    Uniform uniform;
    for (int m = 0; m <= degree; ++m) {
        for (int l = m; l <= degree; ++l) {
            for (int part = 0; part < kParts; ++part)
                f.at(l, m)[part] = m == 0 && part % 2 == 1 ? 0 : uniform();
        }
    }
    return f;
}

double relativeRms(const std::vector<double>& a, const std::vector<double>& b) {
    double error = 0, norm = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        error += (a[i] - b[i]) * (a[i] - b[i]);
        norm += b[i] * b[i];
    }
    return std::sqrt(error / norm);
}

} // namespace ibl
