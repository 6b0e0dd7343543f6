#include "image/exr_layers.h"

#include "core/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>

#include <algorithm>
#include <optional>

namespace ibl {
namespace {

bool isDeep(const Imf::Header& part) {
    return part.hasType() && Imf::isDeepData(part.type());
}

/// What R, G, B or Y after `prefix` make; none if they make no colour.
std::optional<ExrChoice> colourAt(const std::vector<Imf::Header>& parts, int part,
                                  const std::string& prefix) {
    const Imf::ChannelList& channels = parts[part].channels();
    const auto has = [&](const char* name) {
        return channels.findChannel(prefix + name) != nullptr;
    };
    ExrChoice choice{part, prefix, ExrColour::rgb, has("A")};
    if (has("R") && has("G") && has("B")) return choice;
    if (!has("Y")) return std::nullopt;
    const bool chroma = has("RY") && has("BY");
    choice.colour = chroma ? ExrColour::luminanceChroma : ExrColour::luminance;
    return choice;
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

/// Every colour in the file under the name by which it is asked for; earlier parts first, so that
/// of two with one name the first is meant.
std::vector<NamedChoice> allChoices(const std::vector<Imf::Header>& parts) {
    std::vector<NamedChoice> all;
    bool have_main = false;
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
        if (isDeep(parts[p])) continue;
        if (const auto choice = colourAt(parts, p, "")) {
            if (!have_main) all.push_back({"", *choice});
            have_main = true;
            if (parts[p].hasName()) all.push_back({parts[p].name(), *choice});
        }
        for (const std::string& prefix : prefixes(parts[p])) {
            const auto choice = colourAt(parts, p, prefix);
            if (choice) all.push_back({prefix.substr(0, prefix.size() - 1), *choice});
        }
    }
    return all;
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
    for (const NamedChoice& named : allChoices(parts)) {
        const bool known = std::find(names.begin(), names.end(), named.name) != names.end();
        if (!named.name.empty() && !known) names.push_back(named.name);
    }
    return names;
}

ExrChoice chooseExrLayer(const std::vector<Imf::Header>& parts, const std::string& layer,
                         const std::string& file_name) {
    for (const NamedChoice& named : allChoices(parts)) {
        if (named.name == layer) return named.choice;
    }
    if (std::all_of(parts.begin(), parts.end(), isDeep)) {
        throw inputError(file_name, "is a deep image; flatten it first");
    }
    const std::vector<std::string> names = exrLayers(parts);
    if (names.empty()) {
        std::vector<std::string> channels;
        for (auto c = parts[0].channels().begin(); c != parts[0].channels().end(); ++c) {
            channels.emplace_back(c.name());
        }
        throw inputError(file_name, "has no R, G, B or Y channels, only " + listed(channels) +
                                        "; give an RGB or luminance image");
    }
    if (layer.empty()) {
        throw inputError(file_name, "has its colours in layers only: " + listed(names) +
                                        "; say which layer to read");
    }
    throw inputError(file_name, "has no layer '" + layer + "'; there is " + listed(names));
}

} // namespace ibl
