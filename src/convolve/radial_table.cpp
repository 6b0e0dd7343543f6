#include "convolve/radial_table.h"

namespace ibl {

RadialTable::RadialTable(const std::function<double(double x)>& function, double least, double most,
                         Beyond beyond, int part_bits)
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
    double at_from = function(edge(first_));
    for (std::int64_t at = first_; edge(at) < most; ++at) {
        const double from = edge(at), to = edge(at + 1);
        const double f[4] = {at_from, function(from + (to - from) / 3),
                             function(from + (to - from) * 2 / 3), function(to)};
        // Through t = 0, 1/3, 2/3, 1, by differences.
        const double d1 = f[1] - f[0], d2 = f[2] - 2 * f[1] + f[0],
                     d3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
        cubics_.push_back({f[0], 3 * d1 - 1.5 * d2 + d3, 4.5 * (d2 - d3), 4.5 * d3});
        at_from = f[3];
    }
}

} // namespace ibl
