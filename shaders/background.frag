// What is behind the object.
out vec4 color;

void main() { color = behind(); }
