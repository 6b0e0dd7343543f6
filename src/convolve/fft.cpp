#include "convolve/fft.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace ibl {
namespace {

using Complex = std::complex<double>;

constexpr int kLargestDirectPrime = 61;

IBL_INLINE ComplexLanes add(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re + b.re, a.im + b.im};
}
IBL_INLINE ComplexLanes sub(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re - b.re, a.im - b.im};
}
IBL_INLINE ComplexLanes mul(const ComplexLanes& a, const Complex& w) {
    return {a.re * w.real() - a.im * w.imag(), a.re * w.imag() + a.im * w.real()};
}
/// a - i b and a + i b, what remains of a twiddle by a quarter turn.
IBL_INLINE ComplexLanes subI(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re + b.im, a.im - b.re};
}
IBL_INLINE ComplexLanes addI(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re - b.im, a.im + b.re};
}

/// One pass of Stockham's self-sorting transform: `n` is the length still to be done, `s` the
/// product of the factors done. Reads x, writes y:
///
///     y[q + s (p k + j)] = w^(k j) sum_i x[q + s (k + i m)] exp(-2 pi i i j / p),  m = n / p
struct Pass {
    const ComplexLanes* x;
    ComplexLanes* y;
    const Complex* roots; ///< of the whole length, which is n * s
    int n;
    int s;
};

IBL_INLINE void passTwo(const Pass& p) {
    const int m = p.n / 2, s = p.s;
    for (int k = 0; k < m; ++k) {
        const Complex w = p.roots[k * s];
        for (int q = 0; q < s; ++q) {
            const ComplexLanes a = p.x[q + s * k], b = p.x[q + s * (k + m)];
            p.y[q + s * 2 * k] = add(a, b);
            p.y[q + s * (2 * k + 1)] = mul(sub(a, b), w);
        }
    }
}

IBL_INLINE void passFour(const Pass& p) {
    const int m = p.n / 4, s = p.s;
    for (int k = 0; k < m; ++k) {
        const Complex w1 = p.roots[k * s], w2 = p.roots[2 * k * s], w3 = p.roots[3 * k * s];
        for (int q = 0; q < s; ++q) {
            const ComplexLanes *in = p.x + q + s * k, a = in[0], b = in[s * m], c = in[2 * s * m],
                               d = in[3 * s * m];
            const ComplexLanes ac = add(a, c), a_c = sub(a, c), bd = add(b, d), b_d = sub(b, d);
            ComplexLanes* out = p.y + q + s * 4 * k;
            out[0] = add(ac, bd);
            out[s] = mul(subI(a_c, b_d), w1);
            out[2 * s] = mul(sub(ac, bd), w2);
            out[3 * s] = mul(addI(a_c, b_d), w3);
        }
    }
}

/// Any odd factor: inputs i and p - i together, since their roots are conjugate.
IBL_INLINE void passOdd(const Pass& p, int radix) {
    const int m = p.n / radix, s = p.s, length = p.n * p.s, half = radix / 2;
    ComplexLanes even[kLargestDirectPrime / 2 + 1], odd[kLargestDirectPrime / 2 + 1];
    for (int k = 0; k < m; ++k) {
        for (int q = 0; q < s; ++q) {
            const ComplexLanes* in = p.x + q + s * k;
            ComplexLanes* out = p.y + q + s * radix * k;
            ComplexLanes total = in[0];
            for (int i = 1; i <= half; ++i) {
                even[i] = add(in[s * m * i], in[s * m * (radix - i)]);
                odd[i] = sub(in[s * m * i], in[s * m * (radix - i)]);
                total = add(total, even[i]);
            }
            out[0] = total;
            for (int j = 1; j <= half; ++j) {
                ComplexLanes a = in[0], b = {};
                for (int i = 1; i <= half; ++i) {
                    const Complex root = p.roots[length / radix * (i * j % radix)];
                    a = {a.re + even[i].re * root.real(), a.im + even[i].im * root.real()};
                    b = {b.re + odd[i].re * root.imag(), b.im + odd[i].im * root.imag()};
                }
                out[s * j] = mul(addI(a, b), p.roots[k * j * s]);
                out[s * (radix - j)] = mul(subI(a, b), p.roots[k * (radix - j) * s]);
            }
        }
    }
}

IBL_INLINE void stockhamPasses(const FftPlan& plan, ComplexLanes* data, ComplexLanes* workspace) {
    ComplexLanes *x = data, *y = workspace;
    int n = plan.length, s = 1;
    for (const int radix : plan.factors) {
        const Pass pass{x, y, plan.roots.data(), n, s};
        if (radix == 4)
            passFour(pass);
        else if (radix == 2)
            passTwo(pass);
        else if (radix == 3)
            passOdd(pass, 3);
        else if (radix == 5)
            passOdd(pass, 5);
        else if (radix == 7)
            passOdd(pass, 7);
        else if (radix == 11)
            passOdd(pass, 11);
        else if (radix == 13)
            passOdd(pass, 13);
        else
            passOdd(pass, radix);
        n /= radix;
        s *= radix;
        std::swap(x, y);
    }
    if (x != data) std::copy(x, x + plan.length, data);
}

IBL_MULTIVERSION
void stockham(const FftPlan& plan, ComplexLanes* data, ComplexLanes* workspace) {
    stockhamPasses(plan, data, workspace);
}

