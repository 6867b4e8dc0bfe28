// Distances to forms that may change in every frame, by samples of their surface: positive outside,
// negative inside [m]. Evans (SIGGRAPH 2006, section 9.8) has them from a blurred map of radii or
// heights; docs/methods/object_fields.md compares.
//
// A form is a bundle of lines, each with a solid part and a free one. On the line that a place lies
// on the way to the surface is known; the slope there makes a distance of it, which holds near the
// surface. From outside, no distance is more than that to the solid part of any line; from inside,
// than that to the free part. The least of all is taken. So what steps by it meets all samples.

// Where the samples are: `side` x `side` texels of a texture, from texel (0, row) on.
struct SampledForm
{
    int row;
    int side;     // >= 2
    vec2 first;   // of heights: the place of the first post [m]
    vec2 spacing; // likewise, between posts [m], each > 0
    vec2 range;   // of heights: the lowest and the highest; of a star: mean and greatest radius [m]
};

// Distance by what the surface's slope makes of the way to it along a line, `away` [m], >= 0.
// cosineSquared: of the angle between the surface's normal and the line; fade [m]: over which the
// slope comes to count e times less, > 0.
Length slopedDistance(Length away, real cosineSquared, Length fade)
{
    GLSL_ASSERT(away >= real(0.0) && fade > real(0.0));
    real slopeSquared = real(1.0) / max(cosineSquared, real(1.0e-6)) - real(1.0);
    return away / sqrt(real(1.0) + max(slopeSquared, real(0.0)) * exp(-away / fade));
}

// The octahedral map of all directions to a square (Cigolle et al. 2014): +z in its middle, -z in
// its corners. at: -1 ... 1 along both axes.
vec3 octahedronDirection(vec2 at)
{
    vec3 v = vec3(at.x, at.y, real(1.0) - abs(at.x) - abs(at.y));
    real folded = max(-v.z, real(0.0));
    v.x += v.x < real(0.0) ? folded : -folded;
    v.y += v.y < real(0.0) ? folded : -folded;
    return normalize(v);
}

// The other way; direction: of any length but 0.
vec2 octahedronPlace(vec3 direction)
{
    real size = abs(direction.x) + abs(direction.y) + abs(direction.z);
    vec2 at = vec2(direction.x / size, direction.y / size);
    if (direction.z >= real(0.0))
        return at;
    return vec2((real(1.0) - abs(at.y)) * (at.x < real(0.0) ? real(-1.0) : real(1.0)),
                (real(1.0) - abs(at.x)) * (at.y < real(0.0) ? real(-1.0) : real(1.0)));
}

// The texel that continues the map beyond its edges, by less than its side.
ivec2 octahedronTexel(int x, int y, int side)
{
    bool turnsY = x < 0 || x >= side;
    int acrossX = x < 0 ? -1 - x : x >= side ? 2 * side - 1 - x : x;
    int alongY = turnsY ? side - 1 - y : y;
    bool turnsX = alongY < 0 || alongY >= side;
    int acrossY = alongY < 0 ? -1 - alongY : alongY >= side ? 2 * side - 1 - alongY : alongY;
    return ivec2(turnsX ? side - 1 - acrossX : acrossX, acrossY);
}

// Of a star's surface, about its centre.
vec3 starPoint(sampler2D radii, SampledForm form, int x, int y)
{
    ivec2 texel = octahedronTexel(x, y, form.side);
    real pitch = real(2.0) / real(form.side);
    vec2 at = vec2((real(texel.x) + real(0.5)) * pitch - real(1.0),
                   (real(texel.y) + real(0.5)) * pitch - real(1.0));
    return octahedronDirection(at) * texelFetch(radii, ivec2(texel.x, form.row + texel.y), 0).x;
}

// From p to the line of a sample: to its solid part, from its centre to the sample, or the rest.
Length starLineDistance(sampler2D radii, SampledForm form, int x, int y, vec3 p, bool isOutside)
{
    vec3 point = starPoint(radii, form, x, y);
    Length radius = length(point);
    vec3 direction = point / radius;
    Length along = dot(p, direction);
    along = isOutside ? clamp(along, real(0.0), radius) : max(along, radius);
    return length(p - direction * along);
}

