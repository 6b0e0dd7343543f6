// Smooth functions of the distance between two directions, looked up.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace ibl {

/// A function of x, the squared chord between two directions, x = 4 sin^2(t/2) in [0, 4], from
/// cubics on 32 equal parts of every octave of x: no logarithm is taken, a double's leading bits
/// are the index. What is smooth over octaves is met to 1e-8 of its variation over one.
class RadialTable {
public:
    /// Of `function` on [least, most]. Below that it counts as constant, beyond as `outside`, or
    /// where there is none as constant too.
    enum class Beyond { zero, constant };
    RadialTable(const std::function<double(double x)>& function, double least, double most,
                Beyond beyond);

    double operator()(double x) const {
        if (x >= most_) return outside_;
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const auto at = static_cast<std::int64_t>(bits >> kShift) - first_;
        if (at < 0) return inside_;
        constexpr std::uint64_t kMask = (std::uint64_t{1} << kShift) - 1;
        const double t = static_cast<double>(static_cast<std::int64_t>(bits & kMask)) * kUnit;
        const Cubic& c = cubics_[static_cast<std::size_t>(at)];
        return c.k[0] + t * (c.k[1] + t * (c.k[2] + t * c.k[3]));
    }

private:
    static constexpr int kPartBits = 5;
    static constexpr int kShift = 52 - kPartBits;
    static constexpr double kUnit = 1.0 / static_cast<double>(std::int64_t{1} << kShift);

    struct Cubic {
        double k[4];
    };
    std::vector<Cubic> cubics_;
    std::int64_t first_;
    double most_, inside_, outside_;
};

} // namespace ibl
