// Horizons of a bilinear surface along a straight ray in grid space.
//
// A ray leaves its receiver post along the grid axis that it crosses faster (major), one post per
// step, and drifts `tangent` posts per step along the other (minor), 0 <= tangent <= 1; mirror
// images serve the other octants. Slopes here are metres of height per step; the caller divides by
// the step's length on the ground.

// Slope of a horizon with nothing ahead of it.
GLSL_CONST Slope NO_HORIZON = real(-1.0e30);

// Receivers per call: neighbours along the minor axis share every read.
GLSL_CONST int NEAR_POSTS = 8;

struct NearSlopes
{
    Slope slopes[8];
};

// Where two neighbouring crossings stand on a ray, 0 < s1 < s2, in the products that insideMaximum
// needs: the same for all receivers of a call. Not asserted: for a cell that is only grazed s1 is
// s2, and scanColumn uses nothing of it.
struct Interval
{
    real near;        // s1
    real far;         // s2
    real inverseNear; // 1 / s1
    real product;     // s1 * s2
    real steepness;   // s1 * s2 / (s2 - s1)
};

Interval intervalBetween(real s1, real s2)
{
    Interval interval;
    interval.near = s1;
    interval.far = s2;
    interval.inverseNear = real(1.0) / s1;
    interval.product = s1 * s2;
    interval.steepness = s1 * s2 / (s2 - s1);
    return interval;
}

// Highest value of g(s) = a/s + b + c*s inside an interval, where g is the slope from the receiver
// to a surface that is quadratic along the ray, g1 and g2 its values at the ends and c its
// curvature (half the second derivative). NO_HORIZON where g has no inner maximum: a surface must
// be convex upwards to stand above both ends.
Slope insideMaximum(Interval interval, Slope g1, Slope g2, real c)
{
    real a = interval.steepness * (g1 - g2) + interval.product * c;
    Slope b = g1 - a * interval.inverseNear - c * interval.near;
    real ac = a * c;
    // The maximum, at s = sqrt(a/c), is b - 2*sqrt(a*c); inside where s1^2 < a/c < s2^2.
    bool inside = c < real(0.0) && a < c * interval.near * interval.near &&
                  a > c * interval.far * interval.far;
    return inside ? b - real(2.0) * sqrt(max(ac, real(0.0))) : NO_HORIZON;
}

// The rays of a block of NEAR_POSTS receivers, which are neighbours along the minor axis.
struct NearRays
{
    ivec2 first; // texel of the first receiver; the others are first + i*minor
    ivec2 major; // unit steps
    ivec2 minor;
    real tangent;
};

struct NearScan
{
    Length here[8];    // heights of the receivers
    Length before[11]; // heights of the last column, from minor offset `base` on
    Slope last[8];     // slopes to the last column's crossings
    Slope best[8];     // horizons so far
    int base;          // whole minor offset at the last column
};

NearScan startScan(sampler2D heights, NearRays rays)
{
    NearScan scan;
    for (int i = 0; i < 11; ++i)
        scan.before[i] = postHeight(heights, rays.first + rays.minor * i);
    for (int i = 0; i < 8; ++i)
    {
        scan.here[i] = scan.before[i];
        scan.last[i] = NO_HORIZON;
        scan.best[i] = NO_HORIZON;
    }
    scan.base = 0;
    return scan;
}

