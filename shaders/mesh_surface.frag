// A triangle mesh with interpolated normals, seen from either side.
in vec3 vertex_normal;
in vec3 vertex_position;
out vec4 color;

void main() {
    vec3 normal = normalize(vertex_normal), ray = viewRay();
    surface_point = vertex_position;
    vec3 facet = normalize(cross(dFdx(vertex_position), dFdy(vertex_position)));
    facet_normal = dot(facet, ray) > 0.0 ? -facet : facet;
    color = vec4(shade(gl_FrontFacing ? normal : -normal, normalize(ray)), 1.0);
}
