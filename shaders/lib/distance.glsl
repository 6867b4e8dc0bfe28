// Distances of simple bodies about the origin: positive outside, negative inside [m].

// Of a box from -halfSize to halfSize [m], each >= 0. Exact.
Length boxDistance(vec3 p, vec3 halfSize)
{
    GLSL_ASSERT(halfSize.x >= real(0.0) && halfSize.y >= real(0.0) && halfSize.z >= real(0.0));
    vec3 q = vec3(abs(p.x) - halfSize.x, abs(p.y) - halfSize.y, abs(p.z) - halfSize.z);
    vec3 beyond = vec3(max(q.x, real(0.0)), max(q.y, real(0.0)), max(q.z, real(0.0)));
    return length(beyond) + min(max(q.x, max(q.y, q.z)), real(0.0));
}

// Of a cylinder about z, from -halfHeight to halfHeight [m], both lengths >= 0. Exact.
Length cylinderDistance(vec3 p, Length radius, Length halfHeight)
{
    GLSL_ASSERT(radius >= real(0.0) && halfHeight >= real(0.0));
    real across = length(vec3(p.x, p.y, real(0.0))) - radius;
    real along = abs(p.z) - halfHeight;
    vec3 beyond = vec3(max(across, real(0.0)), max(along, real(0.0)), real(0.0));
    return length(beyond) + min(max(across, along), real(0.0));
}

// Of all that is within radius [m], >= 0, of the line from a to b [m]; a = b is a sphere. Exact.
Length capsuleDistance(vec3 p, vec3 a, vec3 b, Length radius)
{
    GLSL_ASSERT(radius >= real(0.0));
    vec3 line = b - a;
    vec3 from = p - a;
    real squared = dot(line, line);
    real along =
        squared > real(0.0) ? clamp(dot(from, line) / squared, real(0.0), real(1.0)) : real(0.0);
    return length(from - line * along) - radius;
}

// Of an ellipsoid with semi-axes radii [m], each > 0 and at most 1000 times another. The nearest
// point x has p - x = t * x / radii^2 (component by component), and |x / radii| = 1 gives t
// (Eberly 2013). Newton's steps on 1 / |x / radii|, which grows with t and is concave, end below
// the root from anywhere and then rise to it (More and Sorensen 1983). For any t > -min(radii)^2
//     p^2 t / (t + radii^2) summed over the axes, minus t
// is at most the squared distance, by duality, and it is that at the root. So what is left of the
// iteration makes the size of the distance smaller, never larger, but for rounding: outside by at
// most 0.1 % of it, inside by at most 1 % of the least axis (tests hold both).
Length ellipsoidDistance(vec3 p, vec3 radii)
{
    GLSL_ASSERT(radii.x > real(0.0) && radii.y > real(0.0) && radii.z > real(0.0));
    Length least = min(radii.x, min(radii.y, radii.z));
    // In units of the least axis. Off the planes of symmetry by next to nothing, where the root
    // may be a pole.
    vec3 r = radii / least;
    real off = real(1.0e-6);
    vec3 q = vec3(max(abs(p.x) / least, off), max(abs(p.y) / least, off),
                  max(abs(p.z) / least, off));
    // r^2 - 1, and u = t + 1, so that nothing cancels near the pole, u = 0.
    vec3 more = vec3((r.x - real(1.0)) * (r.x + real(1.0)), (r.y - real(1.0)) * (r.y + real(1.0)),
                     (r.z - real(1.0)) * (r.z + real(1.0)));
    vec3 rq = vec3(r.x * q.x, r.y * q.y, r.z * q.z);
    real greatest = max(more.x, max(more.y, more.z));
    // Below the root: no term alone is more than 1 there, nor all over the greatest denominator.
    real low = max(max(rq.x - more.x, rq.y - more.y), max(rq.z - more.z, length(rq) - greatest));
    real u = real(1.0); // the surface
    for (int i = 0; i < 6; ++i)
    {
        vec3 s = vec3(rq.x / (u + more.x), rq.y / (u + more.y), rq.z / (u + more.z));
        real squared = dot(s, s);
        real slope = s.x * s.x / (u + more.x) + s.y * s.y / (u + more.y) +
                     s.z * s.z / (u + more.z);
        u = max(low, u + (sqrt(squared) - real(1.0)) * squared / slope);
    }
    real t = u - real(1.0);
    real excess = q.x * q.x / (u + more.x) + q.y * q.y / (u + more.y) +
                  q.z * q.z / (u + more.z) - real(1.0);
    Length size = least * sqrt(max(t * excess, real(0.0)));
    return t < real(0.0) ? -size : size;
}
