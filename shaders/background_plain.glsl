// One colour, or nothing.
uniform vec3 plain_color;

vec3 behind() { return plain_color; }
