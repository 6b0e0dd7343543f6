#include "image_files.h"

#include "image/output_set.h"

#include <thread>

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ibl::test {
namespace {

class Outputs : public ImageFiles {
protected:
    std::string refusal(const std::string& target) {
        return errorOf(ExitCode::output, [&] {
            OutputSet outputs;
            outputs.add(target).write("x");
            outputs.commit();
        });
    }
};

TEST_F(Outputs, NothingAppearsBeforeCommitAndAllAfter) {
    writeBytes(path("a"), "old");
    OutputSet outputs;
    outputs.add(path("a")).write("new a");
    outputs.add(path("b")).write("new b");
    EXPECT_EQ(readBytes(path("a")), "old");
    EXPECT_FALSE(fs::exists(path("b")));
    outputs.commit();
    EXPECT_EQ(readBytes(path("a")), "new a");
    EXPECT_EQ(readBytes(path("b")), "new b");
    EXPECT_EQ(names(), (std::vector<std::string>{"a", "b"}));
}

TEST_F(Outputs, NothingIsLeftWithoutCommit) {
    writeBytes(path("a"), "old");
    {
        OutputSet outputs;
        outputs.add(path("a")).write(std::string(1 << 20, 'x'));
        outputs.add(path("b")).write("new b");
    }
    EXPECT_EQ(readBytes(path("a")), "old");
    EXPECT_EQ(names(), std::vector<std::string>{"a"});
}

TEST_F(Outputs, AKilledRunLeavesNothing) {
    const pid_t child = ::fork();
    if (child == 0) {
        OutputSet outputs;
        outputs.add(path("a")).write(std::string(1 << 20, 'x'));
        ::raise(SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_TRUE(names().empty());
}

TEST_F(Outputs, SeeksAndGathersWrites) {
    OutputSet outputs;
    OutputFile& file = outputs.add(path("a"));
    for (int i = 0; i < 100000; ++i)
        file.write("0123456789");
    EXPECT_EQ(file.position(), 1000000U);
    file.seek(3);
    file.write("abc");
    EXPECT_EQ(file.position(), 6U);
    file.write(std::string(400000, 'z'));
    outputs.commit();
    const std::string bytes = readBytes(path("a"));
    EXPECT_EQ(bytes.size(), 1000000U);
    EXPECT_EQ(bytes.substr(0, 8), "012abczz");
    EXPECT_EQ(bytes.substr(400005, 3), "z67");
}

TEST_F(Outputs, RefusesWhatCannotBeWritten) {
    EXPECT_TRUE(contains(refusal(folder_.string()), "is a folder"));
    EXPECT_TRUE(contains(refusal(path("b/")), "is a folder"));
    EXPECT_TRUE(contains(refusal(path("no/b")), "no folder"));
    writeBytes(path("file"), "");
    EXPECT_TRUE(contains(refusal(path("file/b")), "is a file, not a folder"));
    EXPECT_TRUE(contains(refusal(path(std::string(300, 'n'))), "too long"));
    EXPECT_TRUE(contains(refusal(""), "empty"));
    EXPECT_TRUE(contains(refusal("/dev/full"), "full"));
    fs::create_symlink("loop", path("loop"));
    EXPECT_TRUE(contains(refusal(path("loop")), "cannot be written"));
    EXPECT_EQ(names(), (std::vector<std::string>{"file", "loop"}));
}

TEST_F(Outputs, RefusesOneFileTwiceUnderAnyName) {
    fs::create_symlink("a", path("link"));
    const std::string message = errorOf(ExitCode::usage, [&] {
        OutputSet outputs;
        outputs.add(path("a"));
        outputs.add(path("./link"));
    });
    EXPECT_TRUE(contains(message, "twice"));
    OutputSet outputs;
    outputs.add("/dev/null");
    outputs.add("/dev/null").write("x");
    outputs.commit();
}

TEST_F(Outputs, AFullStreamKeepsEveryFileFromAppearing) {
    writeBytes(path("a"), "old");
    errorOf(ExitCode::output, [&] {
        OutputSet outputs;
        outputs.add(path("a")).write("new");
        outputs.add("/dev/full").write("x");
        outputs.commit();
    });
    EXPECT_EQ(readBytes(path("a")), "old");
    EXPECT_EQ(names(), std::vector<std::string>{"a"});
}

TEST_F(Outputs, AFileTooLargeForTheDiskLeavesNothing) {
    // A limit on file size stands in for a full disk: the write fails half way.
    const pid_t child = ::fork();
    if (child == 0) {
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit = {1 << 16, 1 << 16};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        int code = 0;
        try {
            WriteOptions options;
            options.threads = 1; // a forked process has one thread
            writeOne(path("a.hdr"), testPixels(256, 128), options);
        } catch (const Error& e) {
            code = static_cast<int>(e.code());
        }
        ::_exit(code);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 4);
    EXPECT_TRUE(names().empty());
}

TEST_F(Outputs, KeepsPermissionsAndFollowsLinks) {
    writeBytes(path("a"), "old");
    ::chmod(path("a").c_str(), 0640);
    fs::create_symlink("a", path("link"));
    fs::create_symlink("c", path("dangling"));
    const mode_t umask_before = ::umask(027);
    OutputSet outputs;
    outputs.add(path("link")).write("new");
    outputs.add(path("b")).write("b");
    outputs.add(path("dangling")).write("c");
    outputs.commit();
    ::umask(umask_before);
    EXPECT_EQ(readBytes(path("a")), "new");
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(readBytes(path("c")), "c");
    struct stat info = {};
    ::stat(path("a").c_str(), &info);
    EXPECT_EQ(info.st_mode & 0777U, 0640U);
    ::stat(path("b").c_str(), &info);
    EXPECT_EQ(info.st_mode & 0777U, 0640U); // 0666 less the mask
}

TEST_F(Outputs, StreamsReceiveTheirBytesAtCommit) {
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = readBytes(path("pipe")); });
    {
        OutputSet outputs;
        OutputFile& file = outputs.add(path("pipe"));
        file.write("xello");
        file.seek(0);
        file.write("h");
        outputs.commit();
    }
    reader.join();
    EXPECT_EQ(received, "hello");
}

TEST_F(Outputs, StandardOutputUnderAllItsNames) {
    for (const char* name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
        const int saved = ::dup(1);
        const int file = ::open(path("out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, 1);
        ::close(file);
        {
            OutputSet outputs;
            outputs.add(name).write("to stdout");
            outputs.commit();
        }
        ::dup2(saved, 1);
        ::close(saved);
        EXPECT_EQ(readBytes(path("out")), "to stdout") << name;
    }
}

TEST_F(Outputs, CommitWaitsForItsTurn) {
    const int lock = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    OutputSet outputs;
    outputs.add(path("a")).write("a");
    std::thread writer([&] { outputs.commit(); });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_FALSE(fs::exists(path("a")));
    ::close(lock);
    writer.join();
    EXPECT_TRUE(fs::exists(path("a")));
}

TEST_F(Outputs, SetsOfManyWritersNeverMix) {
    constexpr int kFiles = 8;
    const auto write = [&](char letter) {
        for (int round = 0; round < 30; ++round) {
            OutputSet outputs;
            for (int f = 0; f < kFiles; ++f) {
                outputs.add(path("f" + std::to_string(f))).write(std::string(1, letter));
            }
            outputs.commit();
        }
    };
    std::vector<std::thread> writers;
    for (const char letter : {'a', 'b', 'c'})
        writers.emplace_back(write, letter);
    for (std::thread& writer : writers)
        writer.join();
    ASSERT_EQ(names().size(), static_cast<std::size_t>(kFiles));
    for (int f = 1; f < kFiles; ++f) {
        EXPECT_EQ(readBytes(path("f" + std::to_string(f))), readBytes(path("f0")));
    }
}

} // namespace
} // namespace ibl::test