// Goes on to `column`, the next one: the crossings of it and of a row before it, and the maxima
// within the one or two cells between.
NearScan scanColumn(sampler2D heights, NearRays rays, NearScan scan, int column)
{
    real distance = real(column);
    real offset = rays.tangent * distance;
    int whole = int(floor(offset));
    real weight = offset - real(whole);
    ivec2 corner = rays.first + rays.major * column + rays.minor * scan.base;
    Length current[12];
    for (int i = 0; i < 12; ++i)
        current[i] = postHeight(heights, corner + rays.minor * i);

    bool crossesRow = whole > scan.base;
    real lastDistance = real(column - 1);
    real rowDistance = crossesRow ? real(whole) / rays.tangent : distance;
    real share = rowDistance - lastDistance; // of the way between the columns
    real inverseDistance = real(1.0) / distance;
    real inverseRow = real(1.0) / rowDistance;
    // A cell that the ray only grazes has no inside to speak of, and no interval to divide by.
    bool firstCell = column > 1 && rowDistance - lastDistance > real(1.0e-3);
    bool secondCell = crossesRow && distance - rowDistance > real(1.0e-3);
    Interval beforeRow = intervalBetween(lastDistance, rowDistance);
    Interval afterRow = intervalBetween(rowDistance, distance);

    for (int i = 0; i < 8; ++i)
    {
        Length nearSide = crossesRow ? current[i + 1] : current[i];
        Length farSide = crossesRow ? current[i + 2] : current[i + 1];
        Slope slope = (crossingHeight(nearSide, farSide, weight) - scan.here[i]) * inverseDistance;
        Slope rowSlope =
            (crossingHeight(scan.before[i + 1], current[i + 1], share) - scan.here[i]) * inverseRow;
        Slope atRow = crossesRow ? rowSlope : slope;
        Slope top = max(scan.best[i], max(slope, atRow));
        Length twist = scan.before[i] - current[i] - scan.before[i + 1] + current[i + 1];
        bool whole1 = abs(twist) < -VOID_LIMIT;
        // The receiver's own cell: g has no pole, so its inner end is the tangent there.
        Slope own = current[i] - scan.here[i] + rays.tangent * (scan.before[i + 1] - scan.here[i]);
        top = column == 1 && whole1 ? max(top, own) : top;
        Slope peak = insideMaximum(beforeRow, scan.last[i], atRow, rays.tangent * twist);
        top = firstCell && whole1 ? max(top, peak) : top;

        twist = scan.before[i + 1] - current[i + 1] - scan.before[i + 2] + current[i + 2];
        bool whole2 = abs(twist) < -VOID_LIMIT;
        peak = insideMaximum(afterRow, atRow, slope, rays.tangent * twist);
        top = secondCell && whole2 ? max(top, peak) : top;
        scan.best[i] = top;
        scan.last[i] = slope;
    }
    for (int i = 0; i < 11; ++i)
        scan.before[i] = crossesRow ? current[i + 1] : current[i];
    scan.base = whole;
    return scan;
}

// Horizon slope [m per step] of each receiver over the first `reach` >= 0 steps of its ray, exact
// for the bilinear surface: every column and row crossing, and the maximum within each cell.
NearSlopes nearHorizon(sampler2D heights, NearRays rays, int reach)
{
    GLSL_ASSERT(rays.tangent >= real(0.0) && rays.tangent <= real(1.0) && reach >= 0);
    NearScan scan = startScan(heights, rays);
    for (int column = 1; column <= reach; ++column)
        scan = scanColumn(heights, rays, scan, column);
    NearSlopes found;
    for (int i = 0; i < 8; ++i)
        found.slopes[i] = scan.best[i];
    return found;
}

