#include "panorama/probe_file.h"

#include "panorama/builtin.h"
#include "panorama/layouts.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

namespace ibl {
namespace {

constexpr std::array<std::string_view, 6> kFaceSuffixes{"_px", "_nx", "_py", "_ny", "_pz", "_nz"};

bool exists(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

/// Whether `path` stands for six faces: it is no file, and at least one of them is.
bool standsForFaces(const std::string& path) {
    if (path == "-" || exists(path)) return false;
    const std::vector<std::string> names = probeFileNames(path, Layout::faces);
    return std::any_of(names.begin(), names.end(), exists);
}

ImageFile withoutPixels(ImageFile file) {
    file.image = Image();
    file.notes.clear();
    return file;
}

ProbeFile readFaces(const std::string& path, const ReadProbeOptions& options) {
    if (options.from && *options.from != Layout::faces) {
        throw inputError(path, "six files _px _nx _py _ny _pz _nz are faces, not " +
                                   std::string(layoutName(*options.from)) +
                                   "; leave the layout to be told");
    }
    ProbeFile probe;
    probe.panorama.layout = Layout::faces;
    int edge = 0;
    for (const std::string& name : probeFileNames(path, Layout::faces)) {
        ImageFile file = readImage(name, {options.layer, false, options.threads});
        const int width = file.image.width, height = file.image.height;
        if (!options.from && !file.layout.empty() && file.layout != layoutName(Layout::faces)) {
            throw inputError(name, "is labelled " + file.layout +
                                       ", and has a face's name; rename it, or tell the layout "
                                       "(--from)");
        }
        if (width != height) {
            throw inputError(name, std::to_string(width) + "x" + std::to_string(height) +
                                       " is no cube face; it must be square");
        }
        if (probe.files.empty()) {
            edge = width;
            probe.panorama.image = Image(edge, 6 * edge);
        } else if (width != edge) {
            throw inputError(name, "the face is " + std::to_string(width) + " pixels wide, " +
                                       probe.files.front() + " is " + std::to_string(edge) +
                                       "; all six must be of one size");
        }
        if (!probe.files.empty() && file.label != probe.metadata.label) {
            throw inputError(name, "is of another map (" + describe(file.label) + ") than " +
                                       probe.files.front() + " (" + describe(probe.metadata.label) +
                                       "); write the six again");
        }
        float* face = probe.panorama.image.row(static_cast<int>(probe.files.size()) * edge);
        std::copy(file.image.pixels.begin(), file.image.pixels.end(), face);
        for (const std::string& note : file.notes)
            probe.notes.push_back(name + ": " + note);
        if (probe.files.empty()) probe.metadata = withoutPixels(std::move(file));
        probe.files.push_back(name);
    }
    return probe;
}

/// The layout that the file's label says, if its shape allows that one: other programs hand labels
/// on with whatever they have made of the pixels.
Layout labelledLayout(const std::string& path, const ImageFile& file) {
    const int width = file.image.width, height = file.image.height;
    const std::optional<Layout> layout = layoutFromName(file.layout);
    if (layout == Layout::faces) {
        throw inputError(path, "is one of six faces by its label; give their name without _px, _nx "
                               "..., or its layout (--from)");
    }
    const std::string told = "is labelled " + file.layout + ", which ";
    if (!layout) throw inputError(path, told + "is no layout; name its layout (--from)");
    const bool fits = layout == Layout::latlong ? isLatlongShape(width, height)
                                                : layoutSize(*layout, width, height).has_value();
    if (fits) return *layout;
    throw inputError(path, told + std::to_string(width) + "x" + std::to_string(height) +
                               " pixels cannot be; name its layout (--from)");
}

Layout layoutOf(const std::string& path, const ImageFile& file, const ReadProbeOptions& options) {
    const int width = file.image.width, height = file.image.height;
    if (!options.from) {
        const bool labelled = file.envmap.empty() && !file.layout.empty();
        return labelled ? labelledLayout(path, file)
                        : detectLayout(path, width, height, file.envmap);
    }
    if (*options.from == Layout::faces) {
        throw inputError(path, "is one file, not six faces; name a file whose _px _nx _py _ny _pz "
                               "_nz are there, or give its layout");
    }
    requireLayoutExtent(path, *options.from, width, height);
    return *options.from;
}

ProbeFile readOne(const std::string& path, const ReadProbeOptions& options) {
    ImageFile file = readImage(path, {options.layer, false, options.threads});
    ProbeFile probe;
    probe.panorama.layout = layoutOf(path, file, options);
    probe.panorama.image = std::move(file.image);
    probe.notes = std::move(file.notes);
    if (path != "-") probe.files.push_back(path);
    probe.metadata = withoutPixels(std::move(file));

    const Layout layout = probe.panorama.layout;
    const bool by_shape =
        !options.from && probe.metadata.envmap.empty() && probe.metadata.layout.empty();
    if (by_shape && layout != Layout::latlong) {
        // Many a photograph is 4:3.
        if (!crossCellsBlank(probe.panorama)) {
            throw inputError(path,
                             "has the shape of " + std::string(layoutName(layout)) +
                                 ", but not the blank corners of one; name its layout (--from)");
        }
        probe.notes.push_back("taken as " + std::string(layoutName(layout)) + " by its shape");
    }
    return probe;
}

} // namespace

std::vector<std::string> probeFileNames(const std::string& path, Layout layout) {
    if (layout != Layout::faces) return {path};
    const std::string extension = std::filesystem::path(path).extension().string();
    const std::string stem = path.substr(0, path.size() - extension.size());
    std::vector<std::string> names;
    for (std::string_view suffix : kFaceSuffixes) {
        names.push_back(stem + std::string(suffix) + extension);
    }
    return names;
}

ProbeFile readProbe(const std::string& path, const ReadProbeOptions& options) {
    if (isBuiltin(path)) {
        if (options.from && *options.from != Layout::latlong) {
            throw inputError(path, "built-in probes are latlong; leave the layout to be told");
        }
        ProbeFile probe;
        probe.panorama = builtinProbe(path);
        probe.metadata.format = "builtin";
        return probe;
    }
    return standsForFaces(path) ? readFaces(path, options) : readOne(path, options);
}

WriteLosses writeProbe(OutputSet& outputs, const std::string& path, const Panorama& panorama,
                       const WriteOptions& options) {
    WriteOptions how = options;
    how.layout = layoutName(panorama.layout);
    if (panorama.layout == Layout::exrLatlong) how.envmap = "latlong";
    if (panorama.layout == Layout::exrCube) how.envmap = "cube";
    if (isCubeContainer(path, options)) {
        if (panorama.layout != Layout::faces) {
            throw Error(ExitCode::usage, path + ": .ktx2 and .dds hold faces, not " +
                                             std::string(layoutName(panorama.layout)) +
                                             "; write another format");
        }
        const Image* level = &panorama.image;
        return writeCubeMap(outputs, path, {&level, 1}, options);
    }
    if (panorama.layout != Layout::faces) {
        return writeImage(outputs, path, panorama.image, how);
    }
    if (path == "-") {
        throw Error(ExitCode::usage,
                    "-: standard output cannot hold six files; ask for a layout of one image");
    }
    const Image& image = panorama.image;
    const int edge = image.width;
    return writeImages(
        outputs, probeFileNames(path, Layout::faces),
        [&](std::size_t face) {
            Image one(edge, edge);
            std::copy_n(image.row(static_cast<int>(face) * edge), one.pixels.size(),
                        one.pixels.begin());
            return one;
        },
        how);
}

} // namespace ibl
