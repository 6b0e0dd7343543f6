// What diffuse, specular and bake share: quality options, running the engine, saying how exact.
#pragma once

#include "cli/session.h"

#include "convolve/prefilter.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

struct QualityOptions {
    Quality quality = Quality::standard;
    std::optional<double> max_error;
};

/// `--quality` and `--max-error`.
void bindQuality(CLI::App& app, QualityOptions& options);

/// What is convolved: a lat-long, and where it was read from a probe of another layout that one.
struct ProbeToPrefilter {
    Panorama latlong;
    std::optional<Panorama> source;
};

/// Reads other layouts into a lat-long of as few rows, 256 or more, as keep what that leaves below
/// the error that the quality allows in every requested map, as far as 2048 do (of large square
/// maps 1024, if not `high`).
ProbeToPrefilter toPrefilter(Session& session, Panorama&& probe,
                             std::span<const PrefilterRequest> requests,
                             const QualityOptions& quality);

/// A request that sees about as much of a probe as its harmonic coefficients of that many bands,
/// for toPrefilter alone: of cos^n t with n = order^2, whose coefficients fall to 0.6 there.
PrefilterRequest asSeenByCoefficients(int order);

/// Convolves the probe and puts each result's error, band limit, peaks and seconds into the report
/// under `results`. Throws Error (accuracy) when an asked `--max-error` is not kept; of a quality's
/// error that is a note.
std::vector<PrefilterResult> runPrefilter(Session& session, const ProbeToPrefilter& probe,
                                          std::span<const PrefilterRequest> requests,
                                          const QualityOptions& quality);

/// How roughness goes with lod = k / (levels - 1) down a chain.
enum class RoughnessMap { linear, square, filament };

/// `--roughness-map` and its help are made from these rows.
struct RoughnessMapRow {
    RoughnessMap map;
    std::string_view name;
    std::string_view formula;
};

inline constexpr std::array<RoughnessMapRow, 3> kRoughnessMaps{{
    {RoughnessMap::linear, "linear", "lod"},
    {RoughnessMap::square, "square", "lod^2"},
    {RoughnessMap::filament, "filament", "1 - sqrt(1 - lod)"},
}};

/// `--roughness-map`.
CLI::Option* bindRoughnessMap(CLI::App& app, RoughnessMap& map);

/// Roughness of level k; 0 for a single level.
double levelRoughness(RoughnessMap map, int k, int levels);

/// The lobes of a specular chain of `levels`: level 0 the area-filtered probe (as roughness 0 of
/// GGX is), then the kernel at levelRoughness; for Phong and Blinn-Phong as the exponent
/// 2 / alpha^2 - 2, alpha = roughness^2, at which the widths of GGX's and Blinn-Phong's
/// distributions agree (Walter et al. 2007), at most 1e6. Level k has the size `size >> k`. Throws
/// Error (usage) for Lambert, which has no roughness, and where a level's is out of the kernel's
/// range.
std::vector<PrefilterRequest> chainRequests(Kernel kernel, int levels, RoughnessMap map,
                                            Layout layout, int size);

/// Says in the report which roughness each level stands for; level 0 is the map `first`.
void reportRoughness(Session& session, std::size_t first, int levels, RoughnessMap map);

/// What the file of a lobe's map says of it.
MapLabel labelOf(const Lobe& lobe);

/// What the files of a chain's levels say of them. `requests`: as chainRequests makes them.
std::vector<MapLabel> chainLabels(Kernel kernel, RoughnessMap map,
                                  std::span<const PrefilterRequest> requests);

/// Adds the levels of a chain to the outputs, each under its levelName, and says so if a longer
/// chain has left levels beside them.
void writeChain(Session& session, const std::string& path, std::span<const PrefilterResult> levels,
                std::span<const MapLabel> labels, WriteOptions options);

/// The file of that name, or the first face of six, if there is one.
std::optional<std::string> fileOfMap(const std::string& path);

/// The name of level k of a chain: dir/p.exr gives dir/p_m0.exr.
std::string levelName(const std::string& path, int level);

/// Most levels that a chain of that size can have: floor(log2 size) + 1.
int maxLevels(int size);

} // namespace ibl
