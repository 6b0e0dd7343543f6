// Numbers as text.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace ibl {

/// Appends the shortest text that reads back as the same double, whatever the locale.
inline void appendNumber(std::string& text, double value) {
    std::array<char, 32> buffer;
    text.append(buffer.data(),
                std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

inline std::string shortestNumber(double value) {
    std::string text;
    appendNumber(text, value);
    return text;
}

} // namespace ibl
