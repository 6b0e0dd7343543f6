// OpenEXR files, through OpenEXR itself.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/read.h"
#include "image/source.h"
#include "image/write.h"

#include <string>

namespace ibl {

/// Reads a flat image from a file of one or many parts: RGB(A), luminance, or luminance with
/// subsampled chroma; scanlines or the largest level of tiles; any compression. See readImage for
/// what is refused. Pixels go from the decoder straight into the image.
ImageFile readExr(const Source& source, const ReadOptions& options);

/// Writes one part of scanlines, R G B (A), increasing y. Half values beyond 65504 are clamped to
/// it and counted; with float the image's own pixels are handed to the encoder, without a copy.
WriteLosses writeExr(OutputFile& file, const Image& image, const WriteOptions& options);

/// Number of threads for OpenEXR's file constructors that means `threads` (0: the machine's).
/// OpenEXR has one pool of threads a process, empty at first; it is grown to that many. It never
/// shrinks, and what a file uses of it is bounded by the number given to its constructor.
int exrThreads(int threads);

} // namespace ibl
