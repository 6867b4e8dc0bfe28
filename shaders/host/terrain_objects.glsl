// What a host shader calls to light the surface of a PlacedObject: colour = albedo *
// terrainObjectLight(...).rgb. Comes after shaders/lib (createObjectShader); GLSL 3.30 on.

uniform bool osgTerrainLight_objectLit; // whether there is light for it
// As in terrain_probe.glsl: of the probe in the middle of the object.
uniform samplerCube osgTerrainLight_probeDiffuse;
uniform samplerCube osgTerrainLight_probeGlossy;
uniform vec3 osgTerrainLight_sunDirection;
uniform vec3 osgTerrainLight_sunIrradiance; // on a surface that faces it; 0 where there is none
uniform float osgTerrainLight_sunSine;      // of the radius of its disc

// Distances to the object and to those near it, in a volume.
uniform bool osgTerrainLight_hasObjectVolume;
uniform sampler3D osgTerrainLight_objectVolume; // R8_SNORM: distance over the reach
// from eye coordinates to metres east, north and up of the volume's first corner
uniform mat4 osgTerrainLight_objectFromEye;
// size [m], voxel [m]; lowest corner of what is in it [m], reach [m]; highest corner
uniform vec4 osgTerrainLight_objectField[3];
// axis about +z, sine of the half-angle; from 32 on: the fit, and (count, stride)
uniform vec4 osgTerrainLight_objectCones[34];
uniform uint osgTerrainLight_objectAround[32];

// RGBA16F: radiance that the objects send, in the six slabs of lib/ambient_cube.glsl; where the
// scene has bounces.
uniform bool osgTerrainLight_hasObjectRadiosity;
uniform sampler3D osgTerrainLight_objectRadiosity;
// RGBA16F, over the volume's footprint: light of the ground with the objects over that without
// them, premultiplied by a: 0 below objects.
uniform sampler2D osgTerrainLight_objectGround;
// The ground's plane in the volume: height = x + y * east + z * north [m].
uniform vec3 osgTerrainLight_objectPlane;

// Objects that emit light: centre in the volume and radius [m], and radiance.
uniform int osgTerrainLight_lampCount; // 0 ... 16
uniform vec4 osgTerrainLight_lamps[16];
uniform vec3 osgTerrainLight_lampRadiances[16];

// The surface of a form that is drawn may lie within the form that distances are to, as that of a
// house within its box: then the place outside that the normal leads to.
vec3 terrainOutside(DistanceField field, vec3 place, vec3 normal)
{
    vec3 outside = place;
    // A voxel above a surface the distance is a voxel, less in corners, and about 0 where two
    // surfaces touch, but for rounding and interpolation: only below that it lies within.
    Length least = -0.25 * field.voxel;
    for (int step = 0; step < 32; ++step)
    {
        Length ahead =
            objectDistance(osgTerrainLight_objectVolume, field, outside + normal * field.voxel).x;
        if (ahead > least)
            break;
        // Then on until it is outside, but for the sixteenth of a voxel that 8 bits step by.
        least = 0.9 * field.voxel;
        outside += normal * max(field.voxel - ahead, 0.25 * field.voxel);
    }
    return outside;
}

// What the objects leave of the light of the ground that is seen in a cone, and send to it: the
// mean of four places in it, so that its spots do not show on walls.
vec3 terrainGroundShare(DistanceField field, vec3 place, vec4 cone)
{
    vec3 plane = osgTerrainLight_objectPlane;
    float above = max(place.z - plane.x - dot(plane.yz, place.xy), 0.0);
    float falls = dot(plane.yz, cone.xy) - cone.z; // per metre along the axis
    if (falls <= 0.0)
        return vec3(1.0);
    vec2 middle = place.xy + cone.xy * (above / falls);
    float spread = 0.7 * cone.w * above / falls;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i)
    {
        vec2 there = middle + spread * vec2(i % 2 * 2 - 1, i / 2 * 2 - 1);
        there /= field.size.xy;
        sum += there == clamp(there, 0.0, 1.0)
                   ? textureLod(osgTerrainLight_objectGround, there, 0.0)
                   : vec4(1.0);
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(1.0);
}

