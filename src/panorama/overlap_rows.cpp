#include "panorama/overlap_rows.h"

#include <algorithm>
#include <numeric>

namespace ibl {

CubeLatlongRows byRows(const CubeLatlongOverlaps& overlaps) {
    const auto turned = [](const OctantTable& table) {
        OctantRows rows;
        for (const std::vector<OctantOverlap>& cells : table.overlaps) {
            for (const OctantOverlap& part : cells) {
                if (part.row + 2 > static_cast<int>(rows.begin.size()))
                    rows.begin.resize(part.row + 2, 0);
                ++rows.begin[part.row + 1];
            }
        }
        std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
        if (rows.begin.empty()) return rows;
        rows.overlaps.resize(rows.begin.back());
        std::vector<int> next = rows.begin;
        for (int a = 0; a < static_cast<int>(table.overlaps.size()); ++a) {
            for (int b = 0; b + 1 < static_cast<int>(table.begin[a].size()); ++b) {
                for (int k = table.begin[a][b]; k < table.begin[a][b + 1]; ++k) {
                    const OctantOverlap& part = table.overlaps[a][k];
                    rows.overlaps[next[part.row]++] = {a,         b,           part.column,
                                                       part.area, part.across, part.away};
                }
            }
        }
        return rows;
    };
    CubeLatlongRows rows;
    std::ranges::transform(overlaps.side, rows.side.begin(), turned);
    std::ranges::transform(overlaps.pole, rows.pole.begin(), turned);
    return rows;
}

} // namespace ibl
