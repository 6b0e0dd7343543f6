layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 vertex_normal;
out vec3 vertex_position;

void main() {
    vertex_normal = normal;
    vertex_position = position;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
