// Light among placed objects, by distances to the nearest surface of theirs, positive outside. The
// cones are those of Evans (SIGGRAPH 2006, "Fast approximations for global illumination on dynamic
// scenes") taken further: docs/methods/objects.md.

// A volume of distances. The frame is its own: metres east, north and up of its first corner.
struct DistanceField
{
    vec3 size;    // [m]
    Length voxel; // > 0
    Length reach; // a stored value of 1; where it is stored, nothing is nearer than that
    vec3 low;     // of what is in it, and ...
    vec3 high;    // ... the other corner
};

// To the nearest surface [m]: x; y: 1 where that is known, 0 where there is none within x. Beyond
// the volume the way to it is added.
vec2 objectDistance(DistanceVolume volume, DistanceField field, vec3 place)
{
    vec3 edge = vec3(field.voxel * real(0.5));
    vec3 inside = min(max(place, edge), field.size - edge);
    real stored = textureLod(volume, inside / field.size, real(0.0)).x;
    vec3 beyond = place - inside;
    return vec2(stored * field.reach + sqrt(dot(beyond, beyond)),
                stored < real(0.99) ? real(1.0) : real(0.0));
}

// The way from the nearest object, unit.
vec3 objectNormal(DistanceVolume volume, DistanceField field, vec3 place)
{
    vec3 slope = vec3(real(0.0));
    for (int axis = 0; axis < 3; ++axis)
    {
        vec3 aside = vec3(axis == 0 ? field.voxel : real(0.0),
                          axis == 1 ? field.voxel : real(0.0),
                          axis == 2 ? field.voxel : real(0.0));
        slope += aside * (objectDistance(volume, field, place + aside).x -
                          objectDistance(volume, field, place - aside).x);
    }
    real steepest = sqrt(dot(slope, slope));
    return steepest > real(0.0) ? slope / steepest : vec3(real(0.0), real(0.0), real(1.0));
}

// The place on an object that is nearest to one within reach of it.
vec3 nearestOnObject(DistanceVolume volume, DistanceField field, vec3 place)
{
    return place - objectNormal(volume, field, place) * objectDistance(volume, field, place).x;
}

// How far along a ray [m] the box of what is in the volume, grown by `room`, ends: 0 where the ray
// misses it. direction: unit.
Length objectsEnd(DistanceField field, vec3 place, vec3 direction, Length room)
{
    Length first = real(0.0);
    Length last = real(1.0e30);
    for (int axis = 0; axis < 3; ++axis)
    {
        real slow = abs(direction[axis]) < real(1.0e-9) ? real(1.0e-9) : direction[axis];
        Length a = (field.low[axis] - room - place[axis]) / slow;
        Length b = (field.high[axis] + room - place[axis]) / slow;
        first = max(first, min(a, b));
        last = min(last, max(a, b));
    }
    return last > first ? last : real(0.0);
}

// Share of a disc of radius 1 that lies above a line `above` its centre's ... -1 ... 1: 0 ... 1.
real shareOfDisc(real above)
{
    real u = clamp(above, real(-1.0), real(1.0));
    return real(1.0) - (acos(u) - u * sqrt(max(real(1.0) - u * u, real(0.0)))) / PI;
}

// x: how near to its axis anything comes in a cone, over the cone's radius there: 1 where nothing
// is in it, 0 where something touches the axis, -1 where the axis lies deep within. y [m]: how far
// along the axis that is, or where the axis first meets something. sine: of the half-angle; start
// [m]: distance that is free; stride: the least step, over the cone's radius.
vec2 coneOpenness(DistanceVolume volume, DistanceField field, vec3 place, vec3 axis, real sine,
                  Length start, real stride)
{
    GLSL_ASSERT(sine > real(0.0) && start >= real(0.0));
    real open = real(1.0);
    Length nearest = real(0.0);
    Length end = objectsEnd(field, place, axis, real(2.0));
    Length along = max(field.voxel, start / (real(1.0) + sine));
    for (int step = 0; step < 128 && along < end && open > real(-1.0); ++step)
    {
        vec2 found = objectDistance(volume, field, place + axis * along);
        Length distance = found.x - real(0.13) * field.voxel;
        real here = distance / (along * sine);
        if (found.y > real(0.5) && here < open)
        {
            // Within it is behind where it was met.
            nearest = open > real(0.0) ? along + min(distance, real(0.0)) : nearest;
            open = here;
        }
        along += max(real(1.7) * abs(distance),
                     max(stride * along * sine, real(0.5) * field.voxel));
    }
    return vec2(max(open, real(-1.0)), nearest);
}

// Light through a cone, 0 ... 1. around: mean of the openness, not below 0, of this cone and its
// neighbours. fit: A, P, Q, g, from scenes of boxes and meshes.
real coneLight(real open, real around, vec4 fit)
{
    real touched = fit.x * (real(1.0) - fit.w * (real(1.0) - around));
    return open >= real(0.0)
               ? real(1.0) - (real(1.0) - touched) * pow(real(1.0) - open, fit.y)
               : touched * pow(max(real(1.0) + open, real(0.0)), fit.z);
}

