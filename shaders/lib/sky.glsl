// Light of sky and sun.

// Irradiance weight of one azimuth slice (MATHS, "One slice, exactly"; TW10 Eq. 5): integral of N.e
// over zenith angles 0 ... theta and an azimuth width of `width`, for a normal with vertical part
// nz and part nh along the slice. theta in 0 ... pi, already clamped to the surface's own plane; 0
// < width <= 2 pi.
real sliceIrradiance(Angle theta, real nz, real nh, Angle width)
{
    GLSL_ASSERT(theta >= real(0.0) && theta <= PI + real(1.0e-6));
    GLSL_ASSERT(width > real(0.0) && width <= real(2.0) * PI + real(1.0e-5));
    real s = sin(theta);
    return width * nz * real(0.5) * s * s +
           real(2.0) * sin(real(0.5) * width) * nh * real(0.5) * (theta - s * cos(theta));
}

// The same as a function of the slope that ends it below: its dot product with (nz, nh) is
// sliceIrradiance(). 0 < width <= 2 pi.
vec2 sliceMoments(Slope slope, Angle width)
{
    GLSL_ASSERT(width > real(0.0) && width <= real(2.0) * PI + real(1.0e-5));
    real square = real(1.0) / (real(1.0) + slope * slope); // of sin theta
    Angle theta = HALF_PI - elevationOfSlope(slope);
    return vec2(width * real(0.5) * square,
                sin(real(0.5) * width) * (theta - slope * square));
}

// With a third part, so that light that changes evenly with the slope can be integrated: its upward
// moment is that part's.
vec3 gradedMoments(Slope slope, Angle width)
{
    GLSL_ASSERT(width > real(0.0) && width <= real(2.0) * PI + real(1.0e-5));
    real square = real(1.0) / (real(1.0) + slope * slope);
    Angle elevation = elevationOfSlope(slope);
    return vec3(width * real(0.5) * square,
                sin(real(0.5) * width) * (HALF_PI - elevation - slope * square),
                width * real(0.5) * (slope * square - elevation));
}

// Zenith angle at which a slice meets the surface's own plane: 90 degrees + atan(nh / nz). nz > 0:
// a surface of heights faces up.
Angle planeZenithAngle(real nz, real nh)
{
    GLSL_ASSERT(nz > real(0.0));
    return HALF_PI + elevationOfSlope(nh / nz);
}

// Visible fraction of a disc of angular radius r [rad] > 0 whose centre stands `above` [rad] over a
// straight horizon: the circular segment.
real visibleDiscFraction(Angle above, Angle r)
{
    GLSL_ASSERT(r > real(0.0));
    real x = clamp(above / r, real(-1.0), real(1.0));
    real root = sqrt(max(real(1.0) - x * x, real(0.0)));
    // asin(x), by the same polynomial as elsewhere: atan(x / sqrt(1 - x*x)).
    Angle arc = abs(x) < real(1.0) ? elevationOfSlope(x / max(root, real(1.0e-7)))
                                   : (x < real(0.0) ? -HALF_PI : HALF_PI);
    return clamp(real(0.5) + (arc + x * root) / PI, real(0.0), real(1.0));
}

// A horizon need not be straight across a disc: it is measured at its centre and SUN_SIDE of its
// radius to either side, linear between, level beyond.
GLSL_CONST real SUN_SIDE = real(0.85);

// Visible fraction of a disc of angular radius r [rad] whose centre stands left, centre, right
// [rad] over the horizon at those three azimuths. Eight vertical strips, their edges equally spaced
// on the disc's own, weigh what the bent horizon hides more or less than a straight one, whose
// fraction is exact.
real visibleDiscFractionAcross(Angle left, Angle centre, Angle right, Angle r)
{
    GLSL_ASSERT(r > real(0.0));
    real change = real(0.0);
    for (int i = 0; i < 8; ++i)
    {
        real angle = PI * (real(i) + real(0.5)) / real(8.0);
        real place = clamp(cos(angle) / SUN_SIDE, real(-1.0), real(1.0));
        real halfChord = sin(angle);
        Angle side = place < real(0.0) ? left : right;
        Angle above = centre + (side - centre) * abs(place);
        real bent = clamp(real(0.5) + real(0.5) * above / (r * halfChord), real(0.0), real(1.0));
        real straight =
            clamp(real(0.5) + real(0.5) * centre / (r * halfChord), real(0.0), real(1.0));
        change = change + halfChord * halfChord * (bent - straight);
    }
    return clamp(visibleDiscFraction(centre, r) + change / real(4.0), real(0.0), real(1.0));
}

// Irradiance / pi by one slice of a light of radiance 1 between two elevations, 0 <= lowest <
// highest <= 90 degrees, above a horizon.
real keySlice(Angle horizon, Angle lowest, Angle highest, vec3 normal, real cosine, real sine,
              Angle width)
{
    GLSL_ASSERT(lowest >= real(0.0) && lowest < highest && highest <= HALF_PI);
    GLSL_ASSERT(isUnit(normal) && isUnitPair(cosine, sine));
    real nh = normal.x * cosine + normal.y * sine;
    Angle top = HALF_PI - highest;
    Angle bottom = min(HALF_PI - max(horizon, lowest), planeZenithAngle(normal.z, nh));
    return bottom > top ? (sliceIrradiance(bottom, normal.z, nh, width) -
                           sliceIrradiance(top, normal.z, nh, width)) / PI
                        : real(0.0);
}

// One slice's share of a sky-view factor. elevation: of the horizon; the sky ends at the horizontal
// in all three definitions. definition: 0 cosine to the normal, 1 cosine to the zenith, 2 solid
// angle.
real skySlice(Angle elevation, vec3 normal, real cosine, real sine, Angle width, int definition)
{
    GLSL_ASSERT(isUnit(normal) && isUnitPair(cosine, sine));
    GLSL_ASSERT(definition >= 0 && definition <= 2);
    Angle clamped = max(elevation, real(0.0));
    if (definition == 2)
        return width * (real(1.0) - sin(clamped)) / (real(2.0) * PI);
    if (definition == 1)
    {
        real c = cos(clamped);
        return width * real(0.5) * c * c / PI;
    }
    real nh = normal.x * cosine + normal.y * sine;
    Angle theta = min(HALF_PI - clamped, planeZenithAngle(normal.z, nh));
    return sliceIrradiance(theta, normal.z, nh, width) / PI;
}
