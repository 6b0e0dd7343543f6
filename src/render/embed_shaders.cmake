# Writes OUTPUT, a C++ table of all files in FOLDER named in FILES (separated by |).
string(REPLACE "|" ";" names "${FILES}")
set(rows "")
foreach(name IN LISTS names)
    file(READ "${FOLDER}/${name}" text)
    string(APPEND rows "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Made from the shaders folder at build time.
#include \"render/shader_program.h\"

namespace ibl {
namespace {
constexpr EmbeddedShader kShaders[] = {
${rows}};
} // namespace

std::span<const EmbeddedShader> embeddedShaders() { return kShaders; }

} // namespace ibl
")
