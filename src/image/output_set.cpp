#include "image/output_set.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ibl {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kPendingBytes = 256 * 1024;

/// What to tell the user for an errno.
std::string reason(int error) {
    switch (error) {
    case ENOSPC:
    case EDQUOT:
        return "cannot be written, the disk is full; free some space";
    case EACCES:
    case EPERM:
        return "cannot be written, permission denied; choose another place";
    case EROFS:
        return "cannot be written, the file system is read-only; choose another place";
    case ENAMETOOLONG:
        return "the name is too long; choose a shorter one";
    case EPIPE:
        return "cannot be written, the reader of the pipe is gone";
    default:
        return std::string("cannot be written (") + std::strerror(error) + ")";
    }
}

Error outputErrno(const std::string& path, int error) {
    return outputError(path == "-" ? "standard output" : path, reason(error));
}

/// Why no file can be made in a folder, where the system finds the folder or a part of its path
/// missing.
std::string folderFault(const std::string& folder) {
    std::error_code ignored;
    if (fs::is_directory(folder, ignored)) return folder + " takes no files; choose another place";
    for (fs::path part = folder; !part.empty() && part != part.parent_path();
         part = part.parent_path()) {
        if (fs::exists(part, ignored) && !fs::is_directory(part, ignored))
            return part.string() + " is a file, not a folder; choose another place";
    }
    return "there is no folder " + folder + "; create it first";
}

/// write() or pwrite() of everything; returns 0 or errno.
template <class Write>
int writeAll(const char* data, std::size_t size, const Write& writeSome) {
    while (size > 0) {
        const ssize_t n = writeSome(data, size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return errno;
        if (n == 0) return EIO;
        data += n;
        size -= static_cast<std::size_t>(n);
    }
    return 0;
}

/// N of "/dev/fd/N" and "/proc/self/fd/N", which name descriptors, not files.
std::optional<int> descriptorNumber(const std::string& path) {
    for (const std::string_view prefix : {"/dev/fd/", "/proc/self/fd/"}) {
        if (!path.starts_with(prefix)) continue;
        int number = -1;
        const char* end = path.data() + path.size();
        const auto parsed = std::from_chars(path.data() + prefix.size(), end, number);
        if (parsed.ec == std::errc() && parsed.ptr == end) return number;
    }
    return std::nullopt;
}

/// The path with symbolic links of its last component followed, dangling ones too.
fs::path followLinks(const std::string& path) {
    fs::path target = path;
    for (int hops = 0; hops < 40; ++hops) {
        std::error_code error;
        if (descriptorNumber(target.string())) return target;
        const fs::path link = fs::read_symlink(target, error);
        if (error) return target; // not a link
        target = link.is_absolute() ? link : target.parent_path() / link;
    }
    throw outputErrno(path, ELOOP);
}

/// Locks on folders, taken in one order by everybody so that two sets cannot wait for each other.
/// A folder that cannot be opened for reading or locked (some network file systems) is left
/// unlocked: the files are still whole, only turns are not taken.
class FolderLocks {
public:
    explicit FolderLocks(std::vector<std::string> folders) {
        std::vector<std::array<std::uint64_t, 3>> opened; // device, inode, descriptor
        for (const std::string& folder : folders) {
            const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
            if (fd < 0) continue;
            descriptors_.push_back(fd);
            struct stat info = {};
            if (::fstat(fd, &info) != 0) continue;
            opened.push_back({static_cast<std::uint64_t>(info.st_dev),
                              static_cast<std::uint64_t>(info.st_ino),
                              static_cast<std::uint64_t>(fd)});
        }
        std::sort(opened.begin(), opened.end());
        for (std::size_t i = 0; i < opened.size(); ++i) {
            // A folder under two names would wait for its own lock.
            if (i > 0 && opened[i][0] == opened[i - 1][0] && opened[i][1] == opened[i - 1][1]) {
                continue;
            }
            while (::flock(static_cast<int>(opened[i][2]), LOCK_EX) != 0 && errno == EINTR) {
            }
        }
    }
    FolderLocks(const FolderLocks&) = delete;
    FolderLocks& operator=(const FolderLocks&) = delete;
    ~FolderLocks() {
        for (const int fd : descriptors_)
            ::close(fd);
    }

private:
    std::vector<int> descriptors_;
};

} // namespace

OutputFile::~OutputFile() {
    if (!hidden_.empty()) ::unlink((fs::path(folder_) / hidden_).c_str());
    if (file_ >= 0) ::close(file_);
    if (stream_ >= 0) ::close(stream_);
}

void OutputFile::write(const void* data, std::size_t size) {
    const char* bytes = static_cast<const char*>(data);
    if (pending_.size() + size > kPendingBytes) flush();
    if (size <= kPendingBytes) {
        pending_.insert(pending_.end(), bytes, bytes + size);
        return;
    }
    error_ = writeAll(bytes, size, [this](const char* p, std::size_t n) {
        const ssize_t written = ::pwrite(file_, p, n, static_cast<off_t>(position_));
        if (written > 0) position_ += static_cast<std::uint64_t>(written);
        return written;
    });
    if (error_ != 0) throw outputErrno(path_, error_);
}

void OutputFile::seek(std::uint64_t position) {
    if (position == this->position()) return;
    flush();
    position_ = position;
}

void OutputFile::flush() {
    if (error_ == 0) {
        error_ = writeAll(pending_.data(), pending_.size(), [this](const char* p, std::size_t n) {
            const ssize_t written = ::pwrite(file_, p, n, static_cast<off_t>(position_));
            if (written > 0) position_ += static_cast<std::uint64_t>(written);
            return written;
        });
        pending_.clear();
    }
    if (error_ != 0) throw outputErrno(path_, error_);
}

