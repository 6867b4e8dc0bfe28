// Light among placed objects for many reads of few texels: an ambient cube (McTaggart 2004, "Half-
// Life 2 / Valve Source Shading") in every voxel says what objects leave of the light on a surface
// that faces each of the six ways along the axes. Three of them give any normal's.

// Six slabs of values above one another in one texture: for +x, -x, +y, -y, +z and -z. Of light on
// a surface that faces there, or of what objects send there, premultiplied by how much of a surface
// there is (a).
struct AmbientCubes
{
    vec3 size;       // of what a slab covers [m]
    real slabVoxels; // of a slab along z, >= 1
};

// lobe: 0 ... 5, the slab. Clamped within it, so that no slab reads its neighbour.
vec4 ambientLobe(DistanceVolume cubes, AmbientCubes slabs, vec3 place, int lobe)
{
    real edge = real(0.5) / slabs.slabVoxels;
    real up = clamp(place.z / slabs.size.z, edge, real(1.0) - edge);
    return textureLod(cubes,
                      vec3(place.x / slabs.size.x, place.y / slabs.size.y,
                           (real(lobe) + up) / real(6.0)),
                      real(0.0));
}

// place [m]: in the frame of the slabs' first corner; normal: unit. Squared cosines add up to 1, so
// where all lobes are alike the normal does not matter.
vec4 ambientCubeLight(DistanceVolume cubes, AmbientCubes slabs, vec3 place, vec3 normal)
{
    vec4 light = vec4(real(0.0));
    for (int axis = 0; axis < 3; ++axis)
        light += normal[axis] * normal[axis] *
                 ambientLobe(cubes, slabs, place,
                             2 * axis + (normal[axis] < real(0.0) ? 1 : 0));
    return light;
}

// Radiance that surfaces near a place send in a direction, unit; 0 where there are none.
vec3 ambientCubeRadiance(DistanceVolume cubes, AmbientCubes slabs, vec3 place, vec3 direction)
{
    vec4 sent = ambientCubeLight(cubes, slabs, place, direction);
    return vec3(sent.x, sent.y, sent.z) / max(sent.w, real(1.0e-3));
}
