// Colour layer (sRGB, as pictures are; white where there is none) times shading, exposed, sRGB.
uniform sampler2D osgTerrainLight_colour;
uniform bool osgTerrainLight_hasColour;
uniform float osgTerrainLight_exposure; // multiplies the scene-linear colour

varying vec2 shadingCoordinate;
varying vec2 colourCoordinate;
#ifdef HOLES
varying float hole; // > 0: the triangle has a void corner
#endif

vec4 terrainShading(vec2 coordinate);
#ifdef GLOSS
varying vec3 toViewer;
vec3 terrainGloss(vec2 coordinate, vec3 toViewer);
#endif

void main()
{
#ifdef HOLES
    if (hole > 0.0)
        discard;
#endif
    vec4 colour = vec4(1.0);
    if (osgTerrainLight_hasColour)
        colour = texture2D(osgTerrainLight_colour, colourCoordinate);
    vec3 sent = linearOfSrgb(colour.rgb) * terrainShading(shadingCoordinate).rgb;
#ifdef GLOSS
    sent += terrainGloss(shadingCoordinate, normalize(toViewer));
#endif
    gl_FragColor = vec4(srgbOfLinear(sent * osgTerrainLight_exposure), colour.a);
}
