// Stock osgTerrain tiles: colour layer 0 has texture coordinate set 0.
uniform bool osgTerrainLight_fromVertex;

varying vec2 shadingCoordinate;
varying vec2 colourCoordinate;

vec2 terrainShadingCoordinate(vec4 source);
#ifdef GLOSS
varying vec3 toViewer;
vec3 directionToViewer(vec4 vertex);
#endif

void main()
{
    shadingCoordinate =
        terrainShadingCoordinate(osgTerrainLight_fromVertex ? gl_Vertex : gl_MultiTexCoord7);
    colourCoordinate = gl_MultiTexCoord0.xy;
#ifdef GLOSS
    toViewer = directionToViewer(gl_Vertex);
#endif
    gl_ClipVertex = gl_ModelViewMatrix * gl_Vertex;
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
