// Towards the viewer, in the tile's frame: x east, y north, z up; not of length 1.
uniform mat3 osgTerrainLight_frame; // from the axes of vertices to the tile's

vec3 directionToViewer(vec4 vertex)
{
    vec3 toEye =
        gl_ProjectionMatrix[3][3] == 0.0 ? -(gl_ModelViewMatrix * vertex).xyz : vec3(0.0, 0.0, 1.0);
    return osgTerrainLight_frame * (transpose(mat3(gl_ModelViewMatrix)) * toEye);
}
