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
    std::optional<Layout> from; ///< untold: OpenEXR's envmap, ibl.layout, or the shape
    std::string layer;          ///< as ReadOptions::layer
    int threads = 0;            ///< 0: as many as the machine has
};

struct ProbeFile {
    Panorama panorama;
    std::vector<std::string> files; ///< names read, for dependency files; none for built-in probes
    std::vector<std::string> notes; ///< one line each: what a user should know of how it was read
    ImageFile metadata;             ///< of the file, or the first face's; without pixels and notes
};

/// Reads a probe: a file, `-` (standard input), `builtin:NAME`, or six faces: DIR/p.exr stands for
/// DIR/p_px.exr, p_nx, p_py, p_ny, p_pz, p_nz when there is no file DIR/p.exr.
/// Throws Error (input) when it cannot be read, its layout cannot be told or is contradicted by its
/// shape (a label's, too), or the six faces are not square, of one size and of one map (MapLabel).
/// Bad pixels are kept (see census.h).
ProbeFile readProbe(const std::string& path, const ReadProbeOptions& options = {});

/// The names of the files that hold a probe of that layout: for `faces` six, the suffix standing
/// before the extension; otherwise `path` itself.
std::vector<std::string> probeFileNames(const std::string& path, Layout layout);

/// Adds a probe to the set of outputs, under the names above. OpenEXR files say its layout in
/// ibl.layout. The exr layouts set OpenEXR's envmap attribute, which other formats refuse. Six
/// faces cannot go to "-", but they are one file in a cube container, which refuses other layouts.
WriteLosses writeProbe(OutputSet& outputs, const std::string& path, const Panorama& panorama,
                       const WriteOptions& options = {});

} // namespace ibl
