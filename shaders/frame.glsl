// Where a tile's pixel stands in the whole frame.
uniform ivec2 frame_size;
uniform ivec2 tile_origin;

ivec2 framePixel() { return tile_origin + ivec2(gl_FragCoord.xy); }
