// One colour, or nothing.
uniform vec3 plain_color;
uniform float plain_alpha;

vec4 behind() { return vec4(plain_color, plain_alpha); }
