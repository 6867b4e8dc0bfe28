// Light of sky and sun.

// Irradiance weight of one azimuth slice (MATHS, "One slice, exactly"; TW10 Eq. 5): integral of
// N.e over zenith angles 0 ... theta and an azimuth width of `width`, for a normal with vertical part
// nz and part nh along the slice. theta in 0 ... pi, already clamped to the surface's own plane.
real sliceIrradiance(Angle theta, real nz, real nh, Angle width)
{
    real s = sin(theta);
    return width * nz * real(0.5) * s * s +
           real(2.0) * sin(real(0.5) * width) * nh * real(0.5) * (theta - s * cos(theta));
}

// Zenith angle at which a slice meets the surface's own plane: 90 degrees + atan(nh / nz).
Angle planeZenithAngle(real nz, real nh)
{
    return HALF_PI + elevationOfSlope(nh / nz);
}

// Visible fraction of a disc of angular radius r [rad] whose centre stands `above` [rad] over a
// straight horizon: the circular segment.
real visibleDiscFraction(Angle above, Angle r)
{
    real x = clamp(above / r, real(-1.0), real(1.0));
    real root = sqrt(max(real(1.0) - x * x, real(0.0)));
    // asin(x), by the same polynomial as elsewhere: atan(x / sqrt(1 - x*x)).
    Angle arc = abs(x) < real(1.0) ? elevationOfSlope(x / max(root, real(1.0e-7)))
                                   : (x < real(0.0) ? -HALF_PI : HALF_PI);
    return clamp(real(0.5) + (arc + x * root) / PI, real(0.0), real(1.0));
}

// One slice's share of a sky-view factor. elevation: of the horizon; the sky ends at the horizontal
// in all three definitions. definition: 0 cosine to the normal, 1 cosine to the zenith, 2 solid angle.
real skySlice(Angle elevation, vec3 normal, real cosine, real sine, Angle width, int definition)
{
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
