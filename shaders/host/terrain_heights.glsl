// What a host shader calls to move the vertices of terrain whose heights change. Works from GLSL
// 3.30 on; the host puts #version first.

// R32F [m above heightOrigin], one texel per post, row 0 south
uniform sampler2D osgTerrainLight_heights;

// tileCoordinate: (0, 0) at the south-western post, (1, 1) at the north-eastern one; the nearest
// post counts. x: its height [m above heightOrigin]. y: 1 where it is void, and x is then 0.
vec2 terrainHeight(vec2 tileCoordinate)
{
    vec2 last = vec2(textureSize(osgTerrainLight_heights, 0) - 1);
    float height = texelFetch(osgTerrainLight_heights, ivec2(tileCoordinate * last + 0.5), 0).x;
    // By the bits: a compiler may drop a test for NaN, whose bits are beyond those of every number.
    bool valid = (floatBitsToUint(height) & 0x7fffffffu) <= floatBitsToUint(1.0e6);
    return valid ? vec2(height, 0.0) : vec2(0.0, 1.0);
}
