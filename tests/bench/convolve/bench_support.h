// What the benchmarks share: errors are printed beside times, and one above its limit fails the
// run.
#pragma once

#include "convolve/legendre.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

namespace ibl {

/// Records `error` as a counter of that name. One that is above `limit`, or not a number, is
/// reported as an error, and runBenchmarks returns 1.
void holdError(benchmark::State& state, const char* name, double error, double limit);

/// Google Benchmark's main; 1 when some error was above its limit or an argument is unknown.
int runBenchmarks(int argc, char** argv);

/// Uniform in [-1, 1), the same on every run.
class Uniform {
public:
    double operator()();

private:
    std::uint64_t state_ = 1;
};

/// Coefficients of a real field, uniform in [-1, 1).
Harmonics randomHarmonics(int degree);

/// sqrt(sum (a - b)^2 / sum b^2).
double relativeRms(const std::vector<double>& a, const std::vector<double>& b);

} // namespace ibl
