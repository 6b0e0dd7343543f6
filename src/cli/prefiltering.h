// What diffuse, specular and bake share: quality options, running the engine, saying how exact.
#pragma once

#include "cli/session.h"

#include "convolve/prefilter.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ibl {

struct QualityOptions {
    Quality quality = Quality::standard;
    std::optional<double> max_error;
};

/// `--quality` and `--max-error`.
void bindQuality(CLI::App& app, QualityOptions& options);

/// Convolves the probe and puts each result's error, band limit, peaks and seconds into the report
/// under `results`. Throws Error (accuracy) when an asked `--max-error` is not kept.
std::vector<PrefilterResult> runPrefilter(Session& session, const Image& latlong,
                                          std::span<const PrefilterRequest> requests,
                                          const QualityOptions& quality);

/// The lobes of a specular chain of `levels`: roughness k / (levels - 1) (0 for a single level),
/// for Phong as the exponent 2 / alpha^2 - 2, alpha = roughness^2, at which the widths of the two
/// lobes agree (Walter et al. 2007), at most 1e6. Level k has the size `size >> k`.
std::vector<PrefilterRequest> chainRequests(Kernel kernel, int levels, Layout layout, int size);

/// The name of level k of a chain: dir/p.exr gives dir/p_m0.exr.
std::string levelName(const std::string& path, int level);

/// Most levels that a chain of that size can have: floor(log2 size) + 1.
int maxLevels(int size);

} // namespace ibl