// Of a body whose surface is met once in each direction from the origin, from its radii in an
// octahedral map, each > 0. reach [m]: what is farther needs only to be known to be.
Length starDistance(sampler2D radii, SampledForm form, vec3 p, Length reach)
{
    GLSL_ASSERT(form.side >= 2 && form.range.x > real(0.0) && reach > real(0.0));
    Length away = max(length(p), real(1.0e-6) * form.range.x);
    if (away - form.range.y > reach)
        return away - form.range.y;
    vec3 direction = length(p) < away ? vec3(real(0.0), real(0.0), real(1.0)) : p / away;
    vec2 at = octahedronPlace(direction);
    real middle = real(0.5) * real(form.side);
    vec2 place = vec2((at.x + real(1.0)) * middle - real(0.5),
                      (at.y + real(1.0)) * middle - real(0.5));
    int x = int(floor(place.x));
    int y = int(floor(place.y));
    real u = place.x - real(x);
    real v = place.y - real(y);
    vec3 a = starPoint(radii, form, x, y);
    vec3 b = starPoint(radii, form, x + 1, y);
    vec3 c = starPoint(radii, form, x, y + 1);
    vec3 d = starPoint(radii, form, x + 1, y + 1);
    Length radius = mix(mix(length(a), length(b), u), mix(length(c), length(d), u), v);
    vec3 normal = cross((b - a) * (real(1.0) - v) + (d - c) * v,
                        (c - a) * (real(1.0) - u) + (d - b) * u);
    real squared = dot(normal, normal);
    real facing = dot(normal, direction);
    // Four of a map's texels meet where two of them are the others: no normal.
    real cosineSquared = squared > real(0.0) ? facing * facing / squared : real(1.0);
    bool isOutside = away > radius;
    Length least = slopedDistance(abs(away - radius), cosineSquared, real(0.15) * form.range.x);
    int column = int(floor(place.x + real(0.5)));
    int row = int(floor(place.y + real(0.5)));
    // A few first: where they are near, less has to be looked at.
    for (int j = -2; j <= 2; j += 2)
        for (int i = -2; i <= 2; i += 2)
            least = min(least,
                        starLineDistance(radii, form, column + i, row + j, p, isOutside));
    // What is nearer than that is within an angle; the map has at most side / 2 texels per radian.
    Length sought = min(least, reach);
    real angle = sought < away ? HALF_PI - acos(sought / away) : PI;
    int window = min(int(-floor(-angle * middle)), form.side / 2);
    for (int j = -window; j <= window; ++j)
        for (int i = -window; i <= window; ++i)
            least = min(least,
                        starLineDistance(radii, form, column + i, row + j, p, isOutside));
    return isOutside ? least : -least;
}

// What is solid on the vertical line of a post: from x to y; x > y: nothing.
vec2 solidColumn(sampler2D heights, SampledForm form, int x, int y)
{
    return vec2(texelFetch(heights, ivec2(x, form.row + form.side + y), 0).x,
                texelFetch(heights, ivec2(x, form.row + y), 0).x);
}

// From p to the line of a post: to its solid part, or to the rest.
Length columnLineDistance(sampler2D heights, SampledForm form, int x, int y, vec3 p,
                          bool isOutside)
{
    vec2 solid = solidColumn(heights, form, x, y);
    bool isVoid = solid.x > solid.y;
    if (isOutside && isVoid)
        return real(1.0e30);
    real toTop = solid.y - p.z;
    real toBottom = p.z - solid.x;
    Length along = isVoid     ? real(0.0)
                   : isOutside ? max(max(-toTop, -toBottom), real(0.0))
                               : max(min(toTop, toBottom), real(0.0));
    return length(vec3(form.first.x + real(x) * form.spacing.x - p.x,
                       form.first.y + real(y) * form.spacing.y - p.y, along));
}

