// Only depth is wanted, where the surface is not cut out.
in vec2 vertex_texcoord;

void main() {
#if CUT_OUTS
    readSurface(vertex_texcoord, dFdx(vertex_texcoord), dFdy(vertex_texcoord));
    if (surface_alpha < alpha_cutoff) discard;
#endif
}
