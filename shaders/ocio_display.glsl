// A view of an OpenColorIO config; ocioDisplay is the text that OpenColorIO wrote.
vec3 displayTone(vec3 c) { return ocioDisplay(vec4(clamp(c, -1e30, 1e30), 1.0)).rgb; }
