// Of DynamicTerrain: a grid whose vertices are posts; set 7 holds their tile coordinates.
varying vec2 shadingCoordinate;
varying vec2 colourCoordinate;
varying vec3 eyePosition;
varying float hole; // > 0: the triangle has a void corner

vec2 terrainShadingCoordinate(vec4 source);
#ifdef GLOSS
varying vec3 toViewer;
vec3 directionToViewer(vec4 vertex);
#endif
vec2 terrainHeight(vec2 tileCoordinate);

void main()
{
    vec2 height = terrainHeight(gl_MultiTexCoord7.xy);
    vec4 vertex = vec4(gl_Vertex.xy, height.x, 1.0);
    shadingCoordinate = terrainShadingCoordinate(gl_MultiTexCoord7);
    colourCoordinate = gl_MultiTexCoord7.xy;
    hole = height.y;
#ifdef GLOSS
    toViewer = directionToViewer(vertex);
#endif
    gl_ClipVertex = gl_ModelViewMatrix * vertex;
    eyePosition = gl_ClipVertex.xyz;
    gl_Position = gl_ModelViewProjectionMatrix * vertex;
}
