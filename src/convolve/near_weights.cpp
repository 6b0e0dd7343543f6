#include "convolve/near_weights.h"

#include "convolve/cut_texels.h"
#include "convolve/gauss.h"
#include "convolve/near_edges.h"
#include "convolve/near_texel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace ibl {
namespace {

/// Errors are measured, not derived, against the contour integrals of
/// tests/support/contour_oracle.h, with a margin (tests/bench/convolve/narrow_bench.cpp).
constexpr NearRules kRules[] = {
    {3, 2, 0.75, 8e-3, 1e-3, 10, 5e-5},
    {4, 6, 2, 1e-3, 1e-4, 20, 4e-6},
    {12, 24, 8, 5e-4, 1e-4, 30, 1e-6},
};

/// Adds to every near pixel its part of a mass spread evenly over the sphere.
void addEven(const Block& block, double mass) {
    const NearWeights& w = block.weights;
    for (int j = 0; j < w.rows; ++j) {
        const double even =
            mass / (4 * kPi) *
            latlongPixelSolidAngle(block.field.width, block.field.height, w.row + j);
        for (int i = 0; i < w.columns; ++i)
            block.add(j * w.columns + i, even);
    }
}

/// The rows and columns within `reach` of the outline.
void setBlock(const NearField& field, const std::vector<Arc>& outline, const V3d& centre,
              NearWeights& weights) {
    const double reach = field.kernel.reach;
    const double own = std::atan2(centre.y, centre.x);
    double top = kPi, bottom = 0, west = 0, east = 0, turned = 0, last = 0;
    bool first = true;
    for (std::size_t i = 0; i <= outline.size(); ++i) {
        const V3d& d = outline[i % outline.size()].a;
        const double theta = std::atan2(std::hypot(d.x, d.y), d.z);
        double psi = std::atan2(d.y, d.x) - own;
        psi -= 2 * kPi * std::round(psi / (2 * kPi));
        top = std::min(top, theta);
        bottom = std::max(bottom, theta);
        if (!first) turned += std::remainder(psi - last, 2 * kPi);
        first = false;
        last = psi;
        const double sin = std::sin(theta);
        const double width = std::sin(reach) < sin ? std::asin(std::sin(reach) / sin) : kPi;
        west = std::min(west, psi - width);
        east = std::max(east, psi + width);
    }
    if (std::abs(turned) > kPi) (centre.z > 0 ? top : bottom) = centre.z > 0 ? 0 : kPi;
    const double row_step = kPi / field.height, column_step = 2 * kPi / field.width;
    const double from = top - reach, to = bottom + reach;
    weights.row = std::max(0, static_cast<int>(std::floor(from / row_step)));
    weights.rows =
        std::min(field.height, static_cast<int>(std::floor(to / row_step)) + 1) - weights.row;
    weights.column = static_cast<int>(std::floor((own + west) / column_step));
    weights.columns = static_cast<int>(std::floor((own + east) / column_step)) + 1 - weights.column;
    if (from <= 0 || to >= kPi || weights.columns >= field.width) {
        weights.column = static_cast<int>(std::floor(own / column_step)) - field.width / 2;
        weights.columns = field.width;
    }
    weights.weight.assign(static_cast<std::size_t>(weights.rows) * weights.columns, 0.0);
}

/// Gauss points over pixels: those of each row and of each column of a block.
class PixelGrid {
public:
    PixelGrid(const NearField& field, const NearWeights& weights, int n)
        : rule_(gaussRule(n)), row_step_(kPi / field.height) {
        for (int i = 0; i < weights.columns; ++i) {
            for (const double node : rule_.nodes) {
                const double psi = 2 * kPi / field.width * (weights.column + i + 0.5 + 0.5 * node);
                azimuths_.emplace_back(std::cos(psi), std::sin(psi));
            }
            const double middle = 2 * kPi / field.width * (weights.column + i + 0.5);
            middles_.emplace_back(std::cos(middle), std::sin(middle));
        }
    }

    /// Cosine and sine of the middle of a column.
    const V2d& middleOf(int column) const { return middles_[static_cast<std::size_t>(column)]; }

    void setRow(int row) {
        thetas_.clear();
        double total = 0;
        for (std::size_t b = 0; b < rule_.nodes.size(); ++b) {
            const double theta = row_step_ * (row + 0.5 + 0.5 * rule_.nodes[b]);
            thetas_.push_back({std::sin(theta), std::cos(theta), 0});
            thetas_.back().share = 0.5 * rule_.weights[b] * thetas_.back().sine;
            total += thetas_.back().share;
        }
        for (Theta& theta : thetas_)
            theta.share /= total;
    }

