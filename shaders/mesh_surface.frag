// A triangle mesh with interpolated normals, seen from either side.
in vec3 vertex_normal;
out vec4 color;

void main() {
    vec3 normal = normalize(vertex_normal);
    color = vec4(shade(gl_FrontFacing ? normal : -normal, normalize(viewRay())), 1.0);
}
