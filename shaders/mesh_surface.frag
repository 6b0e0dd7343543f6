// A triangle mesh with interpolated normals, seen from either side.
in vec3 vertex_position;
in vec2 vertex_texcoord;
layout(location = 0) out vec4 color;

void main() {
    vec2 dx = dFdx(vertex_texcoord), dy = dFdy(vertex_texcoord);
    readSurface(vertex_texcoord, dx, dy);
    vec3 normal = bentNormal(meshNormal(), vertex_position, vertex_texcoord, dx, dy);
    surface_depth = 1.0 / gl_FragCoord.w;
    surface_outside = gl_FrontFacing;
    surface_point = vertex_position;
    vec3 facet = normalize(cross(dFdx(vertex_position), dFdy(vertex_position)));
    facet_normal = dot(facet, viewRay()) > 0.0 ? -facet : facet;
    if (isMissing(surface_alpha)) discard;
    vec3 radiance = shade(gl_FrontFacing ? normal : -normal, normalize(viewRay()));
    color = vec4(radiance + surface_emission, 1.0);
}
