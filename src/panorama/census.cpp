#include "panorama/census.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

namespace ibl {
namespace {

constexpr V3d kLuminance(0.2125, 0.7154, 0.0721);

struct RowCensus {
    BadPixels nan, infinite, negative;
    V3d min{std::numeric_limits<double>::infinity()};
    V3d max{-std::numeric_limits<double>::infinity()};
    V3d energy{0, 0, 0};
    V3d solid_angle{0, 0, 0}; ///< of what is finite
    double brightest = -std::numeric_limits<double>::infinity();
    int brightest_x = 0;
};

/// `worse` says whether a value goes beyond the extreme so far.
template <class Worse>
void note(BadPixels& bad, bool is_new, int x, int y, float value, Worse worse) {
    const V2i at(x, y);
    if (bad.count == 0) bad = {0, at, value, at};
    if (is_new) ++bad.count;
    if (worse(value, bad.extreme)) {
        bad.extreme = value;
        bad.extreme_at = at;
    }
}

void seekBrightest(RowCensus& row, const float* pixel, int x) {
    const double luminance = V3d(pixel[0], pixel[1], pixel[2]).dot(kLuminance);
    if (luminance > row.brightest) {
        row.brightest = luminance;
        row.brightest_x = x;
    }
}

void countPixel(RowCensus& row, const float* pixel, int x, int y, double solid_angle) {
    bool nan = false, infinite = false, negative = false;
    for (int c = 0; c < 3; ++c) {
        const float value = pixel[c];
        if (std::isnan(value)) {
            note(row.nan, !nan, x, y, value, [](float, float) { return false; });
            nan = true;
        } else if (std::isinf(value)) {
            note(row.infinite, !infinite, x, y, value, [](float, float) { return false; });
            infinite = true;
        } else {
            if (value < 0) {
                note(row.negative, !negative, x, y, value, std::less<float>());
                negative = true;
            }
            row.min[c] = std::min(row.min[c], static_cast<double>(value));
            row.max[c] = std::max(row.max[c], static_cast<double>(value));
            row.energy[c] += value * solid_angle;
            row.solid_angle[c] += solid_angle;
        }
    }
    if (!nan && !infinite) seekBrightest(row, pixel, x);
}

/// The census of `width` pixels of one solid angle, if none is bad: four pixels side by side, so
/// that the compiler can use vectors. Returns false, having done nothing, where some value is
/// negative or not finite.
bool countCleanRow(RowCensus& row, const float* pixels, int width, double solid_angle) {
    constexpr int kValues = 12;
    std::array<float, kValues> least, most;
    std::array<double, kValues> sum{};
    least.fill(std::numeric_limits<float>::infinity());
    most.fill(-std::numeric_limits<float>::infinity());
    const auto take = [&](const float* values, int count) {
        for (int k = 0; k < count; ++k) {
            least[k] = values[k] < least[k] ? values[k] : least[k];
            most[k] = values[k] > most[k] ? values[k] : most[k];
            sum[k] += values[k];
        }
    };
    int i = 0;
    for (; i + kValues <= 3 * width; i += kValues)
        take(pixels + i, kValues);
    take(pixels + i, 3 * width - i);
    for (int k = 0; k < kValues; ++k) {
        // A sum of floats stays finite as a double.
        if (!(least[k] >= 0) || !std::isfinite(sum[k])) return false;
    }
    for (int k = 0; k < kValues; ++k) {
        row.min[k % 3] = std::min(row.min[k % 3], static_cast<double>(least[k]));
        row.max[k % 3] = std::max(row.max[k % 3], static_cast<double>(most[k]));
        row.energy[k % 3] += sum[k] * solid_angle;
    }
    row.solid_angle += V3d(width * solid_angle);
    for (int x = 0; x < width; ++x) {
        const float* p = pixels + 3 * x;
        // Luminance is a mean of the channels. It is seldom worked out.
        if (std::max({p[0], p[1], p[2]}) < 0.999999 * row.brightest) continue;
        seekBrightest(row, p, x);
    }
    return true;
}

void merge(BadPixels& total, const BadPixels& row, bool lower) {
    if (row.count == 0) return;
    if (total.count == 0) {
        total = row;
        return;
    }
    total.count += row.count;
    if (lower && row.extreme < total.extreme) {
        total.extreme = row.extreme;
        total.extreme_at = row.extreme_at;
    }
}

bool valid(float value) {
    return std::isfinite(value) && value >= 0;
}

/// The eight neighbours of a pixel within its face, or around the seam of a lat-long.
template <class Use>
void forEachNeighbour(const Panorama& p, int x, int y, Use&& use) {
    const int width = p.image.width, height = p.image.height;
    const bool latlong = p.layout == Layout::latlong || p.layout == Layout::exrLatlong;
    const int edge = latlong ? 0 : *layoutSize(p.layout, width, height);
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            int nx = x + dx;
            const int ny = y + dy;
            if (latlong) nx = (nx + width) % width;
            if ((nx == x && ny == y) || nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
            if (!latlong && (nx / edge != x / edge || ny / edge != y / edge)) continue;
            use(nx, ny);
        }
    }
}

/// Mends one channel. Returns the pixels it has touched.
class ChannelRepair {
public:
    ChannelRepair(Panorama& panorama, int channel) : panorama_(panorama), channel_(channel) {}

