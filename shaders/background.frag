// What is behind the object, whose coverage alpha is.
out vec4 color;

void main() { color = vec4(behind(), 0.0); }
