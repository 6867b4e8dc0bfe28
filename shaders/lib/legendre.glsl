// Functions of elevation in normalised Legendre polynomials, and of direction in spherical
// harmonics (SH), both of order 4 (NS09, sections 4, 6, 7 and appendix).
//
// A slice: the function of z = cos(zenith angle) = sin(elevation) at one azimuth, as vec4: its
// coefficients in the polynomials of legendre(z).
// SH are real, without the sign (-1)^m: Y of (l, m) = (1, -1), (1, 0), (1, 1) are 0.4886 times y,
// z, x. cos(m azimuth) goes with +m, sin(m azimuth) with -m; azimuth counter-clockwise from east.

// 16 coefficients, (l, m) at index l*(l + 1) + m: c[0] holds (0,0) (1,-1) (1,0) (1,1), c[1] (2,-2)
// ... (2,1), c[2] (2,2) (3,-3) (3,-2) (3,-1), c[3] (3,0) ... (3,3).
struct ShVector
{
    vec4 c[4];
};

ShVector shZero()
{
    ShVector sh;
    for (int i = 0; i < 4; ++i)
        sh.c[i] = vec4(real(0.0), real(0.0), real(0.0), real(0.0));
    return sh;
}

// sum + weight * added
ShVector shAdd(ShVector sum, ShVector added, real weight)
{
    ShVector sh;
    for (int i = 0; i < 4; ++i)
        sh.c[i] = sum.c[i] + added.c[i] * weight;
    return sh;
}

// Integral of the product of two functions over the sphere.
real shDot(ShVector a, ShVector b)
{
    return dot(a.c[0], b.c[0]) + dot(a.c[1], b.c[1]) + dot(a.c[2], b.c[2]) + dot(a.c[3], b.c[3]);
}

// The basis at a unit direction (x east, y north, z up); also what it projects a unit of light from
// there to. The value of a function there is shDot(function, shBasis(d)).
ShVector shBasis(vec3 d)
{
    GLSL_ASSERT(isUnit(d));
    real x2 = d.x * d.x;
    real y2 = d.y * d.y;
    real z2 = d.z * d.z;
    real order1 = real(0.45704579946446573616) * (real(5.0) * z2 - real(1.0));
    ShVector sh;
    sh.c[0] =
        vec4(real(0.28209479177387814347), real(0.48860251190291992159) * d.y,
             real(0.48860251190291992159) * d.z, real(0.48860251190291992159) * d.x);
    sh.c[1] =
        vec4(real(1.09254843059207907054) * d.x * d.y, real(1.09254843059207907054) * d.y * d.z,
             real(0.31539156525252000603) * (real(3.0) * z2 - real(1.0)),
             real(1.09254843059207907054) * d.x * d.z);
    sh.c[2] = vec4(real(0.54627421529603953527) * (x2 - y2),
                   real(0.59004358992664351035) * d.y * (real(3.0) * x2 - y2),
                   real(2.89061144264055405539) * d.x * d.y * d.z, order1 * d.y);
    sh.c[3] = vec4(real(0.37317633259011539141) * d.z * (real(5.0) * z2 - real(3.0)), order1 * d.x,
                   real(1.44530572132027702769) * d.z * (x2 - y2),
                   real(0.59004358992664351035) * d.x * (x2 - real(3.0) * y2));
    return sh;
}

// Each band l times factors[l].
ShVector shScaleBands(ShVector sh, vec4 factors)
{
    ShVector scaled;
    scaled.c[0] = sh.c[0] * vec4(factors.x, factors.y, factors.y, factors.y);
    scaled.c[1] = sh.c[1] * factors.z;
    scaled.c[2] = sh.c[2] * vec4(factors.z, factors.w, factors.w, factors.w);
    scaled.c[3] = sh.c[3] * factors.w;
    return scaled;
}

// A function that is symmetric about the vertical, turned to be so about a unit direction. zonal:
// its coefficients (l, 0).
ShVector shOfZonal(vec4 zonal, vec3 direction)
{
    // sqrt(4 pi / (2 l + 1))
    return shScaleBands(shBasis(direction),
                        zonal * vec4(real(3.54490770181103205460), real(2.04665341589297697696),
                                     real(1.58533091904240440534), real(1.33984917138135754492)));
}