    void run(std::string_view subject, std::vector<char>& touched) {
        const std::size_t pixels = static_cast<std::size_t>(panorama_.image.width) *
                                   static_cast<std::size_t>(panorama_.image.height);
        bool any_bad = false, any_valid = false;
        for (std::size_t i = 0; i < pixels; ++i) {
            float& value = at(i);
            if (std::isfinite(value) && value < 0) {
                value = 0;
                touched[i] = 1;
            }
            if (valid(value)) {
                any_valid = true;
            } else {
                any_bad = true;
                touched[i] = 1;
            }
        }
        if (!any_bad) return;
        if (!any_valid) {
            throw inputError(subject, "no pixel holds a valid value to mend the others from; "
                                      "use another image");
        }
        mendFromRim(pixels);
    }

private:
    float& at(std::size_t i) {
        return panorama_.image.pixels[i * 3 + static_cast<std::size_t>(channel_)];
    }

    /// Rim after rim of a patch: a rim takes its values from what was valid before it.
    void mendFromRim(std::size_t pixels) {
        const auto width = static_cast<std::size_t>(panorama_.image.width);
        std::vector<char> queued(pixels, 0);
        std::vector<std::size_t> rim;
        double sum = 0;
        long count = 0;
        for (std::size_t i = 0; i < pixels; ++i) {
            if (!valid(at(i))) continue;
            sum += at(i);
            ++count;
        }
        for (std::size_t i = 0; i < pixels; ++i) {
            if (valid(at(i))) continue;
            bool at_rim = false;
            neighbours(i, width, [&](std::size_t n) { at_rim |= valid(at(n)); });
            if (!at_rim) continue;
            rim.push_back(i);
            queued[i] = 1;
        }
        while (!rim.empty()) {
            std::vector<float> mended(rim.size());
            for (std::size_t k = 0; k < rim.size(); ++k)
                mended[k] = fromNeighbours(rim[k], width);
            std::vector<std::size_t> next;
            for (std::size_t k = 0; k < rim.size(); ++k)
                at(rim[k]) = mended[k];
            for (std::size_t i : rim) {
                neighbours(i, width, [&](std::size_t n) {
                    if (valid(at(n)) || queued[n]) return;
                    queued[n] = 1;
                    next.push_back(n);
                });
            }
            rim = std::move(next);
        }
        for (std::size_t i = 0; i < pixels; ++i) {
            if (!valid(at(i))) at(i) = static_cast<float>(sum / static_cast<double>(count));
        }
    }

