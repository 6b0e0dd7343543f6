// Only depth is wanted, where the surface is not missing.
in vec2 vertex_texcoord;

void main() {
#if CUT_OUTS
    readSurface(vertex_texcoord, dFdx(vertex_texcoord), dFdy(vertex_texcoord));
    if (isMissing(surface_alpha)) discard;
#endif
}
