// Stock osgTerrain tiles: colour layer 0 has texture coordinate set 0.
uniform bool osgTerrainLight_fromVertex;

varying vec2 shadingCoordinate;
varying vec2 colourCoordinate;

vec2 terrainShadingCoordinate(vec4 source);

void main()
{
    shadingCoordinate =
        terrainShadingCoordinate(osgTerrainLight_fromVertex ? gl_Vertex : gl_MultiTexCoord7);
    colourCoordinate = gl_MultiTexCoord0.xy;
    gl_ClipVertex = gl_ModelViewMatrix * gl_Vertex;
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
