# Renders the unit sphere under a lat-long probe with Blender's Cycles: `make-references` runs it as
#     blender -b -P scripts/cycles_references.py -- PROBE FOLDER NAME ...
# and gets FOLDER/NAME.exr, 64x64 floats, for each material.
import math
import sys

import bpy
import numpy

# A pixel is the mean of these over its square; seeds are fixed and nothing is denoised or clamped.
SAMPLES = {"ggx25": 32768, "ggx50": 32768}  # others 16384
SIZE, FOV, DISTANCE, AZIMUTH, ELEVATION = 64, 40.0, 4.0, 75.0, 15.0  # cycles_test.cpp has them, too
IOR = 1.5


def cycles_axes(x, y, z):
    """Ours has +Y up and the lat-long's centre at +Z; Cycles has +Z up and the centre at +X."""
    return (z, x, y)


def add_sphere(columns=1024, rows=512):
    """A mesh so fine that its facets stay within 1e-5 of the sphere, its normals the positions."""
    theta = numpy.linspace(0, math.pi, rows + 1)[1:-1]
    phi = numpy.arange(columns) * (2 * math.pi / columns)
    ring = numpy.stack([numpy.outer(numpy.sin(theta), numpy.cos(phi)),
                        numpy.outer(numpy.sin(theta), numpy.sin(phi)),
                        numpy.outer(numpy.cos(theta), numpy.ones(columns))], axis=-1)
    points = numpy.concatenate([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    north, south = len(points) - 2, len(points) - 1
    i = numpy.arange(columns)
    j = (i + 1) % columns
    quads = [numpy.stack([r * columns + i, (r + 1) * columns + i, (r + 1) * columns + j,
                          r * columns + j], axis=-1) for r in range(rows - 2)]
    last = (rows - 2) * columns
    faces = numpy.concatenate(quads).tolist()
    faces += numpy.stack([numpy.full(columns, north), i, j], axis=-1).tolist()
    faces += numpy.stack([last + i, numpy.full(columns, south), last + j], axis=-1).tolist()
    mesh = bpy.data.meshes.new("sphere")
    mesh.from_pydata(points.tolist(), [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    sphere = bpy.data.objects.new("sphere", mesh)
    bpy.context.scene.collection.objects.link(sphere)
    return sphere


def material(name):
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    nodes, links = result.node_tree.nodes, result.node_tree.links
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")

    def node(kind, **inputs):
        made = nodes.new(kind)
        for key, value in inputs.items():
            made.inputs[key].default_value = value
        return made

    white = (1, 1, 1, 1)
    if name == "mirror":
        bsdf = node("ShaderNodeBsdfGlossy", Color=white, Roughness=0)
        bsdf.distribution = "SHARP"
    elif name == "diffuse":
        bsdf = node("ShaderNodeBsdfDiffuse", Color=white, Roughness=0)
    # Cycles' Glass, but the sum of what its first face mirrors and of what it lets in, weighted
    # instead of chosen by chance: else the mirrored sun is noise.
    elif name == "glass_mirror":
        bsdf = node("ShaderNodeBsdfGlossy", Roughness=0)
        bsdf.distribution = "SHARP"
        links.new(node("ShaderNodeFresnel", IOR=IOR).outputs[0], bsdf.inputs["Color"])
    elif name == "glass_inside":
        first = node("ShaderNodeBsdfRefraction", Roughness=0, IOR=IOR)
        first.distribution = "SHARP"
        let_in = nodes.new("ShaderNodeMath")
        let_in.operation = "SUBTRACT"
        let_in.inputs[0].default_value = 1
        links.new(node("ShaderNodeFresnel", IOR=IOR).outputs[0], let_in.inputs[1])
        links.new(let_in.outputs[0], first.inputs["Color"])
        second = node("ShaderNodeBsdfGlass", Color=white, Roughness=0, IOR=IOR)
        second.distribution = "SHARP"
        bsdf = nodes.new("ShaderNodeMixShader")
        links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], bsdf.inputs[0])
        links.new(first.outputs[0], bsdf.inputs[1])
        links.new(second.outputs[0], bsdf.inputs[2])
    else:  # single scattering, separable Smith masking, alpha = roughness^2
        bsdf = node("ShaderNodeBsdfGlossy", Color=white, Roughness=int(name[3:]) / 100)
        bsdf.distribution = "GGX"
    links.new(bsdf.outputs[0], out.inputs["Surface"])
    return result


def add_world(probe, interpolation):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(probe)
    texture.image.colorspace_settings.name = "Raw"
    texture.interpolation = interpolation
    background = nodes.new("ShaderNodeBackground")
    out = nodes.new("ShaderNodeOutputWorld")
    links.new(texture.outputs[0], background.inputs["Color"])
    links.new(background.outputs[0], out.inputs["Surface"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 2048


def add_camera():
    azimuth, elevation = math.radians(AZIMUTH), math.radians(ELEVATION)
    eye = cycles_axes(DISTANCE * math.cos(elevation) * math.sin(azimuth),
                      DISTANCE * math.sin(elevation),
                      DISTANCE * math.cos(elevation) * math.cos(azimuth))
    data = bpy.data.cameras.new("camera")
    data.angle = math.radians(FOV)
    data.clip_end = 1000
    camera = bpy.data.objects.new("camera", data)
    import mathutils
    camera.location = eye
    camera.rotation_euler = mathutils.Vector([-c for c in eye]).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def main(probe, folder, names):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.seed = 1
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    add_camera()
    sphere = add_sphere()
    for name in names:
        glass = name.startswith("glass")
        cycles.max_bounces = 64 if glass else 1
        cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 64
        cycles.samples = SAMPLES.get(name, 16384)
        # Integrals take pixels as constant over their rectangles, lookups interpolate.
        add_world(probe, "Linear" if name == "mirror" or glass else "Closest")
        sphere.data.materials.clear()
        sphere.data.materials.append(material(name))
        scene.render.filepath = f"{folder}/{name}.exr"
        bpy.ops.render.render(write_still=True)


arguments = sys.argv[sys.argv.index("--") + 1:]
main(arguments[0], arguments[1], arguments[2:])
