// Distances to the nearest of some placed objects: a group is a brick of 8 x 8 x 8 voxels, which is
// computed anew, from the objects that are within reach of it.
layout(local_size_x = 8, local_size_y = 8, local_size_z = 2) in;

// Stored: distance over `reach`, -1 ... 1; 1 where nothing is nearer.
layout(r8_snorm, binding = 0) writeonly uniform image3D volume;
// A quarter as many texels along each axis: albedo of the nearest object.
layout(rgba16f, binding = 1) writeonly uniform image3D albedo;

struct Shape
{
    vec4 toOwn[3]; // from the volume's frame [m]; rows of a matrix
    vec4 size;     // xyz, or the range of a form; w: 0 box, 1 ellipsoid, 2 cylinder, 3 capsule,
                   // 4 mesh, 5 star, 6 heights
    vec4 low;      // of the bounds [m] in the volume's frame; w: metres per own unit of what is
                   // sampled
    vec4 high;
    vec4 albedo;   // rgb
    vec4 grid;     // of a mesh: centre of the first voxel, and voxels' spacing [own units]; of
                   // heights: the first post and the posts' spacing along x and y
    ivec4 voxels;  // of a mesh: along x, y, z, and where its first one stands in `distances`; of
                   // a form: its side and its row in `forms`
};
layout(std430, binding = 0) readonly buffer Shapes
{
    Shape shapes[];
};
layout(std430, binding = 1) readonly buffer Bricks
{
    ivec4 bricks[]; // xyz: its place among bricks
};
layout(std430, binding = 2) readonly buffer Distances
{
    float distances[]; // [own units], x fastest, then y, then z
};

uniform sampler2D forms; // samples: radii, heights [own units]
uniform int shapeCount;
uniform float voxel; // [m]
uniform float reach; // [m]

const int BATCH = 1024; // shapes that are sorted out at a time
shared int nearby[BATCH];
shared int nearCount;

float gridAt(Shape shape, ivec3 at)
{
    return distances[shape.voxels.w + at.x + shape.voxels.x * (at.y + shape.voxels.y * at.z)];
}

// Trilinear; beyond the grid the way to it is added. [own units]
Length gridDistance(Shape shape, vec3 place)
{
    vec3 at = (place - shape.grid.xyz) / shape.grid.w;
    vec3 inside = clamp(at, vec3(0.0), vec3(shape.voxels.xyz - 1));
    ivec3 low = min(ivec3(inside), shape.voxels.xyz - 2);
    vec3 part = inside - vec3(low);
    vec4 ends; // by y and z
    for (int i = 0; i < 4; ++i)
    {
        ivec3 voxelPlace = low + ivec3(0, i % 2, i / 2);
        ends[i] = mix(gridAt(shape, voxelPlace), gridAt(shape, voxelPlace + ivec3(1, 0, 0)),
                      part.x);
    }
    return mix(mix(ends.x, ends.y, part.y), mix(ends.z, ends.w, part.y), part.z) +
           shape.grid.w * distance(at, inside);
}

// [own units]
Length formDistance(Shape shape, vec3 place)
{
    SampledForm form;
    form.side = shape.voxels.x;
    form.row = shape.voxels.y;
    form.first = shape.grid.xy;
    form.spacing = shape.grid.zw;
    form.range = shape.size.xy;
    Length near = reach / shape.low.w;
    return int(shape.size.w) == 5 ? starDistance(forms, form, place, near)
                                  : columnsDistance(forms, form, place, near);
}

Length shapeDistance(Shape shape, vec3 place)
{
    vec4 p = vec4(place, 1.0);
    vec3 own = vec3(dot(shape.toOwn[0], p), dot(shape.toOwn[1], p), dot(shape.toOwn[2], p));
    int kind = int(shape.size.w);
    if (kind == 0)
        return boxDistance(own, shape.size.xyz);
    if (kind == 1)
        return ellipsoidDistance(own, shape.size.xyz);
    if (kind == 2)
        return cylinderDistance(own, shape.size.x, shape.size.z);
    if (kind == 3)
        return capsuleDistance(own, vec3(0.0, 0.0, -shape.size.z), vec3(0.0, 0.0, shape.size.z),
                               shape.size.x);
    return shape.low.w * (kind == 4 ? gridDistance(shape, own) : formDistance(shape, own));
}

void main()
{
    ivec3 first = bricks[int(GROUP.x)].xyz * 8;
    vec3 low = vec3(first) * voxel - reach;
    vec3 high = vec3(first + 8) * voxel + reach;
    ivec3 mine = first + ivec3(gl_LocalInvocationID.xy, gl_LocalInvocationID.z * 4u);
    vec4 least = vec4(reach); // of four voxels
    int owner = 0;            // of the third
    for (int batch = 0; batch < shapeCount; batch += BATCH)
    {
        barrier();
        if (gl_LocalInvocationIndex == 0u)
            nearCount = 0;
        barrier();
        int end = min(batch + BATCH, shapeCount);
        for (int i = batch + int(gl_LocalInvocationIndex); i < end; i += 128)
            if (all(lessThan(shapes[i].low.xyz, high)) &&
                all(greaterThan(shapes[i].high.xyz, low)))
                nearby[atomicAdd(nearCount, 1)] = i;
        barrier();
        for (int z = 0; z < 4; ++z)
        {
            vec3 place = (vec3(mine + ivec3(0, 0, z)) + 0.5) * voxel;
            for (int i = 0; i < nearCount; ++i)
            {
                Length here = shapeDistance(shapes[nearby[i]], place);
                if (z == 2 && here < least[z])
                    owner = nearby[i];
                least[z] = min(least[z], here);
            }
        }
    }
    for (int z = 0; z < 4; ++z)
        imageStore(volume, mine + ivec3(0, 0, z), vec4(max(least[z] / reach, -1.0)));
    if (mine.x % 4 == 2 && mine.y % 4 == 2)
        imageStore(albedo, mine / 4, shapes[owner].albedo);
}
