// The faces that look away from the eye: outward normal, and depth along the view.
out vec4 color;

void main() { color = vec4(meshNormal(), 1.0 / gl_FragCoord.w); }