// Of a body between two height fields back to back: `side` rows of the upper, then as many of the
// lower one. Where the lower is higher nothing is solid. The outermost posts are the body's edge.
// reach [m]: as above.
Length columnsDistance(sampler2D heights, SampledForm form, vec3 p, Length reach)
{
    GLSL_ASSERT(form.side >= 2 && form.spacing.x > real(0.0) && form.spacing.y > real(0.0) &&
                reach > real(0.0));
    real last = real(form.side - 1);
    vec2 place = vec2((p.x - form.first.x) / form.spacing.x, (p.y - form.first.y) / form.spacing.y);
    vec2 inside = vec2(clamp(place.x, real(0.0), last), clamp(place.y, real(0.0), last));
    Length beyond = length(vec3((place.x - inside.x) * form.spacing.x,
                                (place.y - inside.y) * form.spacing.y, real(0.0)));
    Length toBox = length(vec3(beyond, max(max(form.range.x - p.z, p.z - form.range.y), real(0.0)),
                               real(0.0)));
    if (toBox > reach)
        return toBox;
    int x = min(int(inside.x), form.side - 2);
    int y = min(int(inside.y), form.side - 2);
    real u = inside.x - real(x);
    real v = inside.y - real(y);
    vec2 a = solidColumn(heights, form, x, y);
    vec2 b = solidColumn(heights, form, x + 1, y);
    vec2 c = solidColumn(heights, form, x, y + 1);
    vec2 d = solidColumn(heights, form, x + 1, y + 1);
    bool isWhole = a.x <= a.y && b.x <= b.y && c.x <= c.y && d.x <= d.y;
    vec2 west = v < real(0.5) ? a : c;
    vec2 east = v < real(0.5) ? b : d;
    vec2 solid = u < real(0.5) ? west : east;
    // Per lower (x) and upper (y) surface: the squared cosine of its slope.
    vec2 level = vec2(real(1.0), real(1.0));
    if (isWhole)
    {
        solid = (a * (real(1.0) - u) + b * u) * (real(1.0) - v) +
                (c * (real(1.0) - u) + d * u) * v;
        vec2 alongX = ((b - a) * (real(1.0) - v) + (d - c) * v) / form.spacing.x;
        vec2 alongY = ((c - a) * (real(1.0) - u) + (d - b) * u) / form.spacing.y;
        level = vec2(real(1.0) / (real(1.0) + alongX.x * alongX.x + alongY.x * alongY.x),
                     real(1.0) / (real(1.0) + alongX.y * alongX.y + alongY.y * alongY.y));
    }
    Length under = solid.x - p.z;
    Length above = p.z - solid.y;
    bool isOutside = beyond > real(0.0) || max(under, above) > real(0.0) || solid.x > solid.y;
    // The slope is known at the posts' spacing.
    Length fade = real(3.0) * max(form.spacing.x, form.spacing.y);
    Length least = real(1.0e30);
    if (isWhole && beyond > real(0.0))
        least = length(vec3(beyond, max(max(under, above), real(0.0)), real(0.0)));
    else if (isWhole && isOutside)
        least = under > above ? slopedDistance(under, level.x, fade)
                              : slopedDistance(above, level.y, fade);
    else if (!isOutside)
    {
        least = min(min(inside.x, last - inside.x) * form.spacing.x,
                    min(inside.y, last - inside.y) * form.spacing.y);
        if (isWhole)
            least = min(least, min(slopedDistance(-under, level.x, fade),
                                   slopedDistance(-above, level.y, fade)));
    }
    // Rows from the middle out, each as far as what is nearer than the least so far may lie.
    int column = int(inside.x + real(0.5));
    int row = int(inside.y + real(0.5));
    for (int k = 0; k < 2 * form.side; ++k)
    {
        int j = k % 2 == 0 ? row - k / 2 : row + (k + 1) / 2;
        Length sought = min(least, reach);
        Length across = form.first.y + real(j) * form.spacing.y - p.y;
        if (real(k / 2) * form.spacing.y > sought + form.spacing.y)
            break;
        if (j < 0 || j >= form.side || abs(across) >= sought)
            continue;
        int wide = int(-floor(-sqrt(sought * sought - across * across) / form.spacing.x));
        for (int i = max(column - wide, 0); i <= min(column + wide, form.side - 1); ++i)
            least = min(least, columnLineDistance(heights, form, i, j, p, isOutside));
    }
    return isOutside ? least : -least;
}
