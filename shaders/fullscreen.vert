// One triangle that covers the viewport, at the far plane.
void main() {
    vec2 corner = vec2((gl_VertexID & 1) << 2, (gl_VertexID & 2) << 1);
    gl_Position = vec4(corner - 1.0, 1.0, 1.0);
}