    float fromNeighbours(std::size_t i, std::size_t width) {
        float largest = 0;
        double sum = 0;
        int count = 0;
        neighbours(i, width, [&](std::size_t n) {
            if (!valid(at(n))) return;
            largest = std::max(largest, at(n));
            sum += at(n);
            ++count;
        });
        return at(i) > 0 ? largest : static_cast<float>(sum / count); // a NaN is not above 0
    }

    template <class Use>
    void neighbours(std::size_t i, std::size_t width, Use&& use) {
        forEachNeighbour(panorama_, static_cast<int>(i % width), static_cast<int>(i / width),
                         [&](int x, int y) {
                             use(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x));
                         });
    }

    Panorama& panorama_;
    int channel_;
};

} // namespace

Census takeCensus(const Panorama& panorama, int threads) {
    const Image& image = panorama.image;
    std::vector<RowCensus> rows(static_cast<std::size_t>(image.height));
    parallelFor(rows.size(), threads, [&](std::size_t r) {
        const int y = static_cast<int>(r);
        const auto solidAngle = [&](int x) {
            return texelSolidAngle(panorama.layout, image.width, image.height, x, y);
        };
        const bool of_one_size = panorama.layout == Layout::latlong;
        double solid_angle = solidAngle(0);
        if (of_one_size && countCleanRow(rows[r], image.row(y), image.width, solid_angle)) return;
        for (int x = 0; x < image.width; ++x) {
            if (!of_one_size) solid_angle = solidAngle(x);
            if (solid_angle > 0) countPixel(rows[r], image.at(x, y), x, y, solid_angle);
        }
    });
    Census census;
    RowCensus total;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const RowCensus& row = rows[r];
        merge(census.nan, row.nan, false);
        merge(census.infinite, row.infinite, false);
        merge(census.negative, row.negative, true);
        for (int c = 0; c < 3; ++c) {
            total.min[c] = std::min(total.min[c], row.min[c]);
            total.max[c] = std::max(total.max[c], row.max[c]);
        }
        total.energy += row.energy;
        total.solid_angle += row.solid_angle;
        if (row.brightest > total.brightest) {
            total.brightest = row.brightest;
            census.sun_at = V2i(row.brightest_x, static_cast<int>(r));
        }
    }
    for (int c = 0; c < 3; ++c) {
        if (total.min[c] > total.max[c]) continue; // nothing finite
        census.min[c] = total.min[c];
        census.max[c] = total.max[c];
        census.mean[c] = total.energy[c] / total.solid_angle[c];
    }
    census.energy = total.energy;
    if (std::isfinite(total.brightest)) {
        const float* sun = image.at(census.sun_at.x, census.sun_at.y);
        census.sun_radiance = V3d(sun[0], sun[1], sun[2]);
        census.sun_direction = *texelDirection(panorama.layout, image.width, image.height,
                                               census.sun_at.x + 0.5, census.sun_at.y + 0.5);
    }
    return census;
}

bool surelyValid(const Image& image, int threads) {
    std::atomic<bool> valid{true};
    parallelForRuns(image.pixels.size(), std::size_t{1} << 16, threads,
                    [&](std::size_t begin, std::size_t end) {
                        // A float that is finite and not negative has bits below those of infinity,
                        // 0xff << 23. Others have the sign bit, or get it when 1 << 23 is added.
                        std::uint32_t bits = 0;
                        for (std::size_t i = begin; i < end; ++i) {
                            const auto value = std::bit_cast<std::uint32_t>(image.pixels[i]);
                            bits |= value | (value + (1u << 23));
                        }
                        if (bits >> 31) valid = false;
                    });
    return valid;
}

long repair(std::string_view subject, Panorama& panorama) {
    std::vector<char> touched(panorama.image.pixels.size() / 3, 0);
    for (int channel = 0; channel < 3; ++channel) {
        ChannelRepair(panorama, channel).run(subject, touched);
    }
    return std::count(touched.begin(), touched.end(), char(1));
}

} // namespace ibl
