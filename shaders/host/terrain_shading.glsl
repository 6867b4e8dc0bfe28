// What a host shader calls to light its terrain: colour = albedo * terrainShading(...).rgb.
// Works in vertex and fragment shaders from GLSL 1.20 on; the host puts #version first.

// RGBA16F: rgb = irradiance / pi, a = visible sun, 0 ... 1
uniform sampler2D osgTerrainLight_shading;
uniform mat4 osgTerrainLight_matrix;       // source to texture coordinates, posts at texel centres

// Where shadow edges are on: the sun's shadow between posts.
uniform bool osgTerrainLight_hasEdges;
// RGBA16F: height over the shadow, softness of its edge [m], irradiance / pi over the sun's
// irradiance where nothing shades, 1 or 0.5; 0 where void
uniform sampler2D osgTerrainLight_edges;
uniform vec2 osgTerrainLight_posts;         // texels of it
uniform vec3 osgTerrainLight_sunIrradiance; // on a surface that faces the sun

// Until the tile's own light is there, and while it fades in: the light that the tile had before,
// or that of a tile above it.
uniform float osgTerrainLight_formerPart;      // of the former light, 1 ... 0; at 0 it is not read
uniform sampler2D osgTerrainLight_former;      // as osgTerrainLight_shading
uniform mat4 osgTerrainLight_formerMatrix;     // from the tile's texture coordinates to its own
uniform sampler2D osgTerrainLight_formerEdges; // as osgTerrainLight_edges
uniform vec2 osgTerrainLight_formerPosts;      // texels of them; 0 where there are none

// Along borders with tiles of a coarser level: more of the former light, that of a tile above.
uniform bool osgTerrainLight_hasBorders;
uniform vec4 osgTerrainLight_borders;       // parts of it: west, south, east, north
uniform vec4 osgTerrainLight_borderCorners; // south-west, south-east, north-west, north-east
uniform vec4 osgTerrainLight_drawn;         // texture coordinates of the outermost posts: low, high
uniform vec2 osgTerrainLight_bands;         // of 8 posts, in the texture

// What placed objects leave of the light, in texels of its own around each cluster of them.
uniform int osgTerrainLight_objectCount; // of clusters on the tile, 0 ... 8
// RGBA16F: of rgb, and of the visible sun; the clusters stand one below the other
uniform sampler2D osgTerrainLight_objects;
// from the tile's texture coordinates to its own: scale, offset; and the corners they must be in
uniform vec4 osgTerrainLight_objectPlaces[8];
uniform vec4 osgTerrainLight_objectCorners[8];

// source: vec4 of what the tile was bound with, the vertex position or the tile coordinates, which
// run from (0, 0) at the south-western post to (1, 1) at the north-eastern one. Affine: may be
// computed per vertex.
vec2 terrainShadingCoordinate(vec4 source)
{
    return (osgTerrainLight_matrix * source).xy;
}

vec4 terrainTexel(sampler2D map, vec2 coordinate)
{
#if __VERSION__ >= 130
    return texture(map, coordinate);
#else
    return texture2D(map, coordinate);
#endif
}

// Visible fraction of the sun: of a disc that stands edge.x / edge.y of its radii over a straight
// horizon (lib/shadow.glsl, discFraction).
float terrainSunSeen(vec4 edge)
{
    float x = clamp(edge.x / max(edge.y, 1.0e-4), -1.0, 1.0);
    return 0.5 + x * (0.6366 - x * x * (0.1017 + x * x * 0.0349));
}

// How much more of the sun a place sees than is found between the posts' fractions, and the
// irradiance / pi of all of it. The height over the shadow is bilinear; the fraction is not.
vec2 terrainShadowEdge(sampler2D edges, vec2 posts, vec2 coordinate)
{
    vec2 place = coordinate * posts - 0.5;
    vec2 first = clamp(floor(place), vec2(0.0), max(posts - 2.0, 0.0));
    vec2 weight = clamp(place - first, 0.0, 1.0);
    vec2 low = (first + 0.5) / posts;
    vec2 high = low + 1.0 / posts;
    vec4 southWest = terrainTexel(edges, low);
    vec4 southEast = terrainTexel(edges, vec2(high.x, low.y));
    vec4 northWest = terrainTexel(edges, vec2(low.x, high.y));
    vec4 northEast = terrainTexel(edges, high);
    vec4 weights = vec4((1.0 - weight.x) * (1.0 - weight.y), weight.x * (1.0 - weight.y),
                        (1.0 - weight.x) * weight.y, weight.x * weight.y);
    mat4 corners = mat4(southWest, southEast, northWest, northEast);
    vec4 seen = vec4(terrainSunSeen(southWest), terrainSunSeen(southEast),
                     terrainSunSeen(northWest), terrainSunSeen(northEast));
    vec4 here = corners * weights;
    // A post that sees all of the sun may know nearer ground instead of the crest whose shadow ends
    // beside it. An edge is no sharper there than nearer to its crest.
    vec4 softness = vec4(southWest.y, southEast.y, northWest.y, northEast.y);
    vec4 shaded = weights * (1.0 - seen);
    float least = dot(shaded, softness) / max(dot(shaded, vec4(1.0)), 1.0e-3);
    here.y = dot(weights, mix(softness, max(softness, vec4(least)), seen));
    float between = dot(weights, seen);
    // Along the sides of a high wall's shadow, where a post only knows that it is deep in it, and
    // beside voids, the posts' fractions stand.
    vec4 known = vec4(southWest.a, southEast.a, northWest.a, northEast.a);
    if (min(min(known.x, known.y), min(known.z, known.w)) < 0.25)
        return vec2(0.0);
    float certain = 2.0 * dot(weights, known) - 1.0;
    return vec2((terrainSunSeen(here) - between) * certain * certain, here.z);
}

