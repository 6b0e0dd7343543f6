#include "lights/lit_tree.h"

#include "lights/irradiance_error.h"

#include <algorithm>
#include <utility>

namespace ibl {
namespace {

template <class Table>
LitTree withLit(CutTree&& tree, const Table& table) {
    LitTree result{std::move(tree), {}};
    for (const PixelRegion& r : result.tree.nodes)
        result.is_lit.push_back(table.energy(r) > 0);
    return result;
}

/// Blocks of pixels for the variance cut, as a shift: no more of them than half a million or 32 a
/// light, so that the table does not take longer to fill than a large probe to read.
int varianceShift(const Image& latlong, int count) {
    const long most = std::max(1L << 19, 32L * count);
    int shift = 0;
    while ((long{latlong.width} >> shift) * (latlong.height >> shift) > most)
        ++shift;
    return shift;
}

/// The same for the median cut: of probes of more than a million pixels cuts are along every second
/// one, if that leaves 32 blocks a light. Errors differ either way by a few per cent; the kernel
/// clears a quarter of the memory, which took longer than to fill it.
int medianShift(const Image& latlong, int count) {
    const long pixels = long{latlong.width} * latlong.height;
    return pixels > 1L << 20 && pixels / 4 >= 32L * count ? 1 : 0;
}

/// `cut` on a table of blocks, or of pixels where fewer blocks than `count` are lit.
template <class Table, class Cut>
LitTree cutBlocks(const Image& latlong, int shift, int count, int threads, const Cut& cut) {
    for (;; shift = 0) {
        const Table table(latlong, shift, threads);
        LitTree cuts = withLit(cut(table), table);
        // Few lit blocks may be many lit pixels.
        if (shift > 0 && litCount(cuts) < count) continue;
        for (PixelRegion& node : cuts.tree.nodes)
            node = table.pixels(node);
        return cuts;
    }
}

} // namespace

int litCount(const LitTree& cuts) {
    const std::vector<int> leaves = leavesOf(cuts.tree, cuts.tree.cut.size());
    return static_cast<int>(std::count_if(leaves.begin(), leaves.end(), [&](int node) {
        return cuts.is_lit[static_cast<std::size_t>(node)];
    }));
}

LitTree cutProbe(const Image& latlong, LightMethod method, int count, int threads) {
    if (method == LightMethod::variance) {
        return cutBlocks<MomentTable>(latlong, varianceShift(latlong, count), count, threads,
                                      [&](const auto& table) { return varianceCut(table, count); });
    }
    return cutBlocks<SummedAreaTable>(
        latlong, medianShift(latlong, count), count, threads,
        [&](const auto& table) { return medianCut(table, count, threads); });
}

std::vector<Light> lightsAfter(const LitTree& cuts, const std::vector<RegionSums>& sums,
                               std::size_t count, const Image& latlong, LightPlacement placement) {
    std::vector<RegionSums> leaf_sums;
    std::vector<PixelRegion> regions;
    std::vector<bool> is_lit;
    for (const int node : leavesOf(cuts.tree, count)) {
        const auto n = static_cast<std::size_t>(node);
        leaf_sums.push_back(sums[n]);
        regions.push_back(cuts.tree.nodes[n]);
        is_lit.push_back(cuts.is_lit[n]);
    }
    return lightsOf(leaf_sums, regions, is_lit, latlong.width, latlong.height, placement);
}

std::vector<RegionSums> allSums(const Image& latlong, const CutTree& tree, int threads) {
    const std::vector<int> leaves = leavesOf(tree, tree.cut.size());
    std::vector<PixelRegion> regions;
    for (const int node : leaves)
        regions.push_back(tree.nodes[static_cast<std::size_t>(node)]);
    const std::vector<RegionSums> found = regionSums(latlong, regions, threads);
    std::vector<RegionSums> sums(tree.nodes.size());
    for (std::size_t i = 0; i < leaves.size(); ++i)
        sums[static_cast<std::size_t>(leaves[i])] = found[i];
    for (std::size_t k = tree.cut.size(); k-- > 0;) {
        RegionSums& whole = sums[static_cast<std::size_t>(tree.cut[k])];
        whole += sums[2 * k + 1];
        whole += sums[2 * k + 2];
    }
    return sums;
}

double errorOf(const std::vector<Light>& lights, const LightHarmonics& probe, int threads) {
    LightHarmonics difference = probe;
    difference -= lightHarmonics(lights, probe.degree, threads);
    return irradianceError(probe, difference, lights);
}

} // namespace ibl
