// Directions along the surface for anisotropic materials: u runs around the object's vertical axis, as
// turning brushes metal, v up and down; at the poles u is +X.
void tangents(vec3 n, out vec3 u, out vec3 v) {
    float across = length(n.xz);
    u = across > 1e-4 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
    v = cross(n, u);
}
