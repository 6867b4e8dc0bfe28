// A cube about the viewer, infinitely far away.
varying vec3 towards; // x east, y north, z up

void main()
{
    towards = gl_Vertex.xyz;
    vec4 place = gl_ProjectionMatrix * vec4(mat3(gl_ModelViewMatrix) * gl_Vertex.xyz, 0.0);
    // In the middle of the depths: neither plane cuts it.
    gl_Position = vec4(place.xy, 0.0, place.w);
}
