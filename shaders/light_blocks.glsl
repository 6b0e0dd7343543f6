// The lights of a sample, of a batch of the scene's lights, and the shadow maps of the batch. Defined:
// LIGHT_CAPACITY; LOCAL_LIGHTS, whether point and spot lights are among them; SHADOW_MAPS, whether the object
// casts its shadow by maps. Without maps it is a sphere.
struct Light {
    vec4 place;    // unit, towards the light (w = 0); or its position (w = 1)
    vec4 strength; // irradiance of a surface that faces the light; or intensity
    vec4 axis;     // of a spot: where it shines; w: scale of its cone
    vec4 maps;     // first layer, number of layers, a texel's side, offset of the cone
};
struct View {
    mat4 map_from_world;    // texels and depth, after division by w
    vec4 world_from_map[4]; // rows of the inverse, as row vectors multiply
    vec4 light;             // x: whose, where LOCAL_LIGHTS; y, z: of a directional light, the change of depth
                            // with u and v in texels over that of the distance along the light, times
                            // texels a unit
};
layout(std140, binding = 0) uniform Lights { Light lights[LIGHT_CAPACITY]; };
layout(std140, binding = 1) uniform Views { View views[LIGHT_CAPACITY]; };
