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

// Columns of heights begin one post before the first receiver's whole minor offset, `base`.
struct NearScan
{
    Length here[8];    // heights of the receivers
    Length before[11]; // heights of the last column
    Slope last[8];     // slopes to the last column's crossings
    Slope best[8];     // horizons so far
    int base;          // at the last column
};

// At the receivers, whose horizon begins with the slope of their own cell at them: g has no pole
// there.
NearScan startScan(HeightMap heights, NearRays rays)
{
    NearScan scan;
    Length ahead[9];
    for (int i = 0; i < 11; ++i)
        scan.before[i] = postHeight(heights, rays.first + rays.minor * (i - 1));
    for (int i = 0; i < 9; ++i)
        ahead[i] = postHeight(heights, rays.first + rays.major + rays.minor * i);
    for (int i = 0; i < 8; ++i)
    {
        Length here = scan.before[i + 1];
        Length beside = scan.before[i + 2];
        bool whole = abs(here - ahead[i] - beside + ahead[i + 1]) < -VOID_LIMIT;
        scan.here[i] = here;
        scan.last[i] = NO_HORIZON;
        scan.best[i] =
            whole ? ahead[i] - here + rays.tangent * (beside - here) : NO_HORIZON;
    }
    scan.base = 0;
    return scan;
}

// Goes on to `column`, the next one: the crossings of it and of a row before it, and the maxima
// within the one or two cells between.
NearScan scanColumn(HeightMap heights, NearRays rays, NearScan scan, int column)
{
    real distance = real(column);
    real offset = rays.tangent * distance;
    int whole = int(floor(offset));
    real weight = offset - real(whole);
    bool crossesRow = whole > scan.base;
    ivec2 corner = rays.first + rays.major * column + rays.minor * (whole - 1);
    Length current[11];
    for (int i = 0; i < 11; ++i)
        current[i] = postHeight(heights, corner + rays.minor * i);
    Length before[10]; // from where `current` begins
    for (int i = 0; i < 10; ++i)
        before[i] = crossesRow ? scan.before[i + 1] : scan.before[i];

    real lastDistance = real(column - 1);
    real rowDistance = crossesRow ? real(whole) / rays.tangent : lastDistance;
    real share = rowDistance - lastDistance; // of the way between the columns
    real inverseDistance = real(1.0) / distance;
    real inverseRow = real(1.0) / rowDistance;
    // A cell that the ray only grazes has no inside to speak of, and no interval to divide by; nor
    // has the receivers' own.
    bool firstCell = column > 1 && share > real(1.0e-3);
    bool secondCell = column > 1 && distance - rowDistance > real(1.0e-3);
    Interval beforeRow = intervalBetween(lastDistance, rowDistance);
    Interval afterRow = intervalBetween(rowDistance, distance);

    // Curvature along the ray in the cell that begins at each height of the two columns.
    real curvature[9];
    bool valid[9];
    for (int i = 0; i < 9; ++i)
    {
        Length twist = before[i] - current[i] - before[i + 1] + current[i + 1];
        valid[i] = abs(twist) < -VOID_LIMIT;
        curvature[i] = rays.tangent * twist;
    }
    for (int i = 0; i < 8; ++i)
    {
        Slope slope = (crossingHeight(current[i + 1], current[i + 2], weight) - scan.here[i]) *
                      inverseDistance;
        Slope rowSlope =
            (crossingHeight(before[i + 1], current[i + 1], share) - scan.here[i]) * inverseRow;
        Slope atRow = crossesRow ? rowSlope : scan.last[i];
        Slope top = max(scan.best[i], max(slope, atRow));
        Slope peak = insideMaximum(beforeRow, scan.last[i], atRow, curvature[i]);
        top = firstCell && valid[i] ? max(top, peak) : top;
        peak = insideMaximum(afterRow, atRow, slope, curvature[i + 1]);
        top = secondCell && valid[i + 1] ? max(top, peak) : top;
        scan.best[i] = top;
        scan.last[i] = slope;
    }
    for (int i = 0; i < 11; ++i)
        scan.before[i] = current[i];
    scan.base = whole;
    return scan;
}

// Horizon slope [m per step] of each receiver over the first `reach` >= 0 steps of its ray, exact
// for the bilinear surface: every column and row crossing, and the maximum within each cell.
NearSlopes nearHorizon(HeightMap heights, NearRays rays, int reach)
{
    GLSL_ASSERT(rays.tangent >= real(0.0) && rays.tangent <= real(1.0) && reach >= 0);
    NearScan scan = startScan(heights, rays);
    for (int column = 1; column <= reach; ++column)
        scan = scanColumn(heights, rays, scan, column);
    NearSlopes found;
    for (int i = 0; i < 8; ++i)
        found.slopes[i] = reach > 0 ? scan.best[i] : NO_HORIZON;
    return found;
}

// Horizon slope [m per step] of one receiver over `steps` steps of its ray, exact for the bilinear
// surface: every column and row crossing, and the maximum within each cell. major, minor, tangent:
// as in NearRays. The texture's frame must reach past the last step.
Slope horizonAlongRay(HeightMap heights, ivec2 receiver, ivec2 major, ivec2 minor, real tangent,
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

// Where a ray crosses a column of posts: the two posts beside it, and how far it is from the first
// to the second.
struct RayColumn
{
    Length low;
    Length high;
    real weight;
};

// The column after `away` >= 0 whole steps. turn: posts along `minor` per step, -1 ... 1.
RayColumn rayColumn(HeightMap heights, ivec2 receiver, ivec2 major, ivec2 minor, real turn,
                    int away)
{
    GLSL_ASSERT(abs(turn) <= real(1.0) && away >= 0);
    real offset = turn * real(away);
    int whole = int(floor(offset));
    ivec2 post = receiver + major * away + minor * whole;
    RayColumn column;
    column.low = postHeight(heights, post);
    column.high = postHeight(heights, post + minor);
    column.weight = offset - real(whole);
    return column;
}

// Slope [m per step] at which a receiver of height `here` sees the surface along its ray at the
// column after `away` >= 1 whole steps or, if that is higher, at the row that the ray crosses
// between it and the column `before`; NO_HORIZON where neither has valid posts.
Slope slopeAtStep(RayColumn before, RayColumn column, Length here, real turn, int away)
{
    GLSL_ASSERT(abs(turn) <= real(1.0) && away >= 1);
    real distance = real(away);
    Length rise = crossingHeight(column.low, column.high, column.weight) - here;
    Slope slope = isVoid(rise) ? NO_HORIZON : rise / distance;

    // The row's posts are one of each column's.
    real offset = turn * distance;
    real offsetBefore = offset - turn;
    real row = floor(max(offset, offsetBefore));
    bool crosses = row > min(offset, offsetBefore);
    real place = crosses ? row / turn : distance;
    rise = crossingHeight(turn > real(0.0) ? before.high : before.low,
                          turn > real(0.0) ? column.low : column.high,
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
