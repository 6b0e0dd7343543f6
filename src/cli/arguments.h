// Options that several subcommands share, and the helpers that bind them.
#pragma once

#include "image/write.h"
#include "panorama/layouts.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace ibl {

/// Of every command.
struct CommonOptions {
    int threads = 0;
    std::string report;
    std::string depfile;
    bool quiet = false;
    bool verbose = false;
};

/// Of every command that reads a probe.
struct ProbeOptions {
    std::string input;
    std::optional<Layout> from;
    std::string layer;
    bool repair = false;
};

/// Of every command that writes images.
struct ImageOutputOptions {
    std::string output;
    std::string format;
    std::optional<PixelType> type; ///< float when untold
    std::string compression;
};

void bindCommon(CLI::App& app, CommonOptions& options);

/// Binds the probe as the positional IN, or as the option named `as`.
void bindProbe(CLI::App& app, ProbeOptions& options, const std::string& as = "IN");

/// `--type half|float`.
void bindType(CLI::App& app, std::optional<PixelType>& type);

/// `-o`, `--format`, `--type`, `--compression`.
void bindImageOutput(CLI::App& app, ImageOutputOptions& options);

/// `--to LAYOUT` (default faces) and `--size N` (1 to `kMaxSize`).
void bindTarget(CLI::App& app, Layout& to, std::optional<int>& size,
                const std::string& default_size);

/// Largest face edge or lat-long height that is accepted.
constexpr int kMaxSize = 16384;

/// A check that an option's value is a number of that range, both ends included (NaN is in none).
CLI::Validator inRange(int least, int most);
CLI::Validator inRange(double least, double most);

/// `x,y,z` as three numbers.
CLI::Option* addTriple(CLI::App& app, const std::string& names, Imath::V3d& value,
                       const std::string& help, const std::string& type_name = "X,Y,Z");

/// How to write the output. Throws Error (usage) for standard output without a format, and for a
/// pixel type where the format has its own.
WriteOptions writeOptions(const ImageOutputOptions& output, const CommonOptions& common);
/// The same for a probe in that layout; .ktx2 and .dds hold no other than faces.
WriteOptions writeOptions(const ImageOutputOptions& output, const CommonOptions& common, Layout to);

} // namespace ibl
