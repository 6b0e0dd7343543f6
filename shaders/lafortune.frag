// Lafortune et al. 1997, one lobe: ks (n + 2) / (2 pi) max(Cx lx vx + Cy ly vy + Cz lz vz, 0)^n in the frame
// of the surface. (-1, -1, 1) is Phong's lobe; |Cx|, |Cy| above Cz lean it outwards, positive ones send
// light back. The normalisation is that of the longest lobe, so that shorter ones reflect less.
uniform vec3 specular_color;
uniform float reflectivity;
uniform float exponent;
uniform float lobe_x;
uniform float lobe_y;
uniform float lobe_z;

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    vec3 along_u, along_v;
    tangents(n, along_u, along_v);
    float c = lobe_x * dot(l, along_u) * dot(v, along_u) + lobe_y * dot(l, along_v) * dot(v, along_v) +
              lobe_z * dot(l, n) * dot(v, n);
    vec3 gloss = specular_color * ((exponent + 2.0) / (2.0 * pi) * pow(max(c, 0.0), exponent));
    return mix(albedo / pi, gloss, reflectivity);
}
