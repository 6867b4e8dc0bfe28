// Horizons of a bilinear surface along a straight ray in grid space.
//
// A ray leaves its receiver post along the grid axis that it crosses faster (major), one post per
// step, and drifts `tangent` posts per step along the other (minor), 0 <= tangent <= 1; mirror images
// serve the other octants. Slopes here are metres of height per step; the caller divides by the step's
// length on the ground.

// Slope of a horizon with nothing ahead of it.
GLSL_CONST Slope NO_HORIZON = real(-1.0e30);

// Receivers per call: neighbours along the minor axis share every read.
GLSL_CONST int NEAR_POSTS = 8;

struct NearSlopes
{
    Slope slopes[8];
};

// Highest value of g(s) = a/s + b + c*s inside (s1, s2), 0 < s1 < s2, where g is the slope from the
// receiver to a surface that is quadratic along the ray, g1 and g2 its values at the ends and c its
// curvature (half the second derivative). Not above both ends unless the surface is convex upwards
// there: then the result is g at the inner maximum, else NO_HORIZON.
Slope insideMaximum(real s1, Slope g1, real s2, Slope g2, real c)
{
    real a = s1 * s2 * ((g1 - g2) / (s2 - s1) + c);
    Slope b = g1 - a / s1 - c * s1;
    real ac = a * c;
    real root = sqrt(max(ac, real(0.0)));
    // s* = sqrt(a/c) lies inside where s1*|c| < sqrt(ac) < s2*|c|.
    bool inside = c < real(0.0) && a < real(0.0) && root > -c * s1 && root < -c * s2;
    return inside ? b - real(2.0) * root : NO_HORIZON;
}

// Horizon slope [m per step] of NEAR_POSTS receivers, over the first `reach` steps of their rays,
// exact for the bilinear surface: every column and row crossing, and, where inside is true, the
// maximum within each cell. first: texel of the first receiver; major and minor: unit steps; the
// receivers are first + i*minor.
NearSlopes nearHorizon(sampler2D heights, ivec2 first, ivec2 major, ivec2 minor, real tangent,
                       int reach, bool inside)
{
    NearSlopes best;
    Length here[8];
    Length before[11];  // column step - 1, from minor offset `base` on
    Length current[11]; // column step
    Slope last[8];      // slope at the previous crossing
    ivec2 corner = first;
    for (int i = 0; i < 11; ++i)
        before[i] = postHeight(heights, corner + minor * i);
    for (int i = 0; i < 8; ++i)
    {
        here[i] = before[i];
        best.slopes[i] = NO_HORIZON;
        last[i] = NO_HORIZON;
    }

    int base = 0; // whole minor offset at the previous column
    real lastDistance = real(0.0);
    for (int column = 1; column <= reach; ++column)
    {
        real distance = real(column);
        real offset = tangent * distance;
        int whole = int(floor(offset));
        real weight = offset - real(whole);
        corner = first + major * column + minor * base;
        for (int i = 0; i < 11; ++i)
            current[i] = postHeight(heights, corner + minor * i);

        bool crossesRow = whole > base;
        real rowDistance = crossesRow ? real(whole) / tangent : distance;
        real share = rowDistance - real(column - 1); // of the way between the columns
        bool firstCell = rowDistance - lastDistance > real(1.0e-3);
        bool secondCell = crossesRow && distance - rowDistance > real(1.0e-3);
        real inverseDistance = real(1.0) / distance;
        real inverseRow = real(1.0) / rowDistance;

        for (int i = 0; i < 8; ++i)
        {
            Slope previous = last[i];
            Length height = crossesRow ? mix(current[i + 1], current[i + 2], weight)
                                       : mix(current[i], current[i + 1], weight);
            Slope slope = (height - here[i]) * inverseDistance;
            Slope top = max(best.slopes[i], slope);
            Slope atRow = slope;
            if (crossesRow)
            {
                atRow = (mix(before[i + 1], current[i + 1], share) - here[i]) * inverseRow;
                top = max(top, atRow);
            }
            if (inside)
            {
                Length twist = before[i] - current[i] - before[i + 1] + current[i + 1];
                if (column == 1)
                {
                    // The receiver's own cell: g has no pole, so its inner end is the tangent there.
                    if (abs(twist) < -VOID_LIMIT)
                        top = max(top, current[i] - here[i] + tangent * (before[i + 1] - here[i]));
                }
                else if (firstCell && abs(twist) < -VOID_LIMIT)
                    top = max(top, insideMaximum(lastDistance, previous, rowDistance, atRow,
                                                 tangent * twist));
                if (secondCell)
                {
                    twist = before[i + 1] - current[i + 1] - before[i + 2] + current[i + 2];
                    if (abs(twist) < -VOID_LIMIT)
                        top = max(top, insideMaximum(rowDistance, atRow, distance, slope,
                                                     tangent * twist));
                }
            }
            best.slopes[i] = top;
            last[i] = slope;
        }

        for (int i = 0; i < 10; ++i)
            before[i] = crossesRow ? current[i + 1] : current[i];
        before[10] = current[10]; // refilled below
        if (crossesRow)
            before[10] = postHeight(heights, corner + minor * 11);
        else
            before[10] = current[10];
        base = whole;
        lastDistance = distance;
    }
    return best;
}

// Hull of a sweep (Timonen and Westerholm 2010, section 5): vertices are (height [m], position
// [steps]). True where, seen from `eye`, `farther` stands at least as high as `nearer`: compared by
// cross-multiplication, no division. Equal slopes count, which keeps the hull small on planes.
bool hidesOrEquals(vec2 eye, vec2 nearer, vec2 farther)
{
    return (farther.x - eye.x) * (eye.y - nearer.y) >= (nearer.x - eye.x) * (eye.y - farther.y);
}
