// The upper half of an environment, turned, as the picture of a sky: each texel has the mean
// radiance of what it covers, weighed by solid angle, so that none of the light is lost however
// small a source is.
layout(local_size_x = 8, local_size_y = 8) in;

// RGB32F, radiance: columns counter-clockwise from east, rows from the nadir to the zenith, of
// equal angles.
uniform sampler2D environment;
// RGBA32F, rgb = radiance: columns counter-clockwise from east, rows upwards from the horizontal to
// the zenith, both of equal angles.
layout(rgba32f, binding = 0) writeonly uniform image2D sky;
uniform float heading; // [rad], clockwise, -pi ... pi
uniform float gain;

void main()
{
    ivec2 texel = ivec2(INVOCATION.xy);
    ivec2 size = imageSize(sky);
    if (texel.x >= size.x || texel.y >= size.y)
        return;
    ivec2 from = textureSize(environment, 0);
    // In texels of the environment; it is turned by so many that a sky's columns begin elsewhere.
    float turn = (heading / (2.0 * PI) + 1.0) * float(from.x); // never negative: % wants none
    float left = float(texel.x) / float(size.x) * float(from.x) + turn;
    float right = float(texel.x + 1) / float(size.x) * float(from.x) + turn;
    float low = (0.5 + 0.5 * float(texel.y) / float(size.y)) * float(from.y);
    float high = (0.5 + 0.5 * float(texel.y + 1) / float(size.y)) * float(from.y);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int row = int(floor(low)); row < min(int(ceil(high)), from.y); ++row)
    {
        // Of sin(elevation), about the middle of the part: a difference of two sines would lose
        // digits.
        float bottom = max(float(row), low);
        float top = min(float(row + 1), high);
        float middle = 0.5 * (bottom + top) / float(from.y) * PI - HALF_PI;
        float band = sin(0.5 * (top - bottom) / float(from.y) * PI) * cos(middle);
        vec3 across = vec3(0.0);
        for (int column = int(floor(left)); column < int(ceil(right)); ++column)
        {
            float part = min(float(column + 1), right) - max(float(column), left);
            int wrapped = column % from.x;
            across += part * texelFetch(environment, ivec2(wrapped, row), 0).rgb;
        }
        sum += band * across;
        weights += band * (right - left);
    }
    imageStore(sky, texel, vec4(gain * sum / weights, 1.0));
}
