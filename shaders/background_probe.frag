out vec4 color;

void main() { color = vec4(probeRadiance(viewRay()), 1.0); }
