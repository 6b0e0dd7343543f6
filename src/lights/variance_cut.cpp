#include "lights/cut_tree.h"
#include "lights/cutting.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace ibl {
namespace {

struct BestCut {
    double larger; ///< variance of the two parts
    std::pair<PixelRegion, PixelRegion> parts;
};

/// The cut across one side that makes the larger variance least. The first part's variance grows
/// with the cut and the second's shrinks, so that the place lies where they cross.
BestCut bestCut(const MomentTable& table, const PixelRegion& r, bool longitude) {
    const auto parts = [&](int first) { return cutAt(table.width(), r, longitude, first); };
    int low = 1, high = (longitude ? r.width : r.height) - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        const auto [a, b] = parts(middle);
        if (table.variance(a) >= table.variance(b))
            high = middle;
        else
            low = middle + 1;
    }
    const auto at = [&](int first) {
        const auto cut = parts(first);
        return BestCut{std::max(table.variance(cut.first), table.variance(cut.second)), cut};
    };
    const BestCut here = at(low);
    if (low == 1) return here;
    const BestCut before = at(low - 1);
    return before.larger <= here.larger ? before : here;
}

std::pair<PixelRegion, PixelRegion> cutRegion(const MomentTable& table, const PixelRegion& r) {
    if (r.width == 1) return bestCut(table, r, false).parts;
    const BestCut across = bestCut(table, r, true);
    if (r.height == 1) return across.parts;
    const BestCut down = bestCut(table, r, false);
    return across.larger <= down.larger ? across.parts : down.parts;
}

/// Which region is cut next. Moving energy W by s changes the irradiance by W s to first order, but
/// at the centroid luminance has no such term, and what is left falls faster with s, while what the
/// channels differ falls slower with the count. By measurement W s^(2/3), s^2 the variance over W,
/// does best over ten probes and 4 to 4096 lights: W s is 2 % worse and W s^2, the variance
/// itself, a tenth (geometric means).
double priority(const MomentTable& table, const PixelRegion& r) {
    const double energy = static_cast<double>(table.energy(r));
    return std::cbrt(energy * energy * table.variance(r));
}

} // namespace

CutTree varianceCut(const MomentTable& table, int count) {
    CutTree tree;
    tree.nodes.push_back({openingColumn(table), 0, table.width(), table.height()});
    std::priority_queue<std::pair<double, int>> waiting; // priority, minus the node
    int lit = 0;
    const auto add = [&](int node) {
        const PixelRegion& r = tree.nodes[node];
        if (table.energy(r) <= 0) return;
        ++lit;
        if (r.width > 1 || r.height > 1) waiting.emplace(priority(table, r), -node);
    };
    add(0);
    while (lit < count && !waiting.empty()) {
        const int node = -waiting.top().second;
        waiting.pop();
        const auto [first, second] = cutRegion(table, tree.nodes[node]);
        tree.cut.push_back(node);
        tree.nodes.push_back(first);
        tree.nodes.push_back(second);
        --lit;
        add(static_cast<int>(tree.nodes.size()) - 2);
        add(static_cast<int>(tree.nodes.size()) - 1);
    }
    return tree;
}

} // namespace ibl