// Irradiance / pi. What the objects leave of the probe's light, open: by cones, each with the light
// that the probe has from its direction, of sky and ground alike; and what they send.
vec3 terrainAmongObjects(DistanceField field, vec3 place, vec3 normal, vec3 open)
{
    int count = int(osgTerrainLight_objectCones[33].x);
    vec4 axes[32];
    uint near[32];
    float weights[32];
    for (int i = 0; i < count; ++i)
    {
        vec4 cone = osgTerrainLight_objectCones[i];
        axes[i] = vec4(aboutNormal(cone.xyz, normal), cone.w);
        near[i] = osgTerrainLight_objectAround[i];
        weights[i] = 1.0;
    }
    ConesOpen seen = conesAmongObjects(osgTerrainLight_objectVolume, field, place, normal, axes,
                                       near, weights, count, osgTerrainLight_objectCones[33].y,
                                       osgTerrainLight_objectCones[32]);
    AmbientCubes slabs;
    slabs.size = field.size;
    slabs.slabVoxels = field.size.z / (4.0 * field.voxel);
    vec3 all = vec3(0.0);
    vec3 left = vec3(0.0);
    vec3 sent = vec3(0.0);
    for (int i = 0; i < count; ++i)
    {
        // Harmonics ring below 0.
        vec3 radiance = max(texture(osgTerrainLight_probeGlossy, axes[i].xyz).rgb, 0.0);
        all += radiance;
        left += seen.light[i] *
                (osgTerrainLight_hasObjectRadiosity
                     ? radiance * terrainGroundShare(field, place, axes[i])
                     : radiance);
        if (osgTerrainLight_hasObjectRadiosity && seen.light[i] < 0.999)
        {
            vec3 met = nearestOnObject(osgTerrainLight_objectVolume, field,
                                        place + axes[i].xyz * seen.along[i]);
            sent += (1.0 - seen.light[i]) *
                    ambientCubeRadiance(osgTerrainLight_objectRadiosity, slabs, met,
                                        -axes[i].xyz);
        }
    }
    return open * mix(vec3(1.0), left / max(all, vec3(1.0e-20)), greaterThan(all, vec3(0.0))) +
           sent / float(count);
}

// place, normal: in eye coordinates, gl_ModelViewMatrix * gl_Vertex and gl_NormalMatrix *
// gl_Normal, of any length but 0. rgb: irradiance / pi, scene-linear, a: visible fraction of the
// sun. All 1 where there is no light for the object.
vec4 terrainObjectLight(vec3 place, vec3 normal)
{
    if (!osgTerrainLight_objectLit)
        return vec4(1.0);
    vec3 facing = normalize(mat3(osgTerrainLight_objectFromEye) * normal);
    vec4 light = texture(osgTerrainLight_probeDiffuse, facing);
    light = vec4(max(light.rgb, 0.0), clamp(light.a, 0.0, 1.0));
    float cosine = max(dot(facing, osgTerrainLight_sunDirection), 0.0);
    if (osgTerrainLight_hasObjectVolume)
    {
        DistanceField field;
        field.size = osgTerrainLight_objectField[0].xyz;
        field.voxel = osgTerrainLight_objectField[0].w;
        field.reach = osgTerrainLight_objectField[1].w;
        field.low = osgTerrainLight_objectField[1].xyz;
        field.high = osgTerrainLight_objectField[2].xyz;
        vec3 from = terrainOutside(
            field, (osgTerrainLight_objectFromEye * vec4(place, 1.0)).xyz, facing);
        light.rgb = terrainAmongObjects(field, from, facing, light.rgb);
        if (cosine > 0.0 && light.a > 0.0)
            light.a *= discAmongObjects(osgTerrainLight_objectVolume, field, from, facing,
                                        osgTerrainLight_sunDirection, osgTerrainLight_sunSine,
                                        1.0e30);
        for (int i = 0; i < osgTerrainLight_lampCount; ++i)
            light.rgb += osgTerrainLight_lampRadiances[i] *
                         lampAmongObjects(osgTerrainLight_objectVolume, field, from, facing,
                                          osgTerrainLight_lamps[i].xyz,
                                          osgTerrainLight_lamps[i].w);
    }
    light.rgb += osgTerrainLight_sunIrradiance * (light.a * cosine / PI);
    return light;
}
