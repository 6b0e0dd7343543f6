// Reading an image file of any format into linear RGB floats.
#pragma once

#include "image/image.h"
#include "image/map_label.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <string>
#include <vector>

namespace ibl {

struct ReadOptions {
    std::string layer; ///< OpenEXR layer or part ("diffuse" reads diffuse.R .G .B); "" the main one
    bool keep_alpha =
        false;       ///< RGBA where the file has alpha; otherwise alpha is dropped, and noted
    int threads = 0; ///< for decoding; 0: as many as the machine has
    /// Integer formats as they are, codes from 0 to 1, for what is no colour (a normal map); their
    /// alpha is not multiplied in.
    bool undecoded = false;
    bool finite = false; ///< refuse an image that holds NaN or infinite values
};

struct ImageFile {
    Image image;             ///< RGB, or RGBA (premultiplied) with keep_alpha and alpha in the file
    std::string format;      ///< "exr", "radiance", "png", or OpenImageIO's name of the format
    std::string compression; ///< "zip", "dwaa", "rle", ...; "" where it does not apply
    std::string pixel_type;  ///< "half", "float", "uint", "rgbe", "uint8", "uint16", ...
    std::string envmap;      ///< OpenEXR's envmap attribute: "latlong", "cube" or "" (none)
    std::string layout;      ///< OpenEXR's attribute ibl.layout, as written; "" (none)
    MapLabel label;          ///< of a convolved map in OpenEXR
    /// Products of a Radiance file's EXPOSURE and COLORCORR lines. The pixels are divided by them
    /// already.
    double exposure = 1;
    Imath::V3d colour_correction{1, 1, 1};
    std::vector<std::string> layers; ///< what ReadOptions::layer could have named, "" left out
    std::vector<std::string> notes;  ///< one line each: what a user should know of how it was read
};

/// Reads an image. The format is told from the first bytes, never from the name; "-" is standard
/// input. OpenEXR, Radiance and PNG are read here, any other format by OpenImageIO, whose module is
/// loaded when such a file is met. Integer formats are display-referred: they are decoded from sRGB
/// (and noted). NaN, infinities and negative values are kept as they are. An OpenEXR image covers
/// its display window; where its data window has no pixels it is 0.
/// Throws inputError for a missing, empty or truncated file (parts and levels of an OpenEXR file
/// that are not read may be damaged), a deep image, an unknown layer, an image of more than 65536
/// pixels an edge or 2^30 pixels in all, values that ReadOptions::finite refuses; and
/// Error(ExitCode::missing) if OpenImageIO is needed and not there.
ImageFile readImage(const std::string& path, const ReadOptions& options = {});
/// The same of a file's bytes; `name` is for messages.
ImageFile readImage(std::vector<std::uint8_t> bytes, const std::string& name,
                    const ReadOptions& options = {});

} // namespace ibl
