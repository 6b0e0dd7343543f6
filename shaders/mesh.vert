layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texcoord;
uniform mat4 clip_from_object;
uniform mat4 world_from_object; // turns, scales by one factor, and shifts
out vec3 vertex_position;
out vec3 vertex_normal;
out vec2 vertex_texcoord;

void main() {
    vertex_position = (world_from_object * vec4(position, 1.0)).xyz;
    vertex_normal = mat3(world_from_object) * normal;
    vertex_texcoord = texcoord;
    gl_Position = clip_from_object * vec4(position, 1.0);
}