/// Bluestein: j k = (j^2 + k^2 - (j - k)^2) / 2 makes the transform a convolution with a chirp.
IBL_MULTIVERSION
void bluestein(const FftPlan& plan, ComplexLanes* data, ComplexLanes* workspace) {
    const FftPlan& padded = plan.padded.front();
    ComplexLanes *buffer = workspace, *rest = workspace + padded.length;
    for (int i = 0; i < plan.length; ++i)
        buffer[i] = mul(data[i], plan.chirp[i]);
    std::fill(buffer + plan.length, buffer + padded.length, ComplexLanes{});
    stockhamPasses(padded, buffer, rest);
    for (int i = 0; i < padded.length; ++i) {
        const ComplexLanes product = mul(buffer[i], plan.chirp_spectrum[i]);
        buffer[i] = {product.im, product.re}; // swapped: the inverse
    }
    stockhamPasses(padded, buffer, rest);
    for (int i = 0; i < plan.length; ++i) {
        data[i] = mul(ComplexLanes{buffer[i].im, buffer[i].re}, plan.chirp[i]);
    }
}

std::vector<int> factorsOf(int n) {
    std::vector<int> factors;
    for (; n % 4 == 0; n /= 4)
        factors.push_back(4);
    for (int p = 2; p * p <= n; ++p) {
        for (; n % p == 0; n /= p)
            factors.push_back(p);
    }
    if (n > 1) factors.push_back(n);
    return factors;
}

Complex unitRoot(double turns) {
    return std::polar(1.0, -2 * std::numbers::pi * turns);
}

void addBluestein(FftPlan& plan) {
    const int n = plan.length;
    plan.padded.push_back(makeFftPlan(goodFftLength(2 * n - 1)));
    const int size = plan.padded.front().length;
    plan.chirp.resize(static_cast<std::size_t>(n));
    for (std::int64_t i = 0; i < n; ++i) {
        plan.chirp[i] = unitRoot(0.5 * static_cast<double>(i * i % (2 * n)) / n);
    }
    LaneVector<ComplexLanes> buffer(static_cast<std::size_t>(size)), work(buffer.size());
    for (int i = 0; i < n; ++i) {
        const Lanes re = Lanes{} + plan.chirp[i].real(), im = Lanes{} - plan.chirp[i].imag();
        buffer[i] = {re, im};
        if (i > 0) buffer[size - i] = buffer[i];
    }
    stockham(plan.padded.front(), buffer.data(), work.data());
    plan.chirp_spectrum.resize(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
        plan.chirp_spectrum[i] = Complex(buffer[i].re[0], buffer[i].im[0]) / double(size);
    }
}

IBL_MULTIVERSION
void combine(const PrunedFft& plan, const ComplexLanes* data, ComplexLanes* out) {
    const int n = plan.length, size = plan.part.length;
    const int first = ((-plan.most % n) + n) % n;
    int at = first, slot = first % size;
    for (int k = -plan.most; k <= plan.most; ++k) {
        const ComplexLanes* y = data + slot;
        ComplexLanes sum = *y;
        int root = 0;
        for (int q = 1; q < plan.split; ++q) {
            y += size;
            root += at;
            if (root >= n) root -= n;
            sum = add(sum, mul(*y, plan.roots[root]));
        }
        out[k + plan.most] = sum;
        at = at + 1 < n ? at + 1 : 0;
        slot = slot + 1 < size ? slot + 1 : 0;
    }
}

} // namespace

FftPlan makeFftPlan(int length) {
    FftPlan plan;
    plan.length = length;
    plan.factors = factorsOf(length);
    if (!plan.factors.empty() && *std::ranges::max_element(plan.factors) > kLargestDirectPrime) {
        addBluestein(plan);
        return plan;
    }
    plan.roots.resize(static_cast<std::size_t>(length));
    for (int k = 0; k < length; ++k)
        plan.roots[k] = unitRoot(static_cast<double>(k) / length);
    return plan;
}

std::size_t fftWorkspace(const FftPlan& plan) {
    return plan.padded.empty() ? plan.length : 2 * plan.padded.front().length;
}

void fft(const FftPlan& plan, ComplexLanes* data, ComplexLanes* workspace) {
    if (plan.padded.empty())
        stockham(plan, data, workspace);
    else
        bluestein(plan, data, workspace);
}

PrunedFft makePrunedFft(int length, int most) {
    // Roughly the operations an input, or an output and part.
    constexpr double kFour = 11, kTwo = 7, kOther = 20, kCopy = 4, kProduct = 7;
    PrunedFft plan;
    plan.length = length;
    plan.most = most;
    double best = std::numeric_limits<double>::infinity();
    for (int shift = 0; length % (1 << shift) == 0; ++shift) {
        const std::vector<int> factors = factorsOf(length >> shift);
        double cost = factors.size() % 2 ? kCopy : 0;
        for (const int factor : factors)
            cost += factor == 4 ? kFour : factor == 2 ? kTwo : kOther;
        cost = cost * length + kProduct * (1 << shift) * (2.0 * most + 1);
        if (cost >= best) continue;
        best = cost;
        plan.shift = shift;
    }
    plan.split = 1 << plan.shift;
    plan.part = makeFftPlan(length / plan.split);
    for (int k = 0; k < length; ++k)
        plan.roots.push_back(unitRoot(static_cast<double>(k) / length));
    return plan;
}

void prunedFft(const PrunedFft& plan, ComplexLanes* data, ComplexLanes* workspace,
               ComplexLanes* out) {
    for (int q = 0; q < plan.split; ++q)
        fft(plan.part, data + static_cast<std::ptrdiff_t>(q) * plan.part.length, workspace);
    combine(plan, data, out);
}

int goodFftLength(int n) {
    for (;; ++n) {
        int rest = n;
        for (const int p : {2, 3, 5}) {
            while (rest % p == 0)
                rest /= p;
        }
        if (rest == 1) return n;
    }
}

} // namespace ibl
