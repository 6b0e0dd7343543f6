#include "image/module_file.h"

#include <filesystem>

#include <dlfcn.h>

namespace ibl {
namespace fs = std::filesystem;

void* openModule(const std::string& file, std::string& problem) {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const char* folder : {".", IBLTOOL_MODULE_FOLDER}) {
        const fs::path path = program.parent_path() / folder / file;
        if (!fs::exists(path, error)) continue;
        void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!module) problem = ::dlerror();
        return module;
    }
    problem = "the module " + file + " is not installed";
    return nullptr;
}

} // namespace ibl
