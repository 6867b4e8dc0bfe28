// A dispatch may run in pieces (GpuPass): the first group of this one.
uniform uvec3 firstGroup;
// The place of a group and of an invocation among those of all pieces.
#define GROUP (gl_WorkGroupID + firstGroup)
#define INVOCATION (gl_GlobalInvocationID + firstGroup * gl_WorkGroupSize)
