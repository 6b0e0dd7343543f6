#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/session.h"

#include "image/read.h"
#include "panorama/census.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    CommonOptions common;
    ProbeOptions probe;
    bool json = false;
};

Json jsonOf(const V3d& v) {
    return Json::array({v.x, v.y, v.z});
}

Json jsonOf(const BadPixels& bad) {
    Json json{{"count", bad.count}};
    if (bad.count > 0) {
        json["first"] = {bad.first.x, bad.first.y};
        json["extreme"] = bad.extreme; // null in JSON when it is infinite
        json["extreme_at"] = {bad.extreme_at.x, bad.extreme_at.y};
    }
    return json;
}

Json describe(const InfoOptions& options, const ProbeFile& file, const Census& census) {
    Json json;
    json["source"] = options.probe.input;
    json["format"] = file.metadata.format;
    json["compression"] = file.metadata.compression;
    json["pixel_type"] = file.metadata.pixel_type;
    json["layers"] = file.metadata.layers;
    if (!file.metadata.label.kernel.empty()) json["map"] = describe(file.metadata.label);
    json["exposure"] = file.metadata.exposure;
    json["colour_correction"] = jsonOf(file.metadata.colour_correction);
    json["layout"] = layoutName(file.panorama.layout);
    if (!file.metadata.layout.empty()) json["layout_label"] = file.metadata.layout;
    json["size"] = {file.panorama.image.width, file.panorama.image.height};
    json["minimum"] = jsonOf(census.min);
    json["maximum"] = jsonOf(census.max);
    json["mean_radiance"] = jsonOf(census.mean);
    json["energy"] = jsonOf(census.energy);
    json["brightest"] = nullptr;
    if (census.sun_at.x >= 0) {
        json["brightest"] = {{"pixel", {census.sun_at.x, census.sun_at.y}},
                             {"direction", jsonOf(census.sun_direction)},
                             {"radiance", jsonOf(census.sun_radiance)}};
    }
    json["nan"] = jsonOf(census.nan);
    json["infinite"] = jsonOf(census.infinite);
    json["negative"] = jsonOf(census.negative);
    json["notes"] = file.notes;
    return json;
}

std::string triple(const V3d& v) {
    std::string text;
    for (int c = 0; c < 3; ++c) {
        char number[32];
        std::snprintf(number, sizeof number, "%.6g", v[c]);
        text += (c > 0 ? " " : "") + std::string(std::isnan(v[c]) ? "none" : number);
    }
    return text;
}

std::string counted(const BadPixels& bad) {
    if (bad.count == 0) return "0";
    char text[128];
    std::snprintf(text, sizeof text, "%ld, the first at (%d, %d), the extreme %g at (%d, %d)",
                  bad.count, bad.first.x, bad.first.y, static_cast<double>(bad.extreme),
                  bad.extreme_at.x, bad.extreme_at.y);
    return text;
}

void line(const char* name, const std::string& value) {
    std::cout << name << std::string(16 - std::string_view(name).size(), ' ') << value << '\n';
}

void print(const InfoOptions& options, const ProbeFile& file, const Census& census) {
    const ImageFile& metadata = file.metadata;
    const Image& image = file.panorama.image;
    std::string format = metadata.format;
    for (const std::string& part : {metadata.pixel_type, metadata.compression}) {
        if (!part.empty()) format += ", " + part;
    }
    std::string layers;
    for (const std::string& name : metadata.layers)
        layers += (layers.empty() ? "" : " ") + name;
    const V2i at = census.sun_at;
    line("source", options.probe.input);
    line("format", format);
    if (!layers.empty()) line("layers", layers);
    if (!metadata.label.kernel.empty()) line("map", describe(metadata.label));
    if (metadata.exposure != 1)
        line("exposure", std::to_string(metadata.exposure) + ", divided out");
    if (metadata.colour_correction != V3d(1)) {
        line("colour corr.", triple(metadata.colour_correction) + ", divided out");
    }
    line("layout", std::string(layoutName(file.panorama.layout)) + ", " +
                       std::to_string(image.width) + " x " + std::to_string(image.height) +
                       (metadata.layout.empty() ? "" : " (its label: " + metadata.layout + ")"));
    line("minimum", triple(census.min));
    line("maximum", triple(census.max));
    line("mean radiance", triple(census.mean));
    line("energy", triple(census.energy) + " (radiance times steradian)");
    line("brightest", at.x < 0 ? "none"
                               : triple(census.sun_radiance) + " at pixel (" +
                                     std::to_string(at.x) + ", " + std::to_string(at.y) +
                                     "), direction " + triple(census.sun_direction));
    line("NaN", counted(census.nan));
    line("infinite", counted(census.infinite));
    line("negative", counted(census.negative));
}

void runInfo(const InfoOptions& options) {
    Session session("info", options.common);
    // Bad pixels are told here, not refused; --repair shows the probe as it would be used.
    ProbeFile file = session.readUnscreened(options.probe);
    if (options.probe.repair) session.mend(options.probe.input, file.panorama);
    const Census census =
        session.stage("census", [&] { return takeCensus(file.panorama, session.threads()); });
    session.results() = describe(options, file, census);
    if (options.json) {
        std::cout << session.results().dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    } else {
        print(options, file, census);
    }
    session.finish();
}

} // namespace

Command bindInfo(CLI::App& root) {
    CLI::App* app = root.add_subcommand("info", "What a probe is: layout, range, sun, bad pixels");
    auto options = std::make_shared<InfoOptions>();
    bindProbe(*app, options->probe);
    app->add_flag("--json", options->json, "Print one JSON object");
    bindCommon(*app, options->common);
    return {app, [options] { runInfo(*options); }};
}

} // namespace ibl
