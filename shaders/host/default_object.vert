// A placed object without shaders of its own, as a model of the fixed pipeline.
uniform bool osgTerrainLight_materialColour; // its material's colour counts, not its vertices'

varying vec3 eyePlace;
varying vec3 eyeNormal;
varying vec4 surfaceColour;
varying vec2 colourCoordinate;

void main()
{
    vec4 place = gl_ModelViewMatrix * gl_Vertex;
    eyePlace = place.xyz / place.w;
    eyeNormal = gl_NormalMatrix * gl_Normal;
    surfaceColour = osgTerrainLight_materialColour ? gl_FrontMaterial.diffuse : gl_Color;
    colourCoordinate = (gl_TextureMatrix[0] * gl_MultiTexCoord0).xy;
    gl_ClipVertex = place;
    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
