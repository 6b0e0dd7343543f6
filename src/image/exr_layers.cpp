#include "image/exr_layers.h"

#include "core/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace ibl {
namespace {

bool isDeep(const Imf::Header& part) {
    return part.hasType() && Imf::isDeepData(part.type());
}

/// The channels that have `prefix` and no layer below it, by the rest of their names.
std::vector<std::string> channelsAt(const Imf::Header& part, const std::string& prefix) {
    std::vector<std::string> found;
    for (auto c = part.channels().begin(); c != part.channels().end(); ++c) {
        const std::string name = c.name();
        const std::size_t dot = name.rfind('.');
        const std::size_t begin = dot == std::string::npos ? 0 : dot + 1;
        if (name.substr(0, begin) == prefix) found.push_back(name.substr(begin));
    }
    return found;
}

/// What the channels after `prefix` make together; nothing if they are several of other names.
std::optional<ExrChoice> choiceAt(const std::vector<Imf::Header>& parts, int part,
                                  const std::string& prefix) {
    const std::vector<std::string> channels = channelsAt(parts[part], prefix);
    const auto has = [&](const char* name) { return std::ranges::count(channels, name) > 0; };
    const auto all = [&](ExrColour colour, std::vector<std::string> names, bool alpha) {
        for (std::string& name : names)
            name.insert(0, prefix);
        return ExrChoice{part, prefix, colour, std::move(names), alpha};
    };
    if (has("R") && has("G") && has("B")) return all(ExrColour::rgb, {"R", "G", "B"}, has("A"));
    if (has("X") && has("Y") && has("Z")) return all(ExrColour::vector, {"X", "Y", "Z"}, false);
    if (has("x") && has("y") && has("z")) return all(ExrColour::vector, {"x", "y", "z"}, false);
    if (has("Y") && !has("X")) { // X, Y: a vector in the plane
        const bool chroma = has("RY") && has("BY");
        return all(chroma ? ExrColour::luminanceChroma : ExrColour::luminance, {"Y"}, has("A"));
    }
    if (channels.size() == 1) return all(ExrColour::grey, channels, false);
    return std::nullopt;
}

/// Prefixes "layer." in a part's channel names, in their order, each once.
std::vector<std::string> prefixes(const Imf::Header& part) {
    std::vector<std::string> found;
    for (auto c = part.channels().begin(); c != part.channels().end(); ++c) {
        const std::string name = c.name();
        const std::size_t dot = name.rfind('.');
        if (dot == std::string::npos) continue;
        const std::string prefix = name.substr(0, dot + 1);
        if (std::find(found.begin(), found.end(), prefix) == found.end()) found.push_back(prefix);
    }
    return found;
}

struct NamedChoice {
    std::string name; ///< "" for the channels in no layer of the first part that has such
    ExrChoice choice;
};

/// Every layer in the file under the name by which it is asked for; earlier parts first, so that
/// of two with one name the first is meant.
std::vector<NamedChoice> layerChoices(const std::vector<Imf::Header>& parts) {
    std::vector<NamedChoice> all;
    bool have_main = false;
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
        if (isDeep(parts[p])) continue;
        if (const auto choice = choiceAt(parts, p, "")) {
            const bool colour =
                choice->colour != ExrColour::grey && choice->colour != ExrColour::vector;
            if (colour && !have_main) all.push_back({"", *choice});
            have_main = have_main || colour;
            if (parts[p].hasName()) all.push_back({parts[p].name(), *choice});
        }
        for (const std::string& prefix : prefixes(parts[p])) {
            const auto choice = choiceAt(parts, p, prefix);
            if (choice) all.push_back({prefix.substr(0, prefix.size() - 1), *choice});
        }
    }
    return all;
}

/// Every channel of a flat part by itself, under its full name.
std::vector<NamedChoice> channelChoices(const std::vector<Imf::Header>& parts) {
    std::vector<NamedChoice> all;
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
        if (isDeep(parts[p])) continue;
        for (auto c = parts[p].channels().begin(); c != parts[p].channels().end(); ++c)
            all.push_back({c.name(), {p, "", ExrColour::grey, {c.name()}, false}});
    }
    return all;
}

/// Whether the layer has the channel of its part, be it as its alpha or chroma.
bool holds(const ExrChoice& layer, const std::string& channel) {
    if (std::ranges::count(layer.channels, channel) > 0) return true;
    const bool chroma = layer.colour == ExrColour::luminanceChroma;
    return (layer.alpha && channel == layer.prefix + "A") ||
           (chroma && (channel == layer.prefix + "RY" || channel == layer.prefix + "BY"));
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < 12; ++i) {
        text += (i == 0 ? "" : ", ") + names[i];
    }
    if (names.size() > 12) text += " and " + std::to_string(names.size() - 12) + " more";
    return text;
}

} // namespace

std::vector<std::string> exrLayers(const std::vector<Imf::Header>& parts) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        const bool known = std::find(names.begin(), names.end(), name) != names.end();
        if (!name.empty() && !known) names.push_back(name);
    };
    const std::vector<NamedChoice> layers = layerChoices(parts);
    for (const NamedChoice& layer : layers)
        add(layer.name);
    for (const NamedChoice& channel : channelChoices(parts)) {
        const bool in_one = std::ranges::any_of(layers, [&](const NamedChoice& layer) {
            return layer.choice.part == channel.choice.part && holds(layer.choice, channel.name);
        });
        if (!in_one) add(channel.name);
    }
    return names;
}

ExrChoice chooseExrLayer(const std::vector<Imf::Header>& parts, const std::string& layer,
                         const std::string& file_name) {
    for (const NamedChoice& named : layerChoices(parts)) {
        if (named.name == layer) return named.choice;
    }
    for (const NamedChoice& named : channelChoices(parts)) {
        const Imf::Header& part = parts[named.choice.part];
        const bool by_part = part.hasName() && part.name() + "." + named.name == layer;
        if (named.name == layer || by_part) return named.choice;
    }
    if (std::all_of(parts.begin(), parts.end(), isDeep)) {
        throw inputError(file_name, "is a deep image; flatten it first");
    }
    const std::string names = listed(exrLayers(parts));
    if (layer.empty()) {
        throw inputError(file_name, "has no R, G, B or Y channels outside its layers, only " +
                                        names + "; say which one to read (--layer)");
    }
    throw inputError(file_name,
                     "has no layer '" + layer + "'" +
                         (names.empty() ? ", nor any other; leave it out" : "; there is " + names));
}

} // namespace ibl
