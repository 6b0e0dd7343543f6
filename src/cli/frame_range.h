// Sequences of frames: which there are, names with the frame in them, and numbers that move.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ibl {

/// Frames `first` to `last`, both included; or, told none, a single picture without a number.
struct FrameRange {
    int first = 0;
    int last = 0;
    bool told = false;
    std::string moving; ///< an option that was given a range of numbers; "" if none was

    int count() const { return last - first + 1; }
};

/// One of them.
struct FramePlace {
    int number = 0;
    int index = 0; ///< from 0
    int count = 1;
};

/// Whether a name has a place for the frame's number: `%d` or `%04d`.
bool hasFrameNumber(const std::string& name);

/// The name with the number in it; `%%` is a per cent sign. Without a sequence names are as they
/// are.
std::string nameOfFrame(const std::string& name, const FrameRange& range, const FramePlace& place);

/// A number, or one that goes linearly from the first frame to the last.
struct Ramp {
    double from = 0;
    double to = 0;

    Ramp(double value = 0) : from(value), to(value) {}
    Ramp(double first, double last) : from(first), to(last) {}
    bool moves() const { return from != to; }
    /// Exactly `from` at the first frame (and where there is but one) and `to` at the last.
    double at(const FramePlace& place) const;
};

/// `NUMBER` or `FROM..TO`, both finite.
std::optional<Ramp> rampFrom(const std::string& text);

/// What CLI11 checks of a ramp: both ends from `least` to `most`.
CLI::Validator rampIn(double least, double most);

/// An option of that many ramps, separated by commas. `range` learns whether one of them moves.
CLI::Option* addRamps(CLI::App& app, const std::string& name, int count,
                      std::function<void(const std::vector<Ramp>&)> take, const std::string& help,
                      const CLI::Validator& check, FrameRange& range);
/// The same of one.
CLI::Option* addRamp(CLI::App& app, const std::string& name, Ramp& ramp, const std::string& help,
                     const CLI::Validator& check, FrameRange& range);

/// `--frames A-B`.
void bindFrames(CLI::App& app, FrameRange& range);

/// Refuses ranges of numbers without frames, and a sequence, or a single picture, whose output's
/// name does not say so.
void requireFrames(const FrameRange& range, const std::string& output);

} // namespace ibl
