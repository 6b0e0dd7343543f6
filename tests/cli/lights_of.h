// Lights as the tool prints them.
#pragma once

#include "cli/tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ibl {

inline nlohmann::json lightsOf(const std::vector<std::string>& arguments, const Scratch& scratch) {
    std::vector<std::string> words{"lights"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
}

} // namespace ibl
