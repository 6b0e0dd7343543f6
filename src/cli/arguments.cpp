#include "cli/arguments.h"

#include "core/error.h"
#include "image/write.h"

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace ibl {
namespace {

/// Accepts a layout's name and nothing else; CLI11 shows the names in the help.
CLI::Option* addLayout(CLI::App& app, const std::string& name, Layout& layout,
                       const std::string& help) {
    return app
        .add_option_function<std::string>(
            name, [&layout](const std::string& text) { layout = *layoutFromName(text); }, help)
        ->check(CLI::IsMember(layoutNames()))
        ->type_name("LAYOUT");
}

template <class T>
CLI::Validator rangeCheck(T least, T most, const char* what) {
    std::ostringstream ends, range;
    ends << least << " to " << most;
    range << CLI::detail::type_name<T>() << " in [" << least << " - " << most << "]";
    const auto check = [least, most, what, words = ends.str()](std::string& text) {
        T value{};
        const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
        return good ? "" : "'" + text + "' is not " + what + " from " + words;
    };
    return CLI::Validator(check, range.str());
}

} // namespace

CLI::Validator inRange(int least, int most) {
    return rangeCheck(least, most, "a whole number");
}

CLI::Validator inRange(double least, double most) {
    return rangeCheck(least, most, "a number");
}

void bindCommon(CLI::App& app, CommonOptions& options) {
    app.add_option("--threads", options.threads, "Threads to use (0: as many as the machine has)")
        ->check(inRange(0, 1024))
        ->type_name("N")
        ->capture_default_str()
        ->group("Run");
    app.add_option("--report", options.report, "Write what was done and how long it took as JSON")
        ->type_name("FILE")
        ->group("Run");
    app.add_option("--depfile", options.depfile, "Write a makefile rule of outputs and inputs")
        ->type_name("FILE")
        ->group("Run");
    CLI::Option* quiet =
        app.add_flag("--quiet", options.quiet, "No notes on standard error, only errors")
            ->group("Run");
    app.add_flag("--verbose", options.verbose, "Say on standard error what is done")
        ->excludes(quiet)
        ->group("Run");
}

void bindProbe(CLI::App& app, ProbeOptions& options, const std::string& as) {
    app.add_option(as, options.input,
                   "The probe: a file, - for standard input, or builtin:sky, builtin:compass, "
                   "builtin:furnace")
        ->required()
        ->type_name(as == "IN" ? "" : "IN");
    app.add_option_function<std::string>(
           "--from", [&options](const std::string& text) { options.from = layoutFromName(text); },
           "Layout of the probe (default: told from shape and metadata)")
        ->check(CLI::IsMember(layoutNames()))
        ->type_name("LAYOUT")
        ->group("Input");
    app.add_option("--layer", options.layer,
                   "Layer, part or channel of an EXR to read; single channels are read as grey")
        ->type_name("NAME")
        ->group("Input");
    app.add_flag("--repair", options.repair,
                 "Mend NaN, infinite and negative pixels from their neighbours (default: NaN and "
                 "infinite are refused, negative kept)")
        ->group("Input");
}

void bindType(CLI::App& app, std::optional<PixelType>& type) {
    app.add_option_function<std::string>(
           "--type",
           [&type](const std::string& text) {
               type = text == "half" ? PixelType::half : PixelType::float32;
           },
           "Pixels of EXR, KTX2 and DDS files (default float)")
        ->check(CLI::IsMember({"half", "float"}))
        ->type_name("TYPE")
        ->group("Output");
}

void bindImageOutput(CLI::App& app, ImageOutputOptions& options) {
    app.add_option("-o,--output", options.output, "File to write, - for standard output")
        ->required()
        ->type_name("OUT")
        ->group("Output");
    app.add_option("--format", options.format,
                   "Format instead of what the extension says: exr, hdr, png, tif ... (required on "
                   "standard output)")
        ->type_name("FORMAT")
        ->group("Output");
    bindType(app, options.type);
    app.add_option(
           "--compression", options.compression,
           "Compression of EXR files (default zip; float results of specular and diffuse: none)")
        ->check(CLI::IsMember(
            {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}))
        ->type_name("NAME")
        ->group("Output");
}

void bindTarget(CLI::App& app, Layout& to, std::optional<int>& size,
                const std::string& default_size) {
    addLayout(app, "--to", to, "Layout of the result (default faces)")->group("Output");
    app.add_option("--size", size,
                   "Face edge, height of a lat-long or edge of a square map, in pixels (default: " +
                       default_size + ")")
        ->check(inRange(1, kMaxSize))
        ->type_name("N")
        ->group("Output");
}

CLI::Option* addTriple(CLI::App& app, const std::string& names, Imath::V3d& value,
                       const std::string& help, const std::string& type_name) {
    return app
        .add_option_function<std::vector<double>>(
            names, [&value](const std::vector<double>& v) { value = Imath::V3d(v[0], v[1], v[2]); },
            help)
        ->delimiter(',')
        ->expected(3)
        ->type_name(type_name);
}

WriteOptions writeOptions(const ImageOutputOptions& output, const CommonOptions& common,
                          Layout to) {
    const WriteOptions how = writeOptions(output, common);
    if (to != Layout::faces && isCubeContainer(output.output, how)) {
        throw Error(ExitCode::usage, output.output + ": .ktx2 and .dds hold faces, not " +
                                         std::string(layoutName(to)) + "; leave out --to");
    }
    return how;
}

WriteOptions writeOptions(const ImageOutputOptions& output, const CommonOptions& common) {
    if (output.output == "-" && output.format.empty()) {
        throw Error(ExitCode::usage, "-: standard output has no extension; say the format with "
                                     "--format");
    }
    WriteOptions options;
    options.type = output.type.value_or(PixelType::float32);
    std::string format = output.format;
    if (format.empty()) format = std::filesystem::path(output.output).extension().string();
    for (const char* own : {"hdr", ".hdr", "pic", ".pic", "png", ".png", "jpg", ".jpg"}) {
        if (output.type && format == own) {
            throw Error(ExitCode::usage, output.output + ": " + own +
                                             " has its own pixel type; leave "
                                             "out --type, or write .exr");
        }
    }
    options.compression = output.compression;
    options.format = output.format;
    options.threads = common.threads;
    requireFormat(output.output, options);
    return options;
}

} // namespace ibl
