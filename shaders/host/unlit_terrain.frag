// DynamicTerrain without light: its colours under a lamp at the eye, so that its shape is seen.
uniform sampler2D osgTerrainLight_colour;
uniform bool osgTerrainLight_hasColour;

varying vec2 colourCoordinate;
varying vec3 eyePosition;
varying float hole;

void main()
{
    if (hole > 0.0)
        discard;
    vec4 colour = vec4(1.0);
    if (osgTerrainLight_hasColour)
        colour = texture2D(osgTerrainLight_colour, colourCoordinate);
    vec3 normal = normalize(cross(dFdx(eyePosition), dFdy(eyePosition)));
    gl_FragColor = vec4(colour.rgb * abs(normal.z), colour.a);
}