std::string OutputFile::temporaryPath() const {
    return "/proc/self/fd/" + std::to_string(file_);
}

/// Opens an unnamed file in the target's folder; a hidden one where the file system (or a missing
/// /proc, through which an unnamed file gets its name) does not have it.
void OutputFile::openBeside(std::size_t number) {
    if (::access("/proc/self/fd", X_OK) == 0) {
        file_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
        if (file_ >= 0) return;
    }
    for (std::size_t attempt = number;; ++attempt) {
        hidden_ = ".ibltool-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
        file_ = ::open((fs::path(folder_) / hidden_).c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC,
                       0666);
        if (file_ >= 0) return;
        if (errno == EEXIST) continue;
        const int error = errno;
        hidden_.clear();
        if (error == ENOENT || error == ENOTDIR) throw outputError(path_, folderFault(folder_));
        throw outputErrno(path_, error);
    }
}

/// Links an unnamed file into its folder under a name that nobody looks at: linkat cannot replace
/// an existing target, rename can.
void OutputFile::giveHiddenName(std::size_t number) {
    for (std::size_t attempt = number; hidden_.empty(); ++attempt) {
        const std::string name =
            ".ibltool-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
        if (::linkat(AT_FDCWD, temporaryPath().c_str(), AT_FDCWD,
                     (fs::path(folder_) / name).c_str(), AT_SYMLINK_FOLLOW) == 0) {
            hidden_ = name;
        } else if (errno != EEXIST) {
            throw outputErrno(path_, errno);
        }
    }
}

void OutputFile::giveName() {
    const fs::path folder = folder_;
    if (::rename((folder / hidden_).c_str(), (folder / name_).c_str()) != 0) {
        throw outputErrno(path_, errno);
    }
    hidden_.clear();
}

void OutputFile::sendToStream() {
    std::vector<char> buffer(kPendingBytes);
    for (off_t position = 0;;) {
        const ssize_t n = ::pread(file_, buffer.data(), buffer.size(), position);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw outputErrno(path_, errno);
        if (n == 0) break;
        position += n;
        const int error =
            writeAll(buffer.data(), static_cast<std::size_t>(n),
                     [this](const char* p, std::size_t m) { return ::write(stream_, p, m); });
        if (error != 0) throw outputErrno(path_, error);
    }
    close();
    if (::close(std::exchange(stream_, -1)) != 0) throw outputErrno(path_, errno);
}

/// Network file systems report a full disk only here.
void OutputFile::close() {
    if (::close(std::exchange(file_, -1)) != 0) throw outputErrno(path_, errno);
}

OutputFile& OutputSet::add(const std::string& path) {
    if (path.empty()) throw outputError("output", "its name is empty; name a file");
    std::unique_ptr<OutputFile> file(new OutputFile);
    file->path_ = path;

    const fs::path target = path == "-" ? fs::path("/dev/fd/1") : followLinks(path);
    const std::optional<int> descriptor = descriptorNumber(target.string());
    struct stat info = {};
    const bool exists = !descriptor && ::stat(target.c_str(), &info) == 0;
    if (!descriptor && !exists && errno != ENOENT && errno != ENOTDIR) {
        throw outputErrno(path, errno);
    }
    if ((exists && S_ISDIR(info.st_mode)) || target.filename().empty()) {
        throw outputError(path, "is a folder; name a file in it");
    }
    if (descriptor || (exists && !S_ISREG(info.st_mode))) {
        file->stream_ = descriptor ? ::fcntl(*descriptor, F_DUPFD_CLOEXEC, 3)
                                   : ::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
        if (file->stream_ < 0) throw outputErrno(path, errno);
        file->name_ = target.string();
        file->file_ = ::memfd_create("ibltool", MFD_CLOEXEC);
        if (file->file_ < 0) throw outputErrno(path, errno);
    } else {
        // rename would replace a write-protected file; its owner does not want that.
        if (exists && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) {
            throw outputErrno(path, errno);
        }
        file->folder_ = target.has_parent_path() ? target.parent_path().string() : ".";
        file->name_ = target.filename().string();
        file->openBeside(files_.size());
        if (exists && ::fchmod(file->file_, info.st_mode & 0777) != 0) {
            throw outputErrno(path, errno);
        }
    }
    for (const auto& other : files_) {
        std::error_code error;
        // Any number of outputs may go to /dev/null.
        const bool files = other->stream_ < 0 && file->stream_ < 0;
        if ((path == "-" && other->path_ == "-") ||
            (files && other->name_ == file->name_ &&
             fs::equivalent(other->folder_, file->folder_, error))) {
            throw Error(ExitCode::usage,
                        path + ": would be written twice; give the outputs different names");
        }
    }
    return *files_.emplace_back(std::move(file));
}

void OutputSet::commit() {
    // Taken over, so that whatever is not named when an exception leaves is dropped.
    const std::vector<std::unique_ptr<OutputFile>> files = std::move(files_);
    files_.clear();
    std::vector<std::string> folders;
    for (const auto& file : files) {
        file->flush();
        if (file->stream_ < 0) folders.push_back(file->folder_);
    }
    for (const auto& file : files) {
        if (file->stream_ >= 0) file->sendToStream();
    }
    std::sort(folders.begin(), folders.end());
    folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
    const FolderLocks locks(std::move(folders));
    // All that may fail comes before the first rename.
    std::size_t number = 0;
    for (const auto& file : files) {
        if (file->file_ < 0) continue;
        file->giveHiddenName(number++);
        file->close();
    }
    for (const auto& file : files) {
        if (!file->hidden_.empty()) file->giveName();
    }
}

} // namespace ibl
