// What a lit material keeps of the surface. Its lights are looped over in a pass of its own, shaders/lit.frag,
// once a sample and pixel: rasterisers shade blocks of pixels for each triangle that touches them, several
// times as many as are seen where triangles are small.
layout(location = 1) out vec4 point_out;
layout(location = 2) out vec4 normal_out;
layout(location = 3) out vec4 facet_out;
layout(location = 4) out vec4 color_out;
uniform vec3 ambient;

vec3 shade(vec3 normal, vec3 incident) {
    point_out = vec4(surface_point, 1.0);
    normal_out = vec4(normal, 0.0);
    facet_out = vec4(facet_normal, 0.0);
    color_out = vec4(baseColor(), 0.0);
    return baseColor() * ambient;
}
