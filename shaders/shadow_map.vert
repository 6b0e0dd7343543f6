layout(location = 0) in vec3 position;
layout(location = 2) in vec2 texcoord;
uniform mat4 clip_from_object;
out vec2 vertex_texcoord;

void main() {
    vertex_texcoord = texcoord;
    gl_Position = clip_from_object * vec4(position, 1.0);
}
