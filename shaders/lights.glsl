// All kinds of light together: the one place where passes meet them, and where a new kind is added.

// Irradiance / pi of a post as a surface of a normal. sky: what the sky gives; sunFraction: what is
// visible of the disc.
vec3 directLight(ivec2 post, vec3 normal, vec3 sky, float sunFraction)
{
    vec3 light = sky;
    light += keyLight(post, normal);
    light += sunLight(normal, sunFraction);
    return light;
}

// Adds what a post receives in harmonics, per colour: all but sky and sun.
ShVector[3] addDirectHarmonics(ShVector incident[3], ivec2 post, vec3 normal)
{
    return addKeyHarmonics(incident, post, normal);
}
