// The sky that lights the terrain, and the sun's disc, exposed, sRGB.
uniform sampler2D osgTerrainLight_sky; // radiance, laid out as Environment::radiance
uniform vec2 osgTerrainLight_skyTurn;  // heading [rad], gain
uniform vec4 osgTerrainLight_sunDisc;  // unit vector to the sun; its radius [rad], 0: no sun
uniform vec3 osgTerrainLight_sunRadiance;
uniform float osgTerrainLight_exposure;

varying vec3 towards;

const float TURN = 6.283185307179586;

void main()
{
    vec3 direction = normalize(towards);
    float around = atan(direction.y, direction.x) + osgTerrainLight_skyTurn.x;
    float height = atan(direction.z, length(direction.xy));
    // Without mipmaps, so that the step of a whole turn makes no seam.
    vec3 radiance = osgTerrainLight_skyTurn.y *
                    texture2D(osgTerrainLight_sky, vec2(around, 2.0 * height) / TURN +
                                                       vec2(0.0, 0.5)).rgb;
    // The chord is the angle, for so small a disc. Its edge is a pixel wide.
    float away = length(direction - osgTerrainLight_sunDisc.xyz);
    float pixel = max(fwidth(away), 1.0e-6);
    float disc = clamp((osgTerrainLight_sunDisc.w - away) / pixel + 0.5, 0.0, 1.0);
    if (osgTerrainLight_sunDisc.w > 0.0)
        radiance += disc * osgTerrainLight_sunRadiance;
    // A step of 8 bits is wide in an even sky: half a step of noise hides it (Jimenez 2014).
    float noise =
        fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
    vec3 colour = srgbOfLinear(radiance * osgTerrainLight_exposure);
    gl_FragColor = vec4(colour + noise / 255.0, 1.0);
}
