in vec3 outer_color;
in vec3 inner_color;
in float vertex_alpha;
out vec4 color;

void main() {
    if (isMissing(vertex_alpha)) discard;
    color = vec4(gl_FrontFacing ? outer_color : inner_color, 1.0);
}
