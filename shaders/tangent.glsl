// Directions along the surface for anisotropic materials: u runs around the object's vertical axis, as
// turning brushes metal, v up and down; at the poles u is its +X.
uniform vec3 object_up = vec3(0.0, 1.0, 0.0);
uniform vec3 object_right = vec3(1.0, 0.0, 0.0);

void tangents(vec3 n, out vec3 u, out vec3 v) {
    vec3 around = cross(object_up, n);
    float across = length(around);
    u = across > 1e-4 ? around / across : object_right;
    v = cross(n, u);
}
