// Smooth functions of the distance between two directions, looked up.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace ibl {

/// A function of x, the squared chord between two directions, x = 4 sin^2(t/2) in [0, 4], from
/// cubics on 2^part_bits equal parts of every octave of x: no logarithm is taken, a double's
/// leading bits are the index. What is smooth over octaves is met by 32 parts to 1e-8 of its
/// variation over one.
class RadialTable {
public:
    /// Of `function` on [least, most]. Below that it counts as constant, beyond as `outside`, or
    /// where there is none as constant too. `threads` make it, for large parts.
    enum class Beyond { zero, constant };
    RadialTable(const std::function<double(double x)>& function, double least, double most,
                Beyond beyond, int part_bits, int threads);

    double operator()(double x) const {
        if (x >= most_) return outside_;
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const auto at = static_cast<std::int64_t>(bits >> shift_) - first_;
        if (at < 0) return inside_;
        const double t = static_cast<double>(static_cast<std::int64_t>(bits & mask_)) * unit_;
        const Cubic& c = cubics_[static_cast<std::size_t>(at)];
        return c.k[0] + t * (c.k[1] + t * (c.k[2] + t * c.k[3]));
    }

private:
    struct Cubic {
        double k[4];
    };
    int shift_;
    std::uint64_t mask_;
    double unit_;
    std::vector<Cubic> cubics_;
    std::int64_t first_;
    double most_, inside_, outside_;
};

} // namespace ibl
