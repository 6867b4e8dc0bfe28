// Light from all around: spherical harmonics of any order up to 6, the kernels that they are convolved
// with, and the directions of a cube map (King 2005).
//
// The basis is that of legendre.glsl, continued: real, without the sign (-1)^m, (l, m) at l (l + 1) + m.

// The basis at a direction; those from the order's square on are 0.
struct ShTerms
{
    real y[36];
};

// d: unit (x east, y north, z up). order: 1 ... 6. Y of (l, +-m) is a polynomial in z, by the recurrence of
// the normalised associated Legendre functions less their power of sin(zenith angle), times the real and
// the imaginary part of (x + i y)^m: no angle is needed, and nothing is divided by at the poles.
ShTerms shTerms(vec3 d, int order)
{
    ShTerms terms;
    for (int i = 0; i < 36; ++i)
        terms.y[i] = real(0.0);
    real cosine = real(1.0);
    real sine = real(0.0);
    real first = real(0.28209479177387814347); // of l = m
    for (int m = 0; m < order; ++m)
    {
        real before = real(0.0);
        real here = first;
        for (int l = m; l < order; ++l)
        {
            terms.y[l * (l + 1) - m] = here * sine;
            terms.y[l * (l + 1) + m] = here * cosine; // after the other: m = 0 has no sine
            real back = sqrt(max(real(l * l - m * m), real(0.0)) / max(real(4 * l * l - 1), real(1.0)));
            real next = real((l + 1) * (l + 1));
            real on = sqrt((real(4.0) * next - real(1.0)) / (next - real(m * m)));
            next = on * (d.z * here - back * before);
            before = here;
            here = next;
        }
        real turned = cosine * d.x - sine * d.y;
        sine = sine * d.x + cosine * d.y;
        cosine = turned;
        // sqrt(2) once, as cos and sin have half the square that 1 has.
        first = first * sqrt(real(2 * m + 3) / real(2 * m + 2) * (m == 0 ? real(2.0) : real(1.0)));
    }
    return terms;
}

// What a convolution multiplies each band l by.
struct ShBands
{
    real b[6];
};

// Of max(cosine, 0): pi, 2 pi / 3, pi / 4, 0, -pi / 24, 0.
ShBands lambertBands()
{
    ShBands bands;
    bands.b[0] = PI;
    bands.b[1] = real(2.0) * PI / real(3.0);
    bands.b[2] = PI / real(4.0);
    bands.b[3] = real(0.0);
    bands.b[4] = -PI / real(24.0);
    bands.b[5] = real(0.0);
    return bands;
}

// Of the Phong lobe (s + 1) / (2 pi) max(cosine, 0)^s, which integrates to 1. s >= 1; exact.
ShBands phongBands(real s)
{
    ShBands bands;
    bands.b[0] = real(1.0);
    bands.b[1] = (s + real(1.0)) / (s + real(2.0));
    for (int l = 2; l < 6; ++l)
        bands.b[l] = bands.b[l - 2] * (s - real(l - 2)) / (s + real(l + 1));
    return bands;
}

// Direction, not of unit length, to a place on a face of an OpenGL cube map, +x, -x, +y, -y, +z, -z: across
// and down, -1 ... 1 (OpenGL 4.3, table 8.18).
vec3 cubeDirection(int face, real across, real down)
{
    real side = face % 2 == 0 ? real(1.0) : real(-1.0);
    vec3 d = vec3(side, -down, -side * across);
    if (face / 2 == 1)
        d = vec3(across, side, side * down);
    if (face / 2 == 2)
        d = vec3(side * across, -down, side);
    return d;
}