// Light with the edge of the sun's shadow: no more sunlight goes than is there, nor comes than can
// be.
vec4 terrainAtEdge(vec4 shading, vec2 edge)
{
    float seen = clamp(shading.a + edge.x, 0.0, 1.0);
    vec3 change = osgTerrainLight_sunIrradiance * ((seen - shading.a) * edge.y);
    return vec4(max(shading.rgb + change, 0.0), seen);
}

vec4 terrainOwnShading(vec2 coordinate)
{
    vec4 shading = terrainTexel(osgTerrainLight_shading, coordinate);
    if (!osgTerrainLight_hasEdges)
        return shading;
    return terrainAtEdge(shading, terrainShadowEdge(osgTerrainLight_edges, osgTerrainLight_posts,
                                                    coordinate));
}

vec4 terrainFormerShading(vec2 coordinate)
{
    vec2 place = (osgTerrainLight_formerMatrix * vec4(coordinate, 0.0, 1.0)).xy;
    vec4 shading = terrainTexel(osgTerrainLight_former, place);
    if (osgTerrainLight_formerPosts.x < 1.0)
        return shading;
    return terrainAtEdge(shading, terrainShadowEdge(osgTerrainLight_formerEdges,
                                                    osgTerrainLight_formerPosts, place));
}

// What objects leave of the light: 1 where there are none. seen: visible fraction of the sun
// without them. Clusters hide different parts of the sky, so their factors multiply; but where the
// shadows of two meet, the sun is gone once, and the darker one counts.
vec4 terrainObjects(vec2 coordinate, float seen)
{
    vec4 left = vec4(1.0);
    for (int i = 0; i < osgTerrainLight_objectCount; ++i)
    {
        vec4 toOwn = osgTerrainLight_objectPlaces[i];
        vec4 corners = osgTerrainLight_objectCorners[i];
        vec2 place = coordinate * toOwn.xy + toOwn.zw;
        if (place.x > corners.x && place.y > corners.y && place.x < corners.z &&
            place.y < corners.w)
        {
            vec4 here = terrainTexel(osgTerrainLight_objects, place);
            // What they send adds up.
            vec4 both = min(left, 1.0) * min(here, 1.0) *
                        (max(left, 1.0) + max(here, 1.0) - 1.0);
            left = mix(both, min(left, here), seen * (1.0 - left.a) * (1.0 - here.a));
        }
    }
    return left;
}

// Part of the former light, 0 ... 1: that of all of the tile, and more along borders, whose part
// falls smoothly over a band. The largest counts: two tiles that meet have the same along their
// border.
float terrainFormerPart(vec2 coordinate)
{
    if (!osgTerrainLight_hasBorders)
        return osgTerrainLight_formerPart;
    vec2 low = max((coordinate - osgTerrainLight_drawn.xy) * osgTerrainLight_bands, 0.0);
    vec2 high = max((osgTerrainLight_drawn.zw - coordinate) * osgTerrainLight_bands, 0.0);
    vec4 corners = vec4(length(low), length(vec2(high.x, low.y)), length(vec2(low.x, high.y)),
                        length(high));
    vec4 most = max(osgTerrainLight_borders * (1.0 - smoothstep(0.0, 1.0, vec4(low, high))),
                    osgTerrainLight_borderCorners * (1.0 - smoothstep(0.0, 1.0, corners)));
    most.xy = max(most.xy, most.zw);
    return max(osgTerrainLight_formerPart, max(most.x, most.y));
}

vec4 terrainFadedShading(vec2 coordinate)
{
    float part = terrainFormerPart(coordinate);
    if (part <= 0.0)
        return terrainOwnShading(coordinate);
    vec4 former = terrainFormerShading(coordinate);
    // Light that is not computed yet may be anything, NaN too.
    if (part >= 1.0)
        return former;
    return mix(terrainOwnShading(coordinate), former, part);
}

// Scene-linear. Bilinear between posts, but for the edge of the sun's shadow where it is on.
vec4 terrainShading(vec2 coordinate)
{
    vec4 shading = terrainFadedShading(coordinate);
    if (osgTerrainLight_objectCount > 0)
        shading *= terrainObjects(coordinate, shading.a);
    return shading;
}
