// Sky light by samples along the normal, as Evans has it (SIGGRAPH 2006, "Fast approximations for
// global illumination on dynamic scenes", sections 9.5 and 9.6 and listing 1). All that is solid is
// in the volumes, the ground too, and what comes out is light, not a factor.
//
// His text and his listing differ. The text has S positive inside, C = exp(k sum(S(P + d N') + d))
// with d_0 = 0 and N' = N + U / 2, and a k that must be negative for shadows to be dark. The
// listing has exp(+sum(w S(P + d N'))) without the d, N' = N + U, four samples and weights, and is
// brighter the larger S is, so its S is positive outside. Here the sign is that of the rest of the
// library: a stored value is positive OUTSIDE, the text's S is minus that, and `contrast` is minus
// its k.

struct NormalSamples
{
    vec3 size;       // of the volumes [m]
    Length reach;    // what a stored 1 stands for; 1 where no distance is stored
    Length spacing;  // of the first sample: the others are at 2, 4 and 8 times that
    real tilt;       // of the normal towards the zenith, alpha
    real own;        // weight of the sample at the place itself: 1 text, 0 listing
    vec4 weights;    // of the four others
    real expected;   // 1: minus what open space has, d (text); 0: not (listing)
    real contrast;   // over the sum
    real brightness; // open level ground's, inverted: that comes out as 1
};

Length normalSample(DistanceVolume volume, NormalSamples samples, vec3 place)
{
    return textureLod(volume, place / samples.size, real(0.0)).x * samples.reach;
}

// finest ... coarsest: the same volume, or each blurred twice as far as the one before. place [m]:
// in the frame of their first corner; normal: unit.
real normalSamplesLight(DistanceVolume finest, DistanceVolume fine, DistanceVolume coarse,
                        DistanceVolume coarsest, NormalSamples samples, vec3 place, vec3 normal)
{
    GLSL_ASSERT(samples.spacing > real(0.0));
    vec3 towards = vec3(normal.x, normal.y, normal.z + samples.tilt) * samples.spacing;
    Length open = samples.expected * samples.spacing;
    Length first = normalSample(finest, samples, place + towards) - open;
    Length second = normalSample(fine, samples, place + towards * real(2.0)) - open * real(2.0);
    Length third = normalSample(coarse, samples, place + towards * real(4.0)) - open * real(4.0);
    Length last = normalSample(coarsest, samples, place + towards * real(8.0)) - open * real(8.0);
    real sum = dot(samples.weights, vec4(first, second, third, last));
    if (samples.own > real(0.0))
        sum += samples.own * normalSample(finest, samples, place);
    return samples.brightness * exp(samples.contrast * sum);
}
