// What the tests of image files share: a folder that goes away, test pixels, comparisons.
#pragma once

#include "core/error.h"
#include "image/image.h"
#include "image/read.h"
#include "image/write.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace ibl::test {

namespace fs = std::filesystem;

/// A new folder for each test, removed after it.
class ImageFiles : public ::testing::Test {
protected:
    ImageFiles() {
        std::string name = (fs::temp_directory_path() / "ibltool-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        folder_ = name;
    }
    ~ImageFiles() override {
        std::error_code error;
        fs::remove_all(folder_, error);
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// All names in the folder, hidden ones too.
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_)) {
            found.push_back(entry.path().filename().string());
        }
        std::sort(found.begin(), found.end());
        return found;
    }

    fs::path folder_;
};

inline std::string testdata(const std::string& name) {
    return std::string(IBLTOOL_SOURCE_DIR "/testdata/") + name;
}

inline std::string readBytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in.good()) << path;
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void writeBytes(const std::string& path, const std::string& bytes) {
    std::ofstream out(path, std::ios::binary);
    out << bytes;
    ASSERT_TRUE(out.good()) << path;
}

/// Values over many magnitudes, from a fixed sequence.
inline Image testPixels(int width, int height, int channels = 3) {
    Image image(width, height, channels);
    std::uint32_t state = 12345;
    for (float& v : image.pixels) {
        state = state * 1664525U + 1013904223U;
        v = std::ldexp(1.0F + static_cast<float>(state >> 9) / 8388608.0F,
                       static_cast<int>(state % 24) - 12);
    }
    return image;
}

/// testdata/gradient.*: see scripts/make-testdata.
inline Image gradientPixels() {
    Image image(32, 16, 3);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 32; ++x) {
            float* p = image.at(x, y);
            p[0] = 4.0F * static_cast<float>(x) / 31;
            p[1] = 0.25F + 1.75F * static_cast<float>(y) / 15;
            p[2] = 0.125F;
        }
    }
    return image;
}

inline void expectNear(const Image& a, const Image& b, float relative, float absolute = 0) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.channels, b.channels);
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        ASSERT_NEAR(a.pixels[i], b.pixels[i], relative * std::abs(b.pixels[i]) + absolute)
            << "value " << i;
    }
}

inline void writeOne(const std::string& path, const Image& image,
                     const WriteOptions& options = {}) {
    OutputSet outputs;
    writeImage(outputs, path, image, options);
    outputs.commit();
}

/// The message of the Error that `body` throws; a failure if it throws none of this code.
template <class Body>
std::string errorOf(ExitCode code, const Body& body) {
    try {
        body();
    } catch (const Error& e) {
        EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
        return e.what();
    }
    ADD_FAILURE() << "no error was thrown";
    return "";
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

inline bool anyContains(const std::vector<std::string>& lines, const std::string& part) {
    for (const std::string& line : lines) {
        if (contains(line, part)) return true;
    }
    return false;
}

/// Runs a program, its output to `text`, and returns its status, 0 for success.
inline int status(const std::string& command, std::string& text) {
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe))
        text.append(buffer, n);
    return ::pclose(pipe);
}

/// The same for a program that has to succeed; returns what it prints.
inline std::string run(const std::string& command) {
    std::string text;
    EXPECT_EQ(status(command, text), 0) << command << "\n" << text;
    return text;
}

} // namespace ibl::test
