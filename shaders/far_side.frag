// The faces that look away from the eye, where they are not missing: outward normal, and depth along
// the view.
in vec2 vertex_texcoord;
out vec4 color;

void main() {
#if CUT_OUTS
    readSurface(vertex_texcoord, dFdx(vertex_texcoord), dFdy(vertex_texcoord));
    if (isMissing(surface_alpha)) discard;
#endif
    color = vec4(meshNormal(), 1.0 / gl_FragCoord.w);
}
