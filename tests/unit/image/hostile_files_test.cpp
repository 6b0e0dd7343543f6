// Files that are cut off, altered or made up: one clear error or an image, never a crash, a hang or
// much memory. Run under the sanitizers too.
#include "image_files.h"

#include <random>

#include <sys/resource.h>

namespace ibl::test {
namespace {

class HostileFiles : public ImageFiles {
protected:
    /// Small files of the formats that are decoded here, of every kind of coding.
    std::vector<std::string> samples() {
        std::vector<std::string> files;
        Image smooth(24, 12, 4);
        for (std::size_t i = 0; i < smooth.pixels.size(); ++i) {
            smooth.pixels[i] = 0.5F + 0.4F * std::sin(0.05F * static_cast<float>(i));
        }
        for (const std::string compression :
             {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
            WriteOptions options;
            options.compression = compression;
            options.type = PixelType::half;
            files.push_back(path("sample_" + compression + ".exr"));
            writeOne(files.back(), smooth, options);
        }
        for (const char* name : {"sample.hdr", "sample.png"}) {
            files.push_back(path(name));
            writeOne(files.back(), smooth);
        }
        for (const char* name : {"gradient.hdr", "alpha16.png", "grey.png", "window_inside.exr"}) {
            files.push_back(testdata(name));
        }
        return files;
    }

    /// True if it is read, false if it is refused in the right way.
    bool isRead(const std::string& bytes) {
        writeBytes(path("hostile"), bytes);
        try {
            readImage(path("hostile"), {"", true, 1});
            return true;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::input) << e.what();
            EXPECT_TRUE(contains(e.what(), "hostile: ")) << e.what();
            const std::string said = e.what(); // the file's name once, whatever a library adds
            EXPECT_EQ(said.find("hostile"), said.rfind("hostile")) << said;
            return false;
        }
    }
};

TEST_F(HostileFiles, EveryTruncationIsRefused) {
    for (const std::string& file : samples()) {
        const std::string bytes = readBytes(file);
        // What is too short to be told from other formats goes to OpenImageIO; others test that.
        const std::size_t step = 1 + bytes.size() / 500;
        for (std::size_t size = 8; size < bytes.size(); size += step) {
            EXPECT_FALSE(isRead(bytes.substr(0, size))) << file << " " << size;
        }
        EXPECT_FALSE(isRead(bytes.substr(0, bytes.size() - 1))) << file;
    }
}

TEST_F(HostileFiles, WhatIsReadFromATruncatedFileOfManyPartsIsWhole) {
    // The end of such a file holds parts or levels that were not asked for.
    for (const char* name : {"parts.exr", "tiled_mip.exr"}) {
        const std::string bytes = readBytes(testdata(name));
        const Image whole = readImage(testdata(name)).image;
        std::size_t refused = 0;
        for (std::size_t size = 8; size < bytes.size(); size += 5) {
            if (!isRead(bytes.substr(0, size))) {
                ++refused;
                continue;
            }
            ASSERT_EQ(readImage(path("hostile")).image.pixels, whole.pixels) << name << " " << size;
        }
        EXPECT_GT(refused, bytes.size() / 15) << name;
        EXPECT_TRUE(isRead(bytes));
    }
}

TEST_F(HostileFiles, AlteredBytesNeverCrash) {
    std::mt19937 random(1);
    std::vector<std::string> files = samples();
    for (const char* name : {"tiled_mip.exr", "tiled_rip.exr", "parts.exr", "deep.exr"}) {
        files.push_back(testdata(name));
    }
    for (const std::string& file : files) {
        const std::string bytes = readBytes(file);
        for (int round = 0; round < 150; ++round) {
            std::string altered = bytes;
            const std::size_t flips = 1 + random() % 4;
            for (std::size_t f = 0; f < flips; ++f) {
                // Beyond the magic number; most of what matters is in the header.
                const std::size_t span =
                    round % 2 ? std::min<std::size_t>(400, bytes.size()) : bytes.size();
                altered[8 + random() % (span - 8)] = static_cast<char>(random());
            }
            isRead(altered);
        }
    }
    rusage usage = {};
    ::getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss, 1500 * 1024) << "KiB";
}

TEST_F(HostileFiles, AnAttributeLargerThanItsFileTakesNoMemory) {
    std::string bytes("\x76\x2f\x31\x01\x02\0\0\0", 8);
    bytes += std::string("comments\0string\0\xff\xff\xff\x7ftext", 24);
    rusage before = {}, after = {};
    ::getrusage(RUSAGE_SELF, &before);
    EXPECT_FALSE(isRead(bytes));
    ::getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 64 * 1024) << "KiB";
}

TEST_F(HostileFiles, ShortFilesOfEveryFormat) {
    const char* tails[] = {"", "\n", "\n\n", "\n\n-Y 4 +X 4\n"};
    for (const char* tail : tails)
        EXPECT_FALSE(isRead(std::string("#?RADIANCE") + tail));
    EXPECT_FALSE(isRead("\x89PNG\r\n\x1a\n"));
    EXPECT_FALSE(isRead(std::string("\x76\x2f\x31\x01\x02\0\0\0", 8)));
    EXPECT_FALSE(isRead(std::string("\x76\x2f\x31\x01", 4)));
    EXPECT_FALSE(isRead("x"));
    EXPECT_TRUE(contains(errorOf(ExitCode::input, [&] { isRead(""), readImage(path("hostile")); }),
                         "empty"));
}

TEST_F(HostileFiles, TruncatedFilesOfOtherFormatsAreRefused) {
    for (const std::string name : {"gradient.tif", "constant.jpg", "constant.webp", "constant.tga",
                                   "constant.bmp", "constant.ppm"}) {
        const std::string bytes = readBytes(testdata(name));
        for (const std::size_t size : {std::size_t{20}, bytes.size() / 3, bytes.size() * 2 / 3}) {
            EXPECT_FALSE(isRead(bytes.substr(0, size))) << name << " " << size;
        }
    }
}

TEST_F(HostileFiles, NoSuchFileAndFolders) {
    EXPECT_TRUE(
        contains(errorOf(ExitCode::input, [&] { readImage(path("none.exr")); }), "no such"));
    EXPECT_TRUE(contains(errorOf(ExitCode::input, [&] { readImage(folder_.string()); }), "folder"));
    errorOf(ExitCode::input, [&] { readImage(""); });
}

} // namespace
} // namespace ibl::test