// Horizon slope [m per step] of one receiver over `steps` steps of its ray, exact for the bilinear
// surface: every column and row crossing, and the maximum within each cell. major, minor, tangent:
// as in NearRays. The texture's frame must reach past the last step.
Slope horizonAlongRay(sampler2D heights, ivec2 receiver, ivec2 major, ivec2 minor, real tangent,
                      int steps)
{
    GLSL_ASSERT(tangent >= real(0.0) && tangent <= real(1.0) && steps >= 0);
    Length here = postHeight(heights, receiver);
    Slope best = NO_HORIZON;
    Slope last = NO_HORIZON;
    int base = 0;
    for (int column = 1; column <= steps; ++column)
    {
        real lastDistance = real(column - 1);
        real distance = real(column);
        real offset = tangent * distance;
        int whole = int(floor(offset));
        bool crossesRow = whole > base;
        ivec2 corner = receiver + major * (column - 1) + minor * base;
        Length before0 = postHeight(heights, corner);
        Length before1 = postHeight(heights, corner + minor);
        Length before2 = postHeight(heights, corner + minor * 2);
        Length ahead0 = postHeight(heights, corner + major);
        Length ahead1 = postHeight(heights, corner + major + minor);
        Length ahead2 = postHeight(heights, corner + major + minor * 2);

        real weight = offset - real(whole);
        Length crossing = crossesRow ? crossingHeight(ahead1, ahead2, weight)
                                     : crossingHeight(ahead0, ahead1, weight);
        Slope slope = (crossing - here) / distance;
        real rowDistance = crossesRow ? real(whole) / tangent : distance;
        Length rowCrossing = crossingHeight(before1, ahead1, rowDistance - lastDistance);
        Slope atRow = crossesRow ? (rowCrossing - here) / rowDistance : slope;
        best = max(best, max(slope, atRow));

        // Inside the cell before the row; the receiver's own cell has no pole, only a tangent.
        Length twist = before0 - ahead0 - before1 + ahead1;
        bool whole1 = abs(twist) < -VOID_LIMIT;
        Slope own = ahead0 - here + tangent * (before1 - here);
        best = column == 1 && whole1 ? max(best, own) : best;
        if (column > 1 && whole1 && rowDistance - lastDistance > real(1.0e-3))
            best = max(best, insideMaximum(intervalBetween(lastDistance, rowDistance), last, atRow,
                                           tangent * twist));
        // And in the one after it.
        twist = before1 - ahead1 - before2 + ahead2;
        if (crossesRow && abs(twist) < -VOID_LIMIT && distance - rowDistance > real(1.0e-3))
            best = max(best, insideMaximum(intervalBetween(rowDistance, distance), atRow, slope,
                                           tangent * twist));
        last = slope;
        base = whole;
    }
    return best;
}

// Slope [m per step] at which a receiver of height `here` sees the surface along its ray at `away`
// >= 1 whole steps or, if that is higher, at the row that the ray crosses in the step before;
// NO_HORIZON where neither has valid posts. turn: posts along `minor` per step, -1 ... 1.
Slope slopeAtStep(sampler2D heights, ivec2 receiver, Length here, ivec2 major, ivec2 minor,
                  real turn, int away)
{
    GLSL_ASSERT(abs(turn) <= real(1.0) && away >= 1);
    real distance = real(away);
    real offset = turn * distance;
    int whole = int(floor(offset));
    ivec2 post = receiver + major * away + minor * whole;
    Length rise = crossingHeight(postHeight(heights, post), postHeight(heights, post + minor),
                                 offset - real(whole)) -
                  here;
    Slope slope = isVoid(rise) ? NO_HORIZON : rise / distance;

    real before = offset - turn;
    int row = int(floor(max(offset, before)));
    bool crosses = real(row) > min(offset, before);
    real place = crosses ? real(row) / turn : distance;
    post = receiver + major * (away - 1) + minor * row;
    rise = crossingHeight(postHeight(heights, post), postHeight(heights, post + major),
                          place - (distance - real(1.0))) -
           here;
    return crosses && !isVoid(rise) ? max(slope, rise / place) : slope;
}

// Hull of a sweep (Timonen and Westerholm 2010, section 5): vertices are (height [m], position
// [steps]). True where, seen from `eye`, `farther` stands at least as high as `nearer`: compared by
// cross-multiplication, no division. Equal slopes count, which keeps the hull small on planes.
// Positions fall: eye.y > nearer.y > farther.y.
bool hidesOrEquals(vec2 eye, vec2 nearer, vec2 farther)
{
    GLSL_ASSERT(eye.y > nearer.y && nearer.y > farther.y);
    return (farther.x - eye.x) * (eye.y - nearer.y) >= (nearer.x - eye.x) * (eye.y - farther.y);
}
