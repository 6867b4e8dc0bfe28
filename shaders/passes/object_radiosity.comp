// What the surfaces of placed objects send after a bounce, from what they and the ground among them
// sent after one less: the light of sky, sun and lamps at first. A cell of 4 x 4 x 4 voxels has a
// texel in each of six slabs (lib/ambient_cube.glsl), with what is sent by the surface in it, or
// next to it, that faces one way along an axis. In a last slice is the ground below a cell.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

// RGBA16F: radiance times how much the surface faces that way, and that; 0 where there is none
layout(rgba16f, binding = 0) writeonly uniform image3D sent;
// RGBA16F: light of the ground with the objects over that without them, and 1; 0 below objects
layout(rgba16f, binding = 1) writeonly uniform image2D ground;
uniform sampler3D albedos; // a texel per cell
uniform sampler2D albedo;  // of the ground: a texel per post, or one for all
uniform ivec3 cells;

// Where a surface faces `way` (along an axis) in a cell or within half a cell of it; w: 1, or 0
// where there is none.
vec4 surfaceOf(ivec3 cell, vec3 way)
{
    DistanceField field = objectField();
    float side = 4.0 * voxel;
    vec3 middle = (vec3(cell) + 0.5) * side;
    if (objectDistance(volume, field, middle).x > 1.5 * side)
        return vec4(0.0);
    float along = side;
    for (int step = 0; step < 16 && along > -side; ++step)
    {
        vec3 place = middle + way * along;
        float away = objectDistance(volume, field, place).x;
        if (away < 0.25 * voxel) // at the first step: within
            return vec4(place, step > 0 ? 1.0 : 0.0);
        along -= max(away, 0.5 * voxel);
    }
    return vec4(0.0);
}

// Radiance of the ground that is seen in a direction.
vec3 groundTowards(vec3 place, vec3 axis)
{
    vec2 metres = place.xy + corner.xy;
    vec2 rise = riseBetweenPosts(heights, postsOf(metres), size, frame, 0.0);
    float above = max(place.z + corner.z - rise.x / max(rise.y, 1.0e-6), 0.0);
    vec2 way = axis.z < 0.0 ? axis.xy * min(above / -axis.z, 128.0 * voxel) : vec2(0.0);
    vec2 coordinate = texelOf(postsOf(metres + way));
    vec2 cell = (place.xy + way) / volumeSize.xy;
    vec4 share = all(equal(cell, clamp(cell, 0.0, 1.0))) ? textureLod(groundShare, cell, 0.0)
                                                         : vec4(1.0);
    return share.rgb / max(share.a, 1.0e-3) * textureLod(shading, coordinate, 0.0).rgb *
           textureLod(albedo, coordinate, 0.0).rgb;
}

// Irradiance / pi.
vec3 lightOn(vec3 place, vec3 normal)
{
    vec2 post = postsOf(place.xy + corner.xy);
    ConesSeen look = lookAround(place, normal, post);
    vec3 light = vec3(0.0);
    for (int i = 0; i < look.count; ++i)
    {
        vec3 axis = look.axes[i].xyz;
        vec3 radiance = vec3(0.0);
        if (look.above[i] > 0.0)
            radiance += look.above[i] * skyTowards(axis) * skyRadiance;
        if (sending && look.above[i] < 1.0)
            radiance += (1.0 - look.above[i]) * groundTowards(place, axis);
        light += look.seen.light[i] * radiance;
    }
    light /= float(look.count);
    light += sentByObjects(place, look) + lampsOn(place, normal);
    return light + sunOn(place, normal, textureLod(direct, texelOf(post), 0.0).a);
}

void main()
{
    ivec3 to = ivec3(INVOCATION);
    if (any(greaterThanEqual(to, ivec3(cells.xy, 6 * cells.z + 1))))
        return;
    if (to.z == 6 * cells.z)
    {
        vec2 metres = corner.xy + (vec2(to.xy) + 0.5) * 4.0 * voxel;
        vec2 rise = riseBetweenPosts(heights, postsOf(metres), size, frame, 0.0);
        float height = rise.x / max(rise.y, 1.0e-6);
        bool isOpen =
            objectDistance(volume, objectField(), vec3(metres, height) - corner).x > 0.0;
        vec3 share = rise.y > 0.5 ? shareOfGround(metres, height).rgb : vec3(1.0);
        imageStore(ground, to.xy, isOpen ? vec4(share, 1.0) : vec4(0.0));
        return;
    }
    int lobe = to.z / cells.z;
    ivec3 cell = ivec3(to.xy, to.z % cells.z);
    vec3 way = vec3(0.0);
    way[lobe / 2] = lobe % 2 == 0 ? 1.0 : -1.0;
    vec4 sends = vec4(0.0);
    vec4 surface = surfaceOf(cell, way);
    if (surface.w > 0.0)
    {
        vec3 normal = objectNormal(volume, objectField(), surface.xyz);
        float faces = dot(normal, way);
        if (faces > 0.1)
        {
            vec3 radiance = texelFetch(albedos, cell, 0).rgb * lightOn(surface.xyz, normal);
            sends = faces * vec4(min(radiance, vec3(6.0e4)), 1.0);
        }
    }
    imageStore(sent, to, sends);
}