// The same from the kernel's eigenvalues: what a convolution with it multiplies each band by.
// Irradiance is shDot(light, shOfKernel(lambertEigenvalues(), normal)).
ShVector shOfKernel(vec4 eigenvalues, vec3 direction)
{
    return shScaleBands(shBasis(direction), eigenvalues);
}

vec4 zonalOfEigenvalues(vec4 eigenvalues)
{
    // sqrt((2 l + 1) / (4 pi))
    return eigenvalues * vec4(real(0.28209479177387814347), real(0.48860251190291992159),
                              real(0.63078313050504001206), real(0.74635266518023078283));
}

// Of max(cosine, 0): pi, 2 pi / 3, pi / 4, 0.
vec4 lambertEigenvalues()
{
    return vec4(PI, real(2.0) * PI / real(3.0), real(0.25) * PI, real(0.0));
}

// NS09, section 7: (0.886227, 1.023327, 0.495416, 0).
vec4 lambertZonal()
{
    return zonalOfEigenvalues(lambertEigenvalues());
}

// Of the Phong lobe (s + 1) / (2 pi) * max(cosine, 0)^s, which integrates to 1. s >= 1. Exact.
vec4 phongEigenvalues(real s)
{
    GLSL_ASSERT(s >= real(1.0));
    real first = (s + real(1.0)) / (s + real(2.0));
    return vec4(real(1.0), first, s / (s + real(3.0)),
                first * (s - real(1.0)) / (s + real(4.0)));
}

// The same as in NS09, section 7, for comparison with the paper. There it is a zonal vector, but
// with exp(-l^2 / 2s) for band l it is one of eigenvalues (a lobe that integrates to 1 has a zonal
// l = 0 of 0.28). For a large s, l = 1 is 1 - 1/2s where the exact one is 1 - 1/s.
vec4 phongEigenvaluesOfPaper(real s)
{
    GLSL_ASSERT(s >= real(1.0));
    return vec4(real(1.0), exp(real(-0.5) / s), exp(real(-2.0) / s), exp(real(-4.5) / s));
}

// The function turned about the vertical, counter-clockwise by the angle of the given cosine and
// sine.
ShVector shTurn(ShVector sh, real cosine, real sine)
{
    GLSL_ASSERT(isUnitPair(cosine, sine));
    real cosine2 = cosine * cosine - sine * sine;
    real sine2 = real(2.0) * cosine * sine;
    real cosine3 = cosine2 * cosine - sine2 * sine;
    real sine3 = sine2 * cosine + cosine2 * sine;
    vec4 c0 = sh.c[0];
    vec4 c1 = sh.c[1];
    vec4 c2 = sh.c[2];
    vec4 c3 = sh.c[3];
    ShVector turned;
    turned.c[0] = vec4(c0.x, cosine * c0.y + sine * c0.w, c0.z, cosine * c0.w - sine * c0.y);
    turned.c[1] = vec4(cosine2 * c1.x + sine2 * c2.x, cosine * c1.y + sine * c1.w, c1.z,
                       cosine * c1.w - sine * c1.y);
    turned.c[2] = vec4(cosine2 * c2.x - sine2 * c1.x, cosine3 * c2.y + sine3 * c3.w,
                       cosine2 * c2.z + sine2 * c3.z, cosine * c2.w + sine * c3.y);
    turned.c[3] = vec4(c3.x, cosine * c3.y - sine * c2.w, cosine2 * c3.z - sine2 * c2.z,
                       cosine3 * c3.w - sine3 * c2.y);
    return turned;
}

// The function with north and up exchanged, f(x, z, y).
ShVector shExchangeNorthUp(ShVector sh)
{
    // sqrt(3) / 2, and sqrt of 6, 10 and 15 over 4
    real r3 = real(0.86602540378443864676);
    real r6 = real(0.61237243569579452455);
    real r10 = real(0.79056941504209483300);
    real r15 = real(0.96824583655185422130);
    vec4 c0 = sh.c[0];
    vec4 c1 = sh.c[1];
    vec4 c2 = sh.c[2];
    vec4 c3 = sh.c[3];
    ShVector exchanged;
    exchanged.c[0] = vec4(c0.x, c0.z, c0.y, c0.w);
    exchanged.c[1] = vec4(c1.w, c1.y, real(-0.5) * c1.z - r3 * c2.x, c1.x);
    exchanged.c[2] = vec4(real(0.5) * c2.x - r3 * c1.z, r6 * c3.z - r10 * c3.x, c2.z,
                          -r6 * c3.x - r10 * c3.z);
    exchanged.c[3] = vec4(-r10 * c2.y - r6 * c2.w, real(-0.25) * c3.y - r15 * c3.w,
                          r6 * c2.y - r10 * c2.w, real(0.25) * c3.w - r15 * c3.y);
    return exchanged;
}

