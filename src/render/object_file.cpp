#include "render/object_file.h"

#include "core/error.h"
#include "render/object_readers.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace ibl {
namespace {

std::vector<char> readBytes(const std::string& path, std::ifstream& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw inputError(path, "cannot be read; give a regular file");
    std::vector<char> bytes(size);
    file.seekg(0);
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    if (file.gcount() != static_cast<std::streamsize>(size)) {
        throw inputError(path, "cannot be read to its end; try again");
    }
    return bytes;
}

} // namespace

ObjectFile readObject(const std::string& path, int threads) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        throw inputError(path, "is a directory; give an OBJ, PLY or glTF file");
    }
    std::ifstream file(path, std::ios::binary);
    char head[64] = {};
    if (!std::filesystem::exists(path, ignored))
        throw inputError(path, "there is no such file; check the name");
    if (!file) throw inputError(path, "cannot be read; check its permissions");
    file.read(head, sizeof head);
    const std::string_view begin(head, static_cast<std::size_t>(file.gcount()));
    if (begin.empty()) throw inputError(path, "is empty; export it again");
    file.clear();
    const std::size_t text = begin.find_first_not_of(" \t\r\n");
    if (begin.starts_with("ply\n") || begin.starts_with("ply\r")) {
        return readPly(path, readBytes(path, file));
    }
    if (begin.starts_with("glTF") || (text != begin.npos && begin[text] == '{')) {
        return readGltf(path, readBytes(path, file), threads);
    }
    if (begin.find('\0') != begin.npos) {
        throw inputError(path, "is none of OBJ, PLY and glTF; give one of these");
    }
    return readObj(path, threads);
}

} // namespace ibl
