#include "cli/render_options.h"

#include "core/error.h"
#include "render/builtin_objects.h"

#include <filesystem>

namespace ibl {
namespace {

void bindPlacement(CLI::App& app, ObjectArguments& arguments, FrameRange& frames) {
    const auto triple = [&](const char* name, std::array<Ramp, 3>& value, double most,
                            const char* help) {
        addRamps(
            app, name, 3,
            [&value](const std::vector<Ramp>& v) { std::copy_n(v.begin(), 3, value.begin()); },
            help, rampIn(-most, most), frames)
            ->type_name("X,Y,Z")
            ->group("Object");
    };
    triple("--translate", arguments.translate, 1e9, "Move the object, after all else");
    triple("--rotate", arguments.rotate, 1e6, "Turn it by so many degrees about z, then x, then y");
    addRamp(app, "--scale", arguments.scale, "Make it so many times as large", rampIn(1e-9, 1e9),
            frames)
        ->type_name("S")
        ->group("Object");
    app.add_flag("--fit", arguments.fit, "First bring it into the unit sphere at the origin")
        ->group("Object");
}

bool isTransparent(const Image& image) {
    if (image.channels != 4) return false;
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) {
        if (image.pixels[i] < 1) return true;
    }
    return false;
}

/// Lays the texture over all parts. What shows its inside through holes is of triangles: the exact
/// sphere is but its near side.
void addBaseTexture(Session& session, const std::string& path, Object& object) {
    if (object.mesh && object.mesh->texcoords.empty()) {
        throw Error(ExitCode::usage, "--base-texture: the object has no texture coordinates; leave "
                                     "it out, or give an object that has");
    }
    Image texture = session.readPicture(path, "texture", true);
    const bool transparent = isTransparent(texture);
    if (transparent && !object.mesh) object.mesh = makeSphere();
    object.parts = partsOf(object);
    for (Part& part : object.parts) {
        Surface& surface = part.surface;
        surface.base_texture = object.textures.size();
        if (!transparent || surface.alpha_cutoff != 0) continue;
        surface.alpha = 1; // did not count
        surface.alpha_cutoff = kBlended;
    }
    const bool premultiplied = texture.channels == 4;
    object.textures.push_back({std::move(texture), Wrap::repeat, Wrap::repeat, premultiplied});
}

ObjectFile readNamed(Session& session, const std::string& name) {
    if (std::optional<Object> builtin = builtinObject(name))
        return {std::move(*builtin), {}, {}, {}};
    std::error_code ignored;
    const std::filesystem::path path(name);
    if (!path.has_extension() && !path.has_parent_path() &&
        !std::filesystem::exists(path, ignored)) {
        std::string names;
        for (const std::string_view known : builtinObjectNames())
            names.append(" ").append(known);
        throw Error(ExitCode::usage, "--object " + name + ": no such object; there are" + names +
                                         ", or an OBJ, PLY or glTF file");
    }
    ObjectFile file = session.stage("mesh", [&] { return readObject(name, session.threads()); });
    for (const std::string& read : file.files)
        session.addInput(read);
    for (const std::string& text : file.notes)
        session.note(name, text);
    return file;
}

} // namespace

void bindObject(CLI::App& app, ObjectArguments& arguments, FrameRange& frames) {
    std::string objects;
    for (const std::string_view name : builtinObjectNames())
        objects += std::string(name) + ", ";
    app.add_option("--object", arguments.name, objects + "or an OBJ, PLY or glTF file")
        ->type_name("OBJECT")
        ->capture_default_str()
        ->group("Object");
    app.add_option("--base-texture", arguments.base_texture,
                   "Image that the base colour is multiplied by")
        ->type_name("FILE")
        ->group("Object");
    bindPlacement(app, arguments, frames);
}

Placement placementOf(const ObjectArguments& a, const FramePlace& place) {
    const auto& [x, y, z] = a.translate;
    const auto& [about_x, about_y, about_z] = a.rotate;
    return {V3d(x.at(place), y.at(place), z.at(place)),
            {about_y.at(place), about_x.at(place), about_z.at(place), false},
            a.scale.at(place),
            a.fit};
}

ObjectFile objectOf(Session& session, const ObjectArguments& arguments, const std::string& name) {
    ObjectFile file = readNamed(session, name);
    if (!arguments.base_texture.empty()) {
        addBaseTexture(session, arguments.base_texture, file.object);
    }
    return file;
}

} // namespace ibl
