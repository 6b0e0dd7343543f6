// Every layout of the table can be synthesised onto.
#include "convolve/prefilter.h"

#include "panorama/layouts.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ibl {
namespace {

TEST(PrefilterLayouts, FurnaceIsOneInEveryLayout) {
    Image probe(32, 16);
    std::fill(probe.pixels.begin(), probe.pixels.end(), 0.7f);
    for (const std::string& name : layoutNames()) {
        const Layout layout = *layoutFromName(name);
        for (const Lobe& lobe : {Lobe{Kernel::ggx, 0}, Lobe{Kernel::ggx, 0.3}, Lobe{Kernel::ggx, 1},
                                 Lobe{Kernel::lambert, 0}}) {
            for (int size : {1, 4, 17}) {
                const PrefilterRequest request{lobe, layout, size};
                const auto results = prefilter({Layout::latlong, probe}, {&request, 1}, {});
                const Image& map = results[0].map.image;
                for (int y = 0; y < map.height; ++y) {
                    for (int x = 0; x < map.width; ++x) {
                        const bool seen =
                            texelDirection(layout, map.width, map.height, x + 0.5, y + 0.5)
                                .has_value();
                        ASSERT_NEAR(map.at(x, y)[1], seen ? 0.7f : 0, 0.7e-6)
                            << name << " " << lobe.parameter << " " << size << " at " << x << " "
                            << y;
                    }
                }
            }
        }
    }
}

} // namespace
} // namespace ibl
