// Light from all around: spherical harmonics of any order up to 6, the kernels that they are
// convolved with, and the directions of a cube map (King 2005).
//
// The basis is that of legendre.glsl, continued: real, without the sign (-1)^m, (l, m) at l (l + 1)
// + m.

// The basis at a direction, of order 6: the first 4, 9, 16, 25 are that of a lower order.
struct ShTerms
{
    real y[36];
};

// d: unit (x east, y north, z up). Y of (l, +-m) is a polynomial in z, by the recurrence of the
// normalised associated Legendre functions less their power of sin(zenith angle), times the real
// and the imaginary part of (x + i y)^m: no angle is needed, and nothing is divided by at the
// poles. The recurrence's numbers are sqrt((4 l^2 - 1) / (l^2 - m^2)) and that times sqrt(((l -
// 1)^2 - m^2) / (4 (l - 1)^2 - 1)); it begins with Y of (m, m). Written out: a loop would index the
// array by what compilers take for unknown.
ShTerms shTerms(vec3 d)
{
    GLSL_ASSERT(isUnit(d));
    ShTerms terms;
    real q0 = real(0.28209479177387813964);
    terms.y[0] = q0;
    real q1 = real(1.73205080756887719318) * d.z * q0;
    terms.y[2] = q1;
    real q2 = real(1.93649167310370851069) * d.z * q1 - real(1.11803398874989490253) * q0;
    terms.y[6] = q2;
    real q3 = real(1.97202659436653870983) * d.z * q2 - real(1.01835015443463094975) * q1;
    terms.y[12] = q3;
    real q4 = real(1.98431348329844303713) * d.z * q3 - real(1.00623058987490554550) * q2;
    terms.y[20] = q4;
    real q5 = real(1.98997487421323993040) * d.z * q4 - real(1.00285307284481395307) * q3;
    terms.y[30] = q5;
    real cosine = d.x;
    real sine = d.y;
    q0 = real(0.48860251190291986712);
    terms.y[1] = q0 * sine;
    terms.y[3] = q0 * cosine;
    q1 = real(2.23606797749978980505) * d.z * q0;
    terms.y[5] = q1 * sine;
    terms.y[7] = q1 * cosine;
    q2 = real(2.09165006633518890666) * d.z * q1 - real(0.93541434669348533237) * q0;
    terms.y[11] = q2 * sine;
    terms.y[13] = q2 * cosine;
    q3 = real(2.04939015319191986109) * d.z * q2 - real(0.97979589711327130797) * q1;
    terms.y[19] = q3 * sine;
    terms.y[21] = q3 * cosine;
    q4 = real(2.03100960115899020764) * d.z * q3 - real(0.99103120896511498472) * q2;
    terms.y[29] = q4 * sine;
    terms.y[31] = q4 * cosine;
    real turned = cosine * d.x - sine * d.y;
    sine = sine * d.x + cosine * d.y;
    cosine = turned;
    q0 = real(0.54627421529603947814);
    terms.y[4] = q0 * sine;
    terms.y[8] = q0 * cosine;
    q1 = real(2.64575131106459071617) * d.z * q0;
    terms.y[10] = q1 * sine;
    terms.y[14] = q1 * cosine;
    q2 = real(2.29128784747791991450) * d.z * q1 - real(0.86602540378443859659) * q0;
    terms.y[18] = q2 * sine;
    terms.y[22] = q2 * cosine;
    q3 = real(2.17124059336723762570) * d.z * q2 - real(0.94760708295868556483) * q1;
    terms.y[28] = q3 * sine;
    terms.y[32] = q3 * cosine;
    turned = cosine * d.x - sine * d.y;
    sine = sine * d.x + cosine * d.y;
    cosine = turned;
    q0 = real(0.59004358992664351913);
    terms.y[9] = q0 * sine;
    terms.y[15] = q0 * cosine;
    q1 = real(3.00000000000000000000) * d.z * q0;
    terms.y[17] = q1 * sine;
    terms.y[23] = q1 * cosine;
    q2 = real(2.48746859276654985749) * d.z * q1 - real(0.82915619758884995250) * q0;
    terms.y[27] = q2 * sine;
    terms.y[33] = q2 * cosine;
    turned = cosine * d.x - sine * d.y;
    sine = sine * d.x + cosine * d.y;
    cosine = turned;
    q0 = real(0.62583573544917603382);
    terms.y[16] = q0 * sine;
    terms.y[24] = q0 * cosine;
    q1 = real(3.31662479035539980998) * d.z * q0;
    terms.y[26] = q1 * sine;
    terms.y[34] = q1 * cosine;
    turned = cosine * d.x - sine * d.y;
    sine = sine * d.x + cosine * d.y;
    cosine = turned;
    q0 = real(0.65638205684017003616);
    terms.y[25] = q0 * sine;
    terms.y[35] = q0 * cosine;
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
    GLSL_ASSERT(s >= real(1.0));
    ShBands bands;
    bands.b[0] = real(1.0);
    bands.b[1] = (s + real(1.0)) / (s + real(2.0));
    for (int l = 2; l < 6; ++l)
        bands.b[l] = bands.b[l - 2] * (s - real(l - 2)) / (s + real(l + 1));
    return bands;
}

// Direction, not of unit length, to a place on a face of an OpenGL cube map, +x, -x, +y, -y, +z,
// -z: across and down, -1 ... 1 (OpenGL 4.3, table 8.18).
vec3 cubeDirection(int face, real across, real down)
{
    GLSL_ASSERT(face >= 0 && face < 6);
    GLSL_ASSERT(max(abs(across), abs(down)) <= real(1.0));
    real side = face % 2 == 0 ? real(1.0) : real(-1.0);
    vec3 d = vec3(side, -down, -side * across);
    if (face / 2 == 1)
        d = vec3(across, side, side * down);
    if (face / 2 == 2)
        d = vec3(side * across, -down, side);
    return d;
}
