#include "cli/frame_range.h"

#include "core/error.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace ibl {
namespace {

constexpr int kLastFrame = 9999999;

/// The length of `%d` or `%0Nd`, N from 1 to 9, that begins at `at`, and N; or 0.
std::size_t placeLength(const std::string& name, std::size_t at, int& digits) {
    digits = 1;
    if (name.compare(at, 2, "%d") == 0) return 2;
    const bool padded = at + 3 < name.size() && name[at] == '%' && name[at + 1] == '0' &&
                        name[at + 2] >= '1' && name[at + 2] <= '9' && name[at + 3] == 'd';
    if (!padded) return 0;
    digits = name[at + 2] - '0';
    return 4;
}

} // namespace

bool hasFrameNumber(const std::string& name) {
    int digits = 0;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name.compare(i, 2, "%%") == 0) {
            ++i;
        } else if (placeLength(name, i, digits) > 0) {
            return true;
        }
    }
    return false;
}

std::string nameOfFrame(const std::string& name, const FrameRange& range, const FramePlace& place) {
    if (!range.told) return name;
    std::string result;
    for (std::size_t i = 0; i < name.size();) {
        int digits = 0;
        if (name.compare(i, 2, "%%") == 0) {
            result += '%';
            i += 2;
        } else if (const std::size_t length = placeLength(name, i, digits)) {
            char number[16];
            std::snprintf(number, sizeof number, "%0*d", digits, place.number);
            result += number;
            i += length;
        } else {
            result += name[i++];
        }
    }
    return result;
}

double Ramp::at(const FramePlace& place) const {
    if (place.index == 0) return from;
    if (place.index == place.count - 1) return to;
    return from + (to - from) * place.index / (place.count - 1);
}

std::optional<Ramp> rampFrom(const std::string& text) {
    const auto number = [](const char* begin, const char* end) -> std::optional<double> {
        if (begin != end && *begin == '+') ++begin;
        double value = 0;
        const auto [last, problem] = std::from_chars(begin, end, value);
        if (problem != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
        return value;
    };
    const char* begin = text.data();
    const char* end = begin + text.size();
    const std::size_t dots = text.find("..");
    if (dots == text.npos) {
        const auto value = number(begin, end);
        return value ? std::optional(Ramp(*value)) : std::nullopt;
    }
    const auto from = number(begin, begin + dots), to = number(begin + dots + 2, end);
    return from && to ? std::optional(Ramp(*from, *to)) : std::nullopt;
}

CLI::Validator rampIn(double least, double most) {
    return CLI::Validator(
        [least, most](const std::string& text) {
            const std::optional<Ramp> ramp = rampFrom(text);
            const auto fits = [&](double v) { return v >= least && v <= most; };
            if (ramp && fits(ramp->from) && fits(ramp->to)) return std::string();
            char range[64];
            if (least == std::numeric_limits<double>::min()) {
                std::snprintf(range, sizeof range, "above 0 and to %g", most);
            } else {
                std::snprintf(range, sizeof range, "from %g to %g", least, most);
            }
            return "'" + text + "' is neither a number nor a range FROM..TO of numbers " + range;
        },
        "");
}

CLI::Option* addRamps(CLI::App& app, const std::string& name, int count,
                      std::function<void(const std::vector<Ramp>&)> take, const std::string& help,
                      const CLI::Validator& check, FrameRange& range) {
    return app
        .add_option_function<std::vector<std::string>>(
            name,
            [name, take = std::move(take), &range](const std::vector<std::string>& texts) {
                std::vector<Ramp> ramps;
                for (const std::string& text : texts) {
                    ramps.push_back(*rampFrom(text));
                    if (text.find("..") != text.npos) range.moving = name;
                }
                take(ramps);
            },
            help)
        ->delimiter(',')
        ->expected(count)
        ->check(check);
}

CLI::Option* addRamp(CLI::App& app, const std::string& name, Ramp& ramp, const std::string& help,
                     const CLI::Validator& check, FrameRange& range) {
    return addRamps(
        app, name, 1, [&ramp](const std::vector<Ramp>& given) { ramp = given[0]; }, help, check,
        range);
}

void requireFrames(const FrameRange& range, const std::string& output) {
    if (!range.told && !range.moving.empty()) {
        throw Error(ExitCode::usage, range.moving + ": a range FROM..TO is of --frames; give a "
                                                    "number, or frames");
    }
    if (range.told && !hasFrameNumber(output)) {
        throw Error(ExitCode::usage, output + ": frames need names of their own; write %04d where "
                                              "the frame's number shall stand");
    }
    if (!range.told && hasFrameNumber(output)) {
        throw Error(ExitCode::usage, output + ": which frame is not said; give --frames A-B");
    }
}

void bindFrames(CLI::App& app, FrameRange& range) {
    app.add_option_function<std::string>(
           "--frames",
           [&range](const std::string& text) {
               const char* end = text.data() + text.size();
               const auto [dash, first] = std::from_chars(text.data(), end, range.first);
               bool fits = first == std::errc() && dash != end && *dash == '-';
               if (fits) {
                   const auto [last, second] = std::from_chars(dash + 1, end, range.last);
                   fits = second == std::errc() && last == end;
               }
               if (!fits || range.first < 0 || range.last < range.first ||
                   range.last > kLastFrame) {
                   throw CLI::ValidationError("--frames",
                                              "'" + text + "' is not FIRST-LAST, such as 1-24");
               }
               range.told = true;
           },
           "Draw these frames in turn: numbers may be ranges FROM..TO, linear from the first frame "
           "to "
           "the last, and %04d in names is the frame")
        ->type_name("A-B")
        ->group("Frames");
}

} // namespace ibl
