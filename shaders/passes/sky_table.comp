// The light of a sky of any radiance, slice by slice of azimuth and from the zenith down to any
// angle, as a vector whose product with a normal is the irradiance: TW10 Eq. 6 and 7, whose table
// has the normal's angle as a second dimension. It needs none: a slice's light ends at the horizon
// or where it meets the surface's plane, whichever is higher, and above that angle irradiance is
// linear in the normal.
layout(local_size_x = 16) in;

// RGBA32F, rgb = radiance of a texel: columns counter-clockwise from east, an even number per
// slice; rows upwards from the horizontal to the zenith; both of equal angles.
uniform sampler2D sky;
// A third of the rows each for red, green, blue; column k = slice about 2*pi*k/m from east; a
// third's first row is the zenith, its last one the horizontal. xyz over pi.
layout(rgba32f, binding = 0) writeonly uniform image2D skyTable;
uniform int azimuths;

void main()
{
    int k = int(INVOCATION.x);
    if (k >= azimuths)
        return;
    ivec2 size = textureSize(sky, 0);
    int columns = size.x / azimuths;
    float width = 2.0 * PI / float(size.x);
    mat3 sum = mat3(0.0); // a vector per colour
    for (int c = 0; c < 3; ++c)
        imageStore(skyTable, ivec2(k, c * (size.y + 1)), vec4(0.0));
    for (int row = 0; row < size.y; ++row)
    {
        // The integrals of cos sin and of sin^2 over the row, halved, and of 1, cos and sin over a
        // column.
        Angle top = HALF_PI * float(row) / float(size.y);
        Angle bottom = HALF_PI * float(row + 1) / float(size.y);
        float upward = 0.5 * (sin(bottom) * sin(bottom) - sin(top) * sin(top));
        float outward = 0.5 * (bottom - top - sin(bottom) * cos(bottom) + sin(top) * cos(top));
        for (int i = 0; i < columns; ++i)
        {
            int column = (k * columns - columns / 2 + i + size.x) % size.x;
            Angle right = width * float(column);
            Angle left = width * float(column + 1);
            vec3 vector = vec3(outward * (sin(left) - sin(right)),
                               outward * (cos(right) - cos(left)), upward * width);
            vec3 radiance = texelFetch(sky, ivec2(column, size.y - 1 - row), 0).rgb;
            for (int c = 0; c < 3; ++c)
                sum[c] += radiance[c] * vector;
        }
        for (int c = 0; c < 3; ++c)
            imageStore(skyTable, ivec2(k, c * (size.y + 1) + row + 1), vec4(sum[c] / PI, 0.0));
    }
}
