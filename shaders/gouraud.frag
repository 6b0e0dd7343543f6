in vec3 outer_color;
in vec3 inner_color;
in float vertex_alpha;
uniform float alpha_cutoff;
out vec4 color;

void main() {
    if (vertex_alpha < alpha_cutoff) discard;
    color = vec4(gl_FrontFacing ? outer_color : inner_color, 1.0);
}
