// Colour and texture (sRGB, as pictures are) times light, exposed, sRGB.
uniform sampler2D osgTerrainLight_colour;
uniform vec3 osgTerrainLight_objectEmission; // radiance
uniform float osgTerrainLight_exposure; // multiplies the scene-linear colour

varying vec3 eyePlace;
varying vec3 eyeNormal;
varying vec4 surfaceColour;
varying vec2 colourCoordinate;

vec4 terrainObjectLight(vec3 place, vec3 normal);

void main()
{
    vec4 picture = texture2D(osgTerrainLight_colour, colourCoordinate);
    vec3 colour =
        linearOfSrgb(clamp(surfaceColour.rgb, 0.0, 1.0)) * linearOfSrgb(picture.rgb);
    vec3 normal = dot(eyeNormal, eyeNormal) > 0.0 ? eyeNormal
                                                  : cross(dFdx(eyePlace), dFdy(eyePlace));
    vec3 sent =
        colour * terrainObjectLight(eyePlace, normal).rgb + osgTerrainLight_objectEmission;
    gl_FragColor =
        vec4(srgbOfLinear(sent * osgTerrainLight_exposure), surfaceColour.a * picture.a);
}
