#include "convolve/radial_table.h"

#include "core/parallel.h"

namespace ibl {

RadialTable::RadialTable(const std::function<double(double x)>& function, double least, double most,
                         Beyond beyond, int part_bits, int threads)
    : shift_(52 - part_bits),
      mask_((std::uint64_t{1} << shift_) - 1),
      unit_(1.0 / static_cast<double>(std::int64_t{1} << shift_)),
      first_(static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(least) >> shift_)),
      most_(most),
      inside_(function(least)),
      outside_(beyond == Beyond::zero ? 0 : function(most)) {
    const auto edge = [this](std::int64_t at) {
        return std::bit_cast<double>(static_cast<std::uint64_t>(at) << shift_);
    };
    std::int64_t last = first_;
    while (edge(last) < most)
        ++last;
    cubics_.resize(static_cast<std::size_t>(last - first_));
    constexpr std::size_t kAtOnce = 32;
    parallelForRuns(cubics_.size(), kAtOnce, threads, [&](std::size_t begin, std::size_t end) {
        const auto edgeOf = [&](std::size_t i) {
            return edge(first_ + static_cast<std::int64_t>(i));
        };
        double at_from = function(edgeOf(begin));
        for (std::size_t i = begin; i < end; ++i) {
            const double from = edgeOf(i), to = edgeOf(i + 1);
            const double f[4] = {at_from, function(from + (to - from) / 3),
                                 function(from + (to - from) * 2 / 3), function(to)};
            // Through t = 0, 1/3, 2/3, 1, by differences.
            const double d1 = f[1] - f[0], d2 = f[2] - 2 * f[1] + f[0],
                         d3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
            cubics_[i] = {f[0], 3 * d1 - 1.5 * d2 + d3, 4.5 * (d2 - d3), 4.5 * d3};
            at_from = f[3];
        }
    });
}

} // namespace ibl
