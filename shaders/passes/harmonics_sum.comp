// Adds what groups of environment_harmonics.comp found: a group per coefficient, in a fixed order,
// so that the same environment gives the same bits.
layout(local_size_x = 64) in;

uniform sampler2D partials; // column i: coefficient i, row: group
layout(rgba32f, binding = 0) writeonly uniform image2D harmonics; // column i: coefficient i
uniform int groups;
uniform float gain;
shared vec3 sums[64];

void main()
{
    int id = int(gl_LocalInvocationIndex);
    int coefficient = int(gl_WorkGroupID.x);
    vec3 sum = vec3(0.0);
    for (int row = id; row < groups; row += 64)
        sum += texelFetch(partials, ivec2(coefficient, row), 0).rgb;
    sums[id] = sum;
    barrier();
    vec3 whole = vec3(0.0);
    for (int i = 0; i < 64; ++i)
        whole += sums[i];
    if (id == 0)
        imageStore(harmonics, ivec2(coefficient, 0), vec4(gain * whole, 1.0));
}
