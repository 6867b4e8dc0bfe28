#pragma once

#include "Pipeline.h"

#include "reference/PathTracer.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// `terrainlight bench`: what is true at some posts of a terrain, and how far a result is from it.
namespace osgTerrainLight::tool::bench
{

/// job(0) … job(count − 1) on all cores. progress: 0 … 1, on the calling thread.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& job,
                const std::function<void(double)>& progress);

struct Post
{
    int column = 0, row = 0;
};

/// The reference's values at random valid posts. Every post has the sun's; the first skyPosts have
/// the rest, which takes many more directions.
struct Truth
{
    static constexpr int skyAzimuths = 720;
    static constexpr int sunStrips = 33;
    /// Wrong shadows are rare and big, and a post's sun costs 1/22 of its sky.
    static constexpr std::size_t sunPostsPerSkyPost = 10;

    std::vector<Post> posts;
    std::size_t skyPosts = 0;
    std::vector<double> sun;      ///< visible fraction of the disc
    std::vector<double> sky;      ///< sky-view factor, definition `surface`
    double skyLuminance = 0.0;    ///< radiance of the sky
    std::vector<double> sunlight; ///< luminance where the whole disc is seen, all posts
    /// Horizon elevation [degrees], clamped at 0, post by post, by azimuth count. A count that
    /// divides another has no entry of its own.
    std::map<int, std::vector<double>> horizons;
    /// Luminance of the light that bounces, at the first posts, and its squared standard error.
    std::vector<double> indirect, indirectVariance;

    double horizon(std::size_t post, int azimuth, int azimuths) const;
};

/// Fewer posts where the tile has fewer valid ones, of which it needs one. Runs on all cores; the
/// same arguments give the same bits. progress: 0 … 1, on the calling thread.
Truth findTruth(const DemTile& tile, const SkyLight& sky, const std::vector<int>& azimuthCounts,
                std::size_t skyPosts, std::uint32_t seed,
                const std::function<void(double)>& progress);

/// Light that bounces, at some posts, by the path tracer: irradiance / pi of all bounces together.
class IndirectTruth
{
public:
    /// A post takes some 100 times as long as its sky, and few posts say enough: errors are spread
    /// evenly, unlike the sun's.
    static constexpr std::size_t skyPostsPerPost = 10;
    static constexpr std::uint64_t firstPaths = 1024, mostPaths = 1u << 20;

    /// At the first of truth.posts, which it refers to. Errors: those of PathTracer::build().
    static Result<IndirectTruth> build(const DemTile& tile, const SkyLight& sky,
                                       const LightingSettings& settings, std::uint32_t seed,
                                       std::size_t skyPosts, Truth& truth);

    /// Adds that many paths to each post (a few more: up to the next power of two), or, where there
    /// are some, as many again as there are. progress: 0 … 1.
    Status refine(std::uint64_t paths, const std::function<void(double)>& progress);

    std::uint64_t paths() const { return _paths; } ///< per post

private:
    IndirectTruth(reference::PathTracer tracer, Truth& truth)
        : _tracer(std::move(tracer)), _truth(truth)
    {
    }

    reference::PathTracer _tracer;
    Truth& _truth;
    reference::Illumination _illumination;
    std::vector<reference::Receiver> _receivers;
    int _bounces = 1;
    std::uint64_t _seed = 0, _runs = 0, _paths = 0;
};

/// A result, read back.
struct Found
{
    HorizonMap horizons;
    Raster<float> sky;
    Raster<osg::Vec4f> direct;    ///< light
    std::vector<double> indirect; ///< luminance of all bounces, post by post
};

/// Of found − expected. Where what is expected has a variance of its own, that is taken out of the
/// two mean squares, and stays in the rest.
struct ErrorStatistics
{
    double mean = 0.0; ///< of absolute values
    double rms = 0.0;
    double p99 = 0.0; ///< of absolute values
    double max = 0.0; ///< of absolute values
    double bias = 0.0;
    double relativeRms = 0.0;   ///< RMS error over the RMS of what is expected; NaN where that is 0
    double relativeNoise = 0.0; ///< RMS of the standard errors over the same
};

struct Compared
{
    double found, expected;
    double variance = 0.0; ///< of what is expected
};
/// All NaN where there is nothing to compare.
ErrorStatistics statisticsOf(const std::vector<Compared>& values);

/// Something that a result can be wrong in. A new one is an entry of directQuantities().
struct Quantity
{
    std::string name;  ///< begins its columns
    std::string unit;  ///< ends them
    std::string title; ///< for people
    /// The error that its front and its part of the picture are about.
    double ErrorStatistics::*main;
    std::string mainTitle;
    std::vector<Compared> (*compare)(const Truth&, const Found&);
    bool noisy = false; ///< what is expected has a variance
};
const std::vector<Quantity>& directQuantities();
const Quantity& indirectQuantity();

} // namespace osgTerrainLight::tool::bench
