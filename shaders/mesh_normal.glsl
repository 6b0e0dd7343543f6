// The normal of a mesh at the fragment, on its outer side: interpolated between vertices, or the
// triangle's own.
in vec3 vertex_normal;

vec3 meshNormal() {
#ifdef FLAT_NORMALS
    // Of points p of a plane n.(p - eye) = d, p = eye + z r with the ray r linear in the pixel and of
    // depth 1, 1 / z = n.r / d: its value and slopes are n / d along forward, step_x and step_y,
    // which are perpendicular.
    float w = gl_FragCoord.w;
    vec2 p = samplePoint();
    vec2 slope = vec2(dFdx(w), dFdy(w));
    vec3 plane = (w - dot(slope, p)) / dot(forward, forward) * forward +
                 slope.x / dot(step_x, step_x) * step_x + slope.y / dot(step_y, step_y) * step_y;
    // Since 1 / z is positive, n / d looks away from the eye.
    return normalize(gl_FrontFacing ? -plane : plane);
#else
    return normalize(vertex_normal);
#endif
}