    /// The mean of the kernel over the pixel in that column and over the texel's points.
    double meanOf(const RadialTable& value, int column,
                  const std::vector<TexelPoint>& texel) const {
        const std::size_t n = rule_.nodes.size(), first = static_cast<std::size_t>(column) * n;
        double mean = 0;
        for (const Theta& theta : thetas_) {
            for (std::size_t a = 0; a < n; ++a) {
                const V2d u = azimuths_[first + a] * theta.sine;
                const V3d d(u.x, u.y, theta.cosine);
                double sum = 0;
                for (const TexelPoint& x : texel)
                    sum += x.share * value((d - x.at).length2());
                mean += 0.5 * rule_.weights[a] * theta.share * sum;
            }
        }
        return mean;
    }

private:
    struct Theta {
        double sine, cosine, share;
    };
    const GaussRule& rule_;
    double row_step_;
    std::vector<V2d> azimuths_, middles_;
    std::vector<Theta> thetas_;
};

/// What of the kernel's mass lies within a pixel's extent of its horizon does not matter if less.
constexpr double kNoKink = 1e-7;

/// Marks the pixels that are near and sets the weights of the others, by points on the sphere: in
/// a plane the rule's error would be that of the sphere's curvature. `many` gives more points of
/// the texel, for pixels that the kernel's kink at its horizon crosses.
template <class Many>
void addFar(Block& block, const Texel& texel, const Many& many) {
    const NearField& field = block.field;
    NearWeights& w = block.weights;
    block.near.assign(w.weight.size(), 0);
    PixelGrid grid(field, w, 2);
    const double half_height = 0.5 * kPi / field.height;
    const double longest = std::max(kPi / field.height, 2 * kPi / field.width);
    const double before = std::sin(std::max(0.0, 0.25 * kPi - 0.5 * longest));
    std::optional<PixelGrid> fine;
    std::vector<TexelPoint> horizon;
    if (field.kernel.massBeyond(before * before) > kNoKink) {
        fine.emplace(field, w, 4);
        horizon = many();
    }
    for (int j = 0; j < w.rows; ++j) {
        const double middle = 2 * half_height * (w.row + j + 0.5);
        const double sin = std::sin(middle), cos = std::cos(middle);
        const double extent = std::max(2 * half_height, 2 * kPi / field.width * sin);
        const double far = field.rules.far * std::hypot(1.4 * texel.radius, extent);
        const double reach = field.kernel.reach + texel.radius + extent;
        const double area = latlongPixelSolidAngle(field.width, field.height, w.row + j);
        grid.setRow(w.row + j);
        if (fine) fine->setRow(w.row + j);
        for (int i = 0; i < w.columns; ++i) {
            const std::size_t at = static_cast<std::size_t>(j * w.columns + i);
            const V2d u = grid.middleOf(i);
            const double distance = (V3d(sin * u.x, sin * u.y, cos) - texel.centre).length();
            if (distance < far ||
                roomBesideRing(field, distance, texel.radius + 0.5 * extent) < far) {
                block.near[at] = 1;
            } else if (fine && std::abs(distance - std::numbers::sqrt2) < texel.radius + extent) {
                w.weight[at] = area * fine->meanOf(field.value, i, horizon);
            } else if (distance <= reach) {
                w.weight[at] = area * grid.meanOf(field.value, i, texel.four);
            }
        }
    }
}

} // namespace

const NearRules& nearRules(double max_error) {
    for (const NearRules& rules : kRules)
        if (rules.error <= 0.6 * max_error) return rules;
    return kRules[std::size(kRules) - 1];
}

NearField makeNearField(const NearKernel& kernel, const NearRules& rules, int probe_width,
                        int probe_height, int threads) {
    // What ends in a step has a thin ring there.
    const bool is_ring = kernel.lobe().kernel == Kernel::charlie || endsInStep(kernel.lobe());
    const double variation = lobeVariation(kernel.lobe());
    const double m = kernel.mass, reach = kernel.reach;
    const double least = (is_ring ? 1e-2 : 1e-4) * kernel.width; // nothing changes within a ring
    const auto chord2 = [](double t) { return std::pow(2 * std::sin(0.5 * t), 2); };
    const auto beyond = [&](double x) { // of the squared chord
        return x < chord2(reach) ? kernel.massBeyond(0.25 * x) : 0.0;
    };
    // With x = 4 sin^2(t/2), dt / sin t = dx / (2 x (1 - x / 4)). Phi from the outside in.
    const GaussRule& rule = gaussRule(8);
    const auto rise = [&](double from, double to) {
        const double low = std::log(from), half = 0.5 * (std::log(to) - low);
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double x = std::exp(low + half * (1 + rule.nodes[i]));
            sum += rule.weights[i] * beyond(x) / (1 - 0.25 * x);
        }
        return half * sum / (4 * kPi);
    };
    const double step = is_ring ? 0.5 * variation : 0.1; // of log x
    const double outermost = std::min(chord2(reach), 3.999);
    std::vector<double> steps{0.0};
    for (double x = outermost; x > least * least; x *= std::exp(-step))
        steps.push_back(steps.back() + rise(x * std::exp(-step), x));
    const auto phi = [&](double x) {
        if (x >= outermost) return 0.0;
        const double at = std::log(outermost / x) / step;
        const std::size_t i = std::min(static_cast<std::size_t>(at), steps.size() - 1);
        const double node = outermost * std::exp(-step * static_cast<double>(i));
        // Within the innermost, m log.
        return steps[i] +
               (i + 1 < steps.size() ? rise(x, node) : m * std::log(node / x) / (4 * kPi));
    };
    const auto value = [&](double x) { return kernel.value(0.25 * x); };
    const auto psi = [&](double x) { return phi(x) + m / (4 * kPi) * std::log(0.25 * x); };
    // Nothing lies beyond the axis's opposite, where 1 - x / 4 is 0.
    const auto spread = [&](double x) { return beyond(x) / std::max(1e-9, 1 - 0.25 * x); };
    const auto swirl = [&](double x) { return (m - spread(x)) / (2 * kPi * x); };
    const auto outer_swirl = [&](double x) { return -spread(x) / (2 * kPi * x); };
    const int bits = is_ring ? static_cast<int>(std::ceil(std::log2(16 / variation))) : 5;
    // It grows as exp(4 t / variation): exp(-15) of it lies before.
    const double ring_from = 2 * std::sin(0.5 * std::max(0.0, 0.5 * kPi - 3.75 * variation));
    using enum RadialTable::Beyond;
    const double x0 = least * least, x1 = chord2(reach);
    const auto within = [&](double t) { return m - beyond(chord2(t)); };
    const auto at_angle = [&](double t) { return phi(t * t); };
    return {kernel,
            rules,
            RadialTable(value, x0, 4, constant, bits, threads),
            RadialTable(phi, x0, x1, zero, bits, threads),
            RadialTable(psi, x0, 4, constant, bits, threads),
            RadialTable(swirl, x0, 4, constant, bits, threads),
            RadialTable(outer_swirl, x0, x1, zero, bits, threads),
            EdgeTable(within, at_angle, std::min(kernel.width, rules.flat), reach, 6 * rules.flat,
                      rules.nodes),
            is_ring ? ring_from : 0,
            is_ring ? 0.5 * variation : 0,
            probe_width,
            probe_height};
}

