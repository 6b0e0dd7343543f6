#include "image/source.h"

#include "core/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ibl {
namespace {

constexpr std::size_t kFirstBytes = 128;
/// Of a stream, which may have no end.
constexpr std::size_t kMostOfStream = std::size_t{4} << 30;

class Descriptor {
public:
    explicit Descriptor(const std::string& path)
        : fd_(path == "-" ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)
                          : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY)) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    int get() const { return fd_; }

private:
    int fd_;
};

Error readError(const std::string& name, int error) {
    if (error == ENOENT) return inputError(name, "there is no such file; check the name");
    if (error == EACCES) return inputError(name, "may not be read; check its permissions");
    if (error == EISDIR) return inputError(name, "is a folder; name a file in it");
    return inputError(name, std::string("cannot be read (") + std::strerror(error) + ")");
}

/// Appends up to `limit` bytes, fewer at the end of the file. `expected` is how many there may be:
/// a hint, so that a file is not copied as the buffer grows.
void append(Source& source, int fd, std::size_t limit, std::size_t expected) {
    std::size_t size = source.bytes.size();
    const std::size_t end = limit > SIZE_MAX - size ? SIZE_MAX : size + limit;
    source.bytes.resize(std::min(end, size + expected + 1));
    while (size < end) {
        if (size == source.bytes.size()) {
            source.bytes.resize(std::min(end, size + size / 2 + 65536));
        }
        const ssize_t n = ::read(fd, source.bytes.data() + size, source.bytes.size() - size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw readError(source.name, errno);
        if (n == 0) break;
        size += static_cast<std::size_t>(n);
    }
    source.bytes.resize(size);
}

} // namespace

Source openSource(const std::string& path) {
    Source source;
    source.name = path == "-" ? "standard input" : path;
    if (path.empty()) throw inputError("input", "its name is empty; name a file");
    const Descriptor file(path);
    struct stat info = {};
    if (file.get() < 0 || ::fstat(file.get(), &info) != 0) throw readError(source.name, errno);
    if (S_ISDIR(info.st_mode)) throw readError(source.name, EISDIR);
    if (path != "-" && S_ISREG(info.st_mode)) {
        source.path = path;
        append(source, file.get(), kFirstBytes, kFirstBytes);
        source.whole = source.bytes.size() < kFirstBytes;
    } else {
        append(source, file.get(), kMostOfStream + 1, 65536);
        if (source.bytes.size() > kMostOfStream) {
            throw inputError(source.name, "has more than 4 GiB, or no end; give a file");
        }
        source.whole = true;
    }
    if (source.bytes.empty()) throw inputError(source.name, "is empty; export it again");
    return source;
}

void readWhole(Source& source) {
    if (source.whole) return;
    const Descriptor file(source.path);
    struct stat info = {};
    if (file.get() < 0 || ::fstat(file.get(), &info) != 0) throw readError(source.name, errno);
    source.bytes.clear();
    append(source, file.get(), SIZE_MAX, static_cast<std::size_t>(info.st_size));
    source.whole = true;
}

void checkSize(const std::string& name, std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1) throw inputError(name, "has no pixels; give another image");
    // The edges are looked at first: their product may not fit.
    if (width > kMaxImageEdge || height > kMaxImageEdge || width * height > kMaxImagePixels) {
        throw inputError(name, "is " + std::to_string(width) + "x" + std::to_string(height) +
                                   " pixels, more than is read (65536 an edge, 2^30 in all); "
                                   "shrink it first");
    }
}

} // namespace ibl
