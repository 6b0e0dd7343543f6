// Writing an image in the format that its name asks for.
#pragma once

#include "image/image.h"
#include "image/map_label.h"
#include "image/output_set.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ibl {

/// Type of the channels of OpenEXR files; other formats have their own (TIFF follows it).
enum class PixelType { half, float32 };

/// A further channel of a picture, of the picture's size.
struct ExtraChannel {
    std::string name; ///< with its layer: "normal.X"
    std::vector<float> values;
};

struct WriteOptions {
    PixelType type = PixelType::float32;
    /// OpenEXR: "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"; "" is
    /// zip, or none for smooth floats
    std::string compression;
    bool smooth = false; ///< convolved: floats of which zip saves 3 % for a third of the time
    std::string envmap;  ///< OpenEXR's envmap attribute: "", "latlong" or "cube"
    std::string layout;  ///< OpenEXR: that of a probe, in the attribute ibl.layout; "" is none
    MapLabel label;      ///< OpenEXR: of a convolved map
    std::string format;  ///< "exr", "hdr", "png", ... instead of what the name's extension says
    int threads = 0;     ///< for encoding; 0: as many as the machine has
    /// OpenEXR: written beside the picture's own, as floats whatever `type` is.
    std::span<const ExtraChannel> extra;
};

/// What a format could not hold. Counts are of values (channels), not of pixels.
struct WriteLosses {
    std::size_t above = 0;      ///< brighter than the format's brightest: written as that
    std::size_t below = 0;      ///< negative where the format has no negatives (written as 0), or
                                ///< under the lowest that it has (written as that)
    std::size_t not_number = 0; ///< NaN where the format has none: written as 0
    std::size_t bright_pixels = 0; ///< of PNG: with a channel among those above

    WriteLosses& operator+=(const WriteLosses& other);
};

/// Writes RGB or RGBA floats. The format is `options.format`, otherwise the extension of `path`:
/// exr; hdr, pic and rgbe (Radiance, run-length coded, RGB only); png (8 bits, sRGB); any other
/// through OpenImageIO. Values are taken as scene-linear. "-" (standard output) needs
/// `options.format`. The bytes depend on the pixels and options alone, not on time or threads.
/// Throws outputError if the file cannot be written, or the format cannot take the image; Error
/// (usage) if nothing says the format, it is unknown or an option does not fit it; and
/// Error(ExitCode::missing) if OpenImageIO is needed and not there.
WriteLosses writeImage(OutputSet& outputs, const std::string& path, const Image& image,
                       const WriteOptions& options = {});

/// Writes image k, which `imageOf(k)` makes, to `paths[k]`, some of them at the same time: small
/// ones take longer to open than to write. Throws as writeImage does, of the first that fails.
WriteLosses writeImages(OutputSet& outputs, std::span<const std::string> paths,
                        const std::function<Image(std::size_t)>& imageOf,
                        const WriteOptions& options = {});

/// Throws what writeImage would throw, whatever the image, for a file whose format nothing says,
/// nothing writes or has no compression to choose: before the image is made.
void requireFormat(const std::string& path, const WriteOptions& options);

/// Whether that file is a KTX 2 or DDS container, which holds a whole cube map: by
/// `options.format`, otherwise by the extension ktx2 or dds.
bool isCubeContainer(const std::string& path, const WriteOptions& options = {});

/// Writes a cube map with its levels in one such file. Levels are N x 6N pixels of RGB, from the
/// largest on, each half as wide as the one before. Pixels are RGBA of `options.type`. Throws as
/// writeImage does.
WriteLosses writeCubeMap(OutputSet& outputs, const std::string& path,
                         std::span<const Image* const> levels, const WriteOptions& options = {});

/// The losses in words, one line for each kind that occurred: "12 values above 65504 were written
/// as 65504". `path` and `options` as given to writeImage: they say what the format's limits are.
std::vector<std::string> describeLosses(const WriteLosses& losses, const std::string& path,
                                        const WriteOptions& options = {});

} // namespace ibl
