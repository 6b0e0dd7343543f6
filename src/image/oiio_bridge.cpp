#include "image/oiio.h"

#include "core/error.h"
#include "image/module_file.h"

#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

namespace ibl {
namespace {

OiioModule loadModule(const std::string& name) {
    std::string problem;
    void* module = openModule("ibltool_oiio.so", problem);
    OiioModule functions;
    if (module) {
        functions.read = reinterpret_cast<OiioModule::Read>(::dlsym(module, kOiioReadName));
        functions.write = reinterpret_cast<OiioModule::Write>(::dlsym(module, kOiioWriteName));
        functions.hasWriter =
            reinterpret_cast<OiioModule::HasWriter>(::dlsym(module, kOiioHasWriterName));
        if (!functions.read || !functions.write || !functions.hasWriter)
            problem = "the module is of another version";
    }
    if (!problem.empty()) {
        throw Error(ExitCode::missing, name +
                                           ": its format needs OpenImageIO, which cannot be "
                                           "loaded (" +
                                           problem + "); install the package " +
                                           IBLTOOL_OIIO_PACKAGE);
    }
    return functions;
}

/// A file in memory with the bytes of a stream, for a library that wants a name.
class MemoryFile {
public:
    explicit MemoryFile(const Source& source) : fd_(::memfd_create("ibltool", MFD_CLOEXEC)) {
        for (std::size_t done = 0; done < source.bytes.size();) {
            const ssize_t n = ::write(fd_, source.bytes.data() + done, source.bytes.size() - done);
            if (n <= 0) {
                ::close(fd_);
                throw inputError(source.name, "does not fit into memory");
            }
            done += static_cast<std::size_t>(n);
        }
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { ::close(fd_); }
    std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

private:
    int fd_;
};

void requireWriter(const OiioModule& module, const std::string& path, const std::string& format) {
    if (module.hasWriter(format)) return;
    throw Error(ExitCode::usage, path + ": there is no writer for '" + format +
                                     "'; end the name in .exr, .hdr, .png or .tif, or name such a "
                                     "--format");
}

} // namespace

void requireOiioWriter(const std::string& path, const std::string& format) {
    requireWriter(loadModule(path), path, format);
}

ImageFile readOiio(const Source& source, const ReadOptions& options) {
    const OiioModule module = loadModule(source.name);
    ImageFile file;
    std::string error;
    const bool ok = source.path.empty()
                        ? module.read(MemoryFile(source).path(), options, file, error)
                        : module.read(source.path, options, file, error);
    if (!ok) throw inputError(source.name, error);
    return file;
}

WriteLosses writeOiio(OutputFile& file, const Image& image, const std::string& format,
                      const WriteOptions& options) {
    const OiioModule module = loadModule(file.path());
    requireWriter(module, file.path(), format);
    WriteLosses losses;
    std::string error;
    if (!module.write(file.temporaryPath(), image, format, options, losses, error)) {
        throw outputError(file.path(), error);
    }
    return losses;
}

} // namespace ibl
