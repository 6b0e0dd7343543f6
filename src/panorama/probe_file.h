// Probes in files: one image, or six faces in six images.
#pragma once

#include "image/read.h"
#include "image/write.h"
#include "panorama/panorama.h"

#include <optional>
#include <string>
#include <vector>

namespace ibl {

struct ReadProbeOptions {
    std::optional<Layout> from; ///< untold: from shape and metadata
    std::string layer;          ///< of a multi-layer EXR; empty: the default one
    int threads = 0;
};

struct ProbeFile {
    Panorama panorama;
    std::vector<std::string> files; ///< names read, for dependency files; none for built-in probes
    std::vector<std::string> notes; ///< what was not silent: exposure, alpha ignored, ...
    ImageFile details; ///< format, exposure, layers (of the first face); its image is empty, for
                       ///< the pixels are the panorama's
};

/// Reads a probe: a file, `-` (standard input), `builtin:NAME`, or six faces: DIR/p.exr stands for
/// DIR/p_px.exr, p_nx, p_py, p_ny, p_pz, p_nz when there is no file DIR/p.exr.
/// Throws Error (input) when it cannot be read, its layout cannot be told or the faces differ in
/// size or are not square. Bad pixels are left as they are (see census.h).
ProbeFile readProbe(const std::string& path, const ReadProbeOptions& options);

/// The names of the files that hold a probe of that layout: six for `faces`, else `path` itself.
std::vector<std::string> probeFileNames(const std::string& path, Layout layout);

/// Adds a probe to the set of outputs, under the names above. The exr layouts set OpenEXR's envmap
/// attribute, and are refused (Error, usage) in any other format.
WriteLosses writeProbe(OutputSet& outputs, const std::string& path, const Panorama& panorama,
                       const WriteOptions& options);

} // namespace ibl
