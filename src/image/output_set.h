// Files that appear together, whole, or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

/// One file being written. It has no name until its set is committed.
class OutputFile {
public:
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();

    /// Writes bytes at position(), which moves on. Small writes are gathered. Throws outputError,
    /// on a full disk for example, at once or at the next flush.
    void write(const void* data, std::size_t size);
    void write(std::string_view text) { write(text.data(), text.size()); }
    void seek(std::uint64_t position);
    std::uint64_t position() const { return position_ + pending_.size(); }
    /// Hands gathered bytes to the system. Throws if any write has failed, even one whose exception
    /// went astray (OpenEXR's destructors swallow them).
    void flush();

    /// The name the user gave, for messages.
    const std::string& path() const { return path_; }
    /// A name under which other libraries can open the file while it is being written.
    std::string temporaryPath() const;

private:
    friend class OutputSet;
    OutputFile() = default;
    void openBeside(std::size_t number);
    void giveHiddenName(std::size_t number);
    void giveName();
    void sendToStream();
    void close();

    std::string path_;   ///< as given
    std::string folder_; ///< of the file that is replaced, links resolved; "" for a stream
    std::string name_;   ///< in that folder
    std::string hidden_; ///< name in that folder before the rename; "" while the file is unnamed
    int file_ = -1;      ///< what is being written
    int stream_ = -1;    ///< where it goes at commit if the target is a pipe, device or descriptor
    int error_ = 0;      ///< errno of the first write that failed
    std::uint64_t position_ = 0; ///< in the file, of the first pending byte
    std::vector<char> pending_;
};

/// The files that one run writes. Each is written unnamed (or under a hidden name, where the file
/// system has no unnamed files) in its target's folder; commit() gives all of them their names.
/// Without commit nothing is left, whatever was added.
///
/// A target that exists is replaced and its permission bits are kept; a symbolic link is followed.
/// Targets that are no regular files (a pipe, /dev/null, /dev/stdout) and "-", standard output,
/// receive their bytes at commit, before any file gets its name.
class OutputSet {
public:
    OutputSet() = default;
    OutputSet(const OutputSet&) = delete;
    OutputSet& operator=(const OutputSet&) = delete;
    ~OutputSet() = default;

    /// Opens a new file that shall become `path`. The reference lives as long as the set. Throws
    /// outputError if `path` is a folder, lies in none or may not be written; Error (usage) if it
    /// is in the set already. Not to be called from several threads at once; writing to different
    /// files of a set may be.
    OutputFile& add(const std::string& path);

    /// Gives all files their names, in the order in which they were added: add a report or a
    /// dependency file last, so that whoever sees it sees the others. Sets that share a folder take
    /// turns (an advisory lock on the folder), so that two runs never leave a mixture.
    /// Throws outputError; files not yet named are then dropped.
    void commit();

private:
    std::vector<std::unique_ptr<OutputFile>> files_;
};

} // namespace ibl