// The function turned by 180 degrees about a unit vector, f(mirrored(d, normal)): the mirror
// direction is linear in d, so light as the glossy surface of that normal receives it becomes light
// as it is sent.
ShVector shHalfTurn(ShVector sh, vec3 normal)
{
    GLSL_ASSERT(isUnit(normal));
    real square = normal.x * normal.x + normal.y * normal.y;
    real level = sqrt(square);
    real cosine = square > real(0.0) ? normal.x / level : real(1.0);
    real sine = square > real(0.0) ? normal.y / level : real(0.0);
    // Euler angles: azimuth, twice the zenith angle, 180 degrees - azimuth.
    ShVector turned = shExchangeNorthUp(shTurn(sh, -cosine, sine));
    turned = shTurn(turned, normal.z * normal.z - square, real(-2.0) * normal.z * level);
    return shTurn(shExchangeNorthUp(turned), cosine, sine);
}

// Light that a glossy surface sends, as a function of the direction that it leaves in, from what it
// receives as a function of the direction that it comes from: its Phong lobe about the mirror
// direction, times gloss.
ShVector glossyExit(ShVector incident, vec3 normal, real gloss, real exponent)
{
    return shHalfTurn(shScaleBands(incident, phongEigenvalues(exponent) * gloss), normal);
}

// Normalised Legendre polynomials, orthonormal on -1 ... 1 (NS09, Eq. 9 and below). z: -1 ... 1.
vec4 legendre(real z)
{
    GLSL_ASSERT(abs(z) <= real(1.0));
    return vec4(real(0.70710678118654752440), real(1.22474487139158904910) * z,
                real(0.79056941504209483300) * (real(3.0) * z * z - real(1.0)),
                real(0.93541434669348534640) * z * (real(5.0) * z * z - real(3.0)));
}

// (cos, sin) of the elevation of a slope: no angle is needed below. Any slope.
vec2 risingDirection(Slope slope)
{
    // Beyond 1e15 the direction is vertical in either precision, and the square would overflow.
    Slope steep = clamp(slope, real(-1.0e15), real(1.0e15));
    real cosine = real(1.0) / sqrt(real(1.0) + steep * steep);
    return vec2(cosine, steep * cosine);
}

// The slice that is 1 below an elevation, given as (cos, sin), and 0 above (NS09, Eq. 10, the
// closed form below Eq. 13).
vec4 occlusionBelow(vec2 elevation)
{
    GLSL_ASSERT(isUnitPair(elevation.x, elevation.y));
    real c2 = elevation.x * elevation.x;
    return vec4((elevation.y + real(1.0)) * real(0.70710678118654752440),
                real(-0.61237243569579452455) * c2,
                real(-0.79056941504209483300) * elevation.y * c2,
                real(0.23385358667337133660) * c2 * (real(5.0) * c2 - real(4.0)));
}

// The slice that is 1 above an elevation and 0 below (NS09, Eq. 11).
vec4 visibleAbove(vec2 elevation)
{
    GLSL_ASSERT(isUnitPair(elevation.x, elevation.y));
    real c2 = elevation.x * elevation.x;
    return vec4((real(1.0) - elevation.y) * real(0.70710678118654752440),
                real(0.61237243569579452455) * c2,
                real(0.79056941504209483300) * elevation.y * c2,
                real(-0.23385358667337133660) * c2 * (real(5.0) * c2 - real(4.0)));
}

// What is visible, above a horizon, of a light between two elevations, lowest <= highest; each as
// (cos, sin), -90 ... 90 degrees (NS09, section 6).
vec4 visibleBetween(vec2 horizon, vec2 lowest, vec2 highest)
{
    GLSL_ASSERT(isUnitPair(horizon.x, horizon.y) && lowest.y <= highest.y);
    vec2 start = horizon.y > lowest.y ? horizon : lowest;
    return start.y < highest.y ? occlusionBelow(highest) - occlusionBelow(start)
                               : vec4(real(0.0), real(0.0), real(0.0), real(0.0));
}

