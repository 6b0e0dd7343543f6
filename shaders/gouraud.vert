// Shades vertices, for either side, between which fragments interpolate (Gouraud 1971).
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texcoord;
uniform mat4 clip_from_object;
uniform mat4 world_from_object;
uniform vec3 eye;
out vec3 outer_color;
out vec3 inner_color;
out float vertex_alpha;

void main() {
    readSurface(texcoord, vec2(0.0), vec2(0.0));
    surface_point = (world_from_object * vec4(position, 1.0)).xyz;
    vec3 facing = normalize(mat3(world_from_object) * normal);
    vec3 incident = normalize(surface_point - eye);
    surface_outside = true;
    outer_color = shade(facing, incident);
    surface_outside = false;
    inner_color = shade(-facing, incident);
    // After shade(), which may take it away.
    outer_color += surface_emission;
    inner_color += surface_emission;
    vertex_alpha = surface_alpha;
    gl_Position = clip_from_object * vec4(position, 1.0);
}
