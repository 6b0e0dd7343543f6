#include "image/ocio.h"

#include "core/error.h"
#include "image/module_file.h"

#include <dlfcn.h>

namespace ibl {

DisplayTransform loadDisplayTransform(const DisplayView& view) {
    std::string problem;
    void* module = openModule("ibltool_ocio.so", problem);
    const auto load = module ? reinterpret_cast<OcioLoad>(::dlsym(module, kOcioLoadName)) : nullptr;
    if (module && !load) problem = "the module is of another version";
    if (!load) {
        throw Error(ExitCode::missing,
                    "--tonemap display: needs OpenColorIO, which cannot be loaded (" + problem +
                        "); install the package libopencolorio2.1");
    }
    DisplayTransform transform;
    const ExitCode code = load(view, transform, problem);
    if (code != ExitCode::done) {
        throw Error(code, (view.config.empty() ? "$OCIO" : view.config) + ": " + problem);
    }
    return transform;
}

} // namespace ibl
