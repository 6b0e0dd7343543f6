// The ground: a horizontal plane.
uniform vec3 eye;
uniform float ground_height;

// Where a falling ray from the eye meets it.
vec3 groundPoint(vec3 ray) {
    vec3 p = eye + ray * ((ground_height - eye.y) / min(ray.y, -1e-30));
    p.y = ground_height;
    return p;
}