NearWeights nearWeights(const NearField& field, const MapExtent& map, int x, int y,
                        const Footprint& of_map) {
    NearWeights weights;
    const Footprint footprint = footprintOfTexel(of_map, map.layout, map.width, x, y);
    const double scale = footprint.scale;
    const Texel texel = texelOf(map, x, y, scale);
    if (texel.outline.empty()) { // the whole sphere in one texel
        weights.area = field.kernel.mass;
        return weights;
    }
    setBlock(field, texel.outline, texel.centre, weights);
    Block block{field, weights, {}};
    addFar(block, texel, [&] { return pointsOf(map, x, y, {scale, scale > 0 ? 6 : 1}); });
    // A ring's mass lies far from the texel, wherever that is.
    const bool leaves_area = scale == 1 && field.ring_room == 0;
    const Flow flow(field, map, x, y, footprint, texel,
                    leaves_area ? Potential::withoutArea : Potential::withArea);
    for (const PixelEdge& f : edgesOfNear(block)) {
        const double carried = flow.across(f.arc);
        block.add(f.before, carried);
        block.add(f.after, -carried);
    }
    if (!leaves_area) addEven(block, field.kernel.mass);
    double sum = 0;
    for (const double w : weights.weight)
        sum += w;
    // Between what is near and what is far the sums are of two kinds.
    if (leaves_area) {
        weights.area = field.kernel.mass - sum;
    } else {
        for (double& w : weights.weight)
            w *= field.kernel.mass / sum;
    }
    return weights;
}

std::vector<double> peakMasses(const NearField& field, const MapExtent& map, int x, int y,
                               const Footprint& of_map, std::span<const Peak> peaks) {
    // Of texels as large as the lobe its mean is smooth over a small pixel, unless it has a ring.
    constexpr double kSmall = 0.1;  // of the lobe's width: 2 x 2 points leave 1e-7
    constexpr double kPiece = 0.08; // of the outline, radians: as an Arc is off by 1e-7
    const double size = std::max(kPi / field.height, 2 * kPi / field.width);
    const bool by_points = field.ring_room == 0 && size < kSmall * field.kernel.width;
    const Footprint footprint = footprintOfTexel(of_map, map.layout, map.width, x, y);
    const Texel texel = texelOf(map, x, y, footprint.scale, by_points ? kPiece : kLongest);
    const Flow flow(field, map, x, y, footprint, texel, Potential::withArea);
    std::vector<double> masses;
    for (const Peak& peak : peaks) {
        const double area = latlongPixelSolidAngle(field.width, field.height, peak.row);
        double mass = field.kernel.mass * area / (4 * kPi);
        if (texel.outline.empty()) { // the whole sphere
        } else if (by_points) {
            const PixelPoints points =
                pixelPoints(field.width, field.height, peak.column, peak.row, 2);
            for (std::size_t i = 0; i < points.weight.size(); ++i) {
                const V3d at(points.x[i], points.y[i], points.z[i]);
                double from_texel = 0;
                for (const Arc& e : texel.outline)
                    from_texel += flowAcross(field, at, e);
                mass += points.weight[i] * from_texel / texel.solid_angle;
            }
        } else {
            for (const Arc& f : pixelOutline(field.width, field.height, peak.column, peak.row))
                mass += flow.across(f);
        }
        masses.push_back(mass);
    }
    return masses;
}

} // namespace ibl
