// Fourier transforms of any length, kLanes at a time.
#pragma once

#include "convolve/simd.h"

#include <complex>
#include <vector>

namespace ibl {

/// What a transform of length n needs: factors and roots of unity, and for lengths with a prime
/// factor above 61 Bluestein's convolution of a power-of-two length (Bluestein 1970).
struct FftPlan {
    int length = 1;
    std::vector<int> factors;
    std::vector<std::complex<double>> roots;          ///< exp(-2 pi i k / length)
    std::vector<std::complex<double>> chirp;          ///< exp(-i pi k^2 / length), Bluestein only
    std::vector<std::complex<double>> chirp_spectrum; ///< of the padded conjugate chirp, / padded
    std::vector<FftPlan> padded;                      ///< one plan, Bluestein only
};

FftPlan makeFftPlan(int length);

/// Number of ComplexLanes of workspace that `fft` needs besides its data.
std::size_t fftWorkspace(const FftPlan& plan);

/// Transforms, in place, kLanes interleaved sequences: X_k = sum_j x_j exp(-2 pi i j k / n). Not
/// normalised. (The inverse is the same with re and im swapped before and after.)
void fft(const FftPlan& plan, ComplexLanes* data, ComplexLanes* workspace);

/// The same where only the X_k with |k| <= `most` are wanted: the inputs i = q + Q p of each q are
/// transformed by themselves, Y_q, and X_k = sum_q exp(-2 pi i k q / n) Y_q[k mod P], n = P Q. The
/// cost grows as the length, not as its logarithm, and each transform is small.
struct PrunedFft {
    int length = 1;
    int most = 0;
    int split = 1;                           ///< Q, a power of two
    int shift = 0;                           ///< its logarithm
    FftPlan part;                            ///< of length P
    std::vector<std::complex<double>> roots; ///< exp(-2 pi i k / length)

    /// Where input i stands.
    std::size_t slot(int i) const {
        return static_cast<std::size_t>(i & (split - 1)) * part.length + (i >> shift);
    }
};

PrunedFft makePrunedFft(int length, int most);

/// `data` holds the inputs, each at its slot, and is overwritten; X_k goes to out[k + most].
/// `workspace` has fftWorkspace(plan.part) elements.
void prunedFft(const PrunedFft& plan, ComplexLanes* data, ComplexLanes* workspace,
               ComplexLanes* out);

/// The smallest length >= n with no prime factor above 5.
int goodFftLength(int n);

} // namespace ibl