// Share of a cone that a horizon leaves. slope: tangent of the horizon's elevation in the azimuth
// of the axis.
real coneAboveHorizon(vec3 axis, real sine, Slope slope)
{
    real level = sqrt(axis.x * axis.x + axis.y * axis.y);
    return shareOfDisc((axis.z - slope * level) / sqrt(real(1.0) + slope * slope) /
                       (real(1.25) * sine));
}

// A direction about +z, turned by the shortest way that takes +z to the unit normal.
vec3 aboutNormal(vec3 direction, vec3 normal)
{
    real up = max(real(1.0) + normal.z, real(1.0e-6));
    real across = (normal.x * direction.x + normal.y * direction.y) / up;
    real along = direction.z - across;
    return vec3(direction.x + normal.x * along, direction.y + normal.y * along,
                normal.z * direction.z - normal.x * direction.x - normal.y * direction.y);
}

// What cones about a normal see. Uses as many of the arrays' entries as there are cones.
struct ConesOpen
{
    real open[32];   // coneOpenness()
    real light[32];  // through each, 0 ... 1
    Length along[32]; // to what hides it; 0 where nothing does
};

// axes: in the field's frame, w the sine of the half-angle; around: bit per cone whose openness
// counts in a cone's own; weights: share of each that the horizon leaves. Cones without any are not
// followed.
ConesOpen conesAmongObjects(DistanceVolume volume, DistanceField field, vec3 place, vec3 normal,
                            vec4 axes[32], uint around[32], real weights[32], int count,
                            real stride, vec4 fit)
{
    Length start = max(objectDistance(volume, field, place + normal * field.voxel).x - field.voxel,
                       real(0.0));
    ConesOpen cones;
    for (int i = 0; i < count; ++i)
    {
        vec2 found = vec2(real(1.0), real(0.0));
        if (weights[i] >= real(1.0e-4))
            found = coneOpenness(volume, field, place, vec3(axes[i].x, axes[i].y, axes[i].z),
                                 axes[i].w, start, stride);
        cones.open[i] = found.x;
        cones.along[i] = found.y;
    }
    for (int i = 0; i < count; ++i)
    {
        real sum = real(0.0);
        real number = real(0.0);
        for (int j = 0; j < count; ++j)
            if (((around[i] >> uint(j)) & 1u) == 1u && weights[j] > real(0.0))
            {
                sum += max(cones.open[j], real(0.0));
                number += real(1.0);
            }
        cones.light[i] =
            coneLight(cones.open[i], number > real(0.0) ? sum / number : real(1.0), fit);
    }
    return cones;
}

// Visible share of a disc, 0 ... 1. direction: unit; sine: of the disc's radius. normal: unit, of
// the surface that the place is on. What is farther away than `most` [m] does not count.
real discAmongObjects(DistanceVolume volume, DistanceField field, vec3 place, vec3 normal,
                      vec3 direction, real sine, Length most)
{
    vec3 from = place + normal * (real(0.1) * field.voxel);
    Length end = min(objectsEnd(field, from, direction, real(0.0)), most);
    Length along = field.voxel;
    real open = real(1.0);
    for (int step = 0; step < 256 && along < end && open > real(-1.0); ++step)
    {
        vec2 found = objectDistance(volume, field, from + direction * along);
        Length distance = found.x - real(0.1) * field.voxel;
        if (found.y > real(0.5))
            open = min(open, distance / (along * sine));
        along += max(abs(distance), real(0.5) * field.voxel);
    }
    return shareOfDisc(open);
}

// Irradiance / pi, over its radiance, by a lamp that is one of the objects: a sphere that others
// may hide. Where it is partly below the surface's horizon it counts as a disc.
real lampAmongObjects(DistanceVolume volume, DistanceField field, vec3 place, vec3 normal,
                      vec3 centre, Length radius)
{
    vec3 way = centre - place;
    Length away = sqrt(dot(way, way));
    if (away <= real(1.01) * radius) // it is its own surface
        return real(0.0);
    real sine = radius / away;
    real above = dot(normal, way) / (away * sine); // its centre, over its radius
    if (above <= real(-1.0))
        return real(0.0);
    real u = min(above, real(1.0));
    real part = sqrt(real(1.0) - u * u) * (real(2.0) + u * u) / (real(3.0) * PI) +
                u * (real(1.0) - acos(u) / PI);
    real light = sine * sine * sine * max(above, part);
    // As far as the lamp itself does not come into the way.
    return light * discAmongObjects(volume, field, place, normal, way / away, sine,
                                    (away - radius) / (real(1.0) + sine));
}