// Slices to SH. Between azimuths a slice is blended with its neighbours by a function h of azimuth,
// so that its share of the sphere is h(azimuth - own) * slice(z) (NS09, appendix). Its SH of (l,
// +-m) are the integral over z of slice and the associated Legendre function N(l, m), times the
// integral over azimuth of h * cos or sin(m azimuth). The first is in addSlice and knows no number
// of azimuths; the second is cos or sin(m own) for an even h, times a weight per m, from
// WedgeMatrices.

// cos(m a) and sin(m a), m = 0 ... 3.
struct AzimuthTerms
{
    vec4 cosines;
    vec4 sines;
};

AzimuthTerms azimuthTerms(real cosine, real sine)
{
    GLSL_ASSERT(isUnitPair(cosine, sine));
    real cosine2 = cosine * cosine - sine * sine;
    real sine2 = real(2.0) * cosine * sine;
    AzimuthTerms terms;
    terms.cosines = vec4(real(1.0), cosine, cosine2, cosine2 * cosine - sine2 * sine);
    terms.sines = vec4(real(0.0), sine, sine2, sine2 * cosine + cosine2 * sine);
    return terms;
}

// Terms of a slice, with the weights (WedgeMatrices) of the function that blends it. odd: 0 unless
// the slice is an end of a partial range.
AzimuthTerms weighTerms(AzimuthTerms terms, vec4 even, vec4 odd)
{
    AzimuthTerms weighed;
    weighed.cosines = even * terms.cosines - odd * terms.sines;
    weighed.sines = even * terms.sines + odd * terms.cosines;
    return weighed;
}

// sum + the SH of one slice with the given terms. Where all slices have the same weights, as on the
// full circle, bare terms do, and one shWeighOrders at the end.
// The numbers are integrals over z of legendre and N, the same ones as the columns of the wedge
// matrices have; sqrt(3 pi / 32) and so on, tested against quadrature. Half of the integrals are 0
// by parity, and N(l, 0) = legendre / sqrt(2 pi).
ShVector addSlice(ShVector sum, vec4 slice, AzimuthTerms terms)
{
    real n11 = real(0.54270094091870074452) * slice.x - real(0.15168952441841400422) * slice.z;
    real n21 = real(0.52546792653730581556) * slice.y - real(0.20066637905239154008) * slice.w;
    real n22 = real(0.51503226936425277379) * slice.x - real(0.23032943298089031951) * slice.z;
    real n31 = real(0.12691256152485156153) * slice.x + real(0.49662395084433679976) * slice.z;
    real n32 = real(0.47203487194131480828) * slice.y - real(0.30901936161855166427) * slice.w;
    real n33 = real(0.49153023721027427112) * slice.x - real(0.27477375584969246527) * slice.z;
    vec4 level = slice * (real(0.39894228040143267794) * terms.cosines.x);
    vec4 c = terms.cosines;
    vec4 s = terms.sines;
    ShVector sh;
    sh.c[0] = sum.c[0] + vec4(level.x, n11 * s.y, level.y, n11 * c.y);
    sh.c[1] = sum.c[1] + vec4(n22 * s.z, n21 * s.y, level.z, n21 * c.y);
    sh.c[2] = sum.c[2] + vec4(n22 * c.z, n33 * s.w, n32 * s.z, n31 * s.y);
    sh.c[3] = sum.c[3] + vec4(level.w, n31 * c.y, n32 * c.z, n33 * c.w);
    return sh;
}

// Each coefficient (l, m) times weights[|m|].
ShVector shWeighOrders(ShVector sh, vec4 weights)
{
    ShVector weighed;
    weighed.c[0] = sh.c[0] * vec4(weights.x, weights.y, weights.x, weights.y);
    weighed.c[1] = sh.c[1] * vec4(weights.z, weights.y, weights.x, weights.y);
    weighed.c[2] = sh.c[2] * vec4(weights.z, weights.w, weights.z, weights.y);
    weighed.c[3] = sh.c[3] * vec4(weights.x, weights.y, weights.z, weights.w);
    return weighed;
}
