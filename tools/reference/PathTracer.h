#pragma once

#include "reference/RayScene.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace osgTerrainLight::reference
{

/// The light above the scene.
struct Illumination
{
    /// Sun, and the sky where it is uniform, each unless switched off.
    SkyLight light;
    /// Radiance towards a unit direction (x east, y north, z up), finite and ≥ 0; where given, it
    /// takes the place of the uniform sky. Called from several threads at once; must not throw.
    std::function<LinearRgb(const Vector3&)> environment;
    /// Where the sky is bright: directions are also drawn from this table, and weighed against the
    /// cosine's by the power heuristic, so that a texel brighter than all the rest converges. Any
    /// table is right, a good one is fast; empty: by the cosine alone. Values ≥ 0, proportional to
    /// radiance. Row 0 touches the nadir, the last row the zenith, rows being equal steps of
    /// elevation; column 0 begins in the east, columns run counter-clockwise.
    Raster<double> importance;
    /// Of sky and sun. AboveHorizontal is the library's: nothing comes from below the horizontal.
    SkyExtent extent = SkyExtent::AboveHorizontal;
};

/// A table for Illumination::importance: at each texel's centre the brightest colour.
Raster<double> importanceOf(const std::function<LinearRgb(const Vector3&)>& environment, int width,
                            int height);

/// A place that lies on nothing of the scene, and the way it faces.
struct FreePlace
{
    Vector3 at = {};     ///< metres from post (0, 0): x east, y north, z above heightOrigin
    Vector3 normal = {}; ///< unit
};

/// Where light is received.
struct Receiver
{
    /// A valid post, or …
    int column = 0;
    int row = 0;
    /// … where triangle ≥ 0, a point on its front: corner 0 + s·(corner 1 − corner 0) + t·(corner 2
    /// − corner 0).
    int triangle = -1;
    double s = 1.0 / 3.0;
    double t = 1.0 / 3.0;
    /// … or, where given, a place of its own. Rays meet all that is there: a place on a surface is
    /// given a little above it.
    std::optional<FreePlace> place = std::nullopt;
    /// Where given, a unit direction: what is received is weighed by the scene's glossy lobe about
    /// its mirror direction, instead of by the cosine over π. Times gloss it is what is sent there.
    std::optional<Vector3> towards = std::nullopt;
};

struct PathTracerOptions
{
    /// Paths per receiver, 1 … 2^26; rounded up so that each batch has a power of 2.
    int samples = 4096;
    /// Independent batches that these are split into, 2 … 4096. They give the standard errors.
    int batches = 32;
    /// Diffuse bounces, 0 … 1000.
    int bounces = 0;
    /// Same seed, same bits, whatever the number of threads.
    std::uint64_t seed = 1;
    /// 0: as many as the machine has.
    int threads = 0;
    /// Receivers done and in all; called after each, from one thread at a time. May be empty.
    std::function<void(std::size_t, std::size_t)> progress;
};

/// A mean and its standard error: the deviation of the batches' means over √batches, so
/// (mean − truth)/standardError follows Student's t with batches − 1 degrees of freedom. That holds
/// where batches see enough of what matters: light that a receiver's paths find once or never has
/// no honest error; more paths or an importance table give it one.
struct Estimate
{
    LinearRgb mean = {};
    LinearRgb standardError = {};
};

/// What a receiver gets: irradiance / π, in units of radiance, as the library's shading is.
struct ReceivedLight
{
    Estimate sky;                  ///< straight from the sky
    Estimate sun;                  ///< straight from the sun's disc
    Estimate emitters;             ///< straight from emitting triangles
    std::vector<Estimate> bounces; ///< [k]: what sky, sun and emitters send after k + 1 bounces
    Estimate total;                ///< the sum of all these, with an error of its own
    /// Visible part of the disc's solid angle, 0 … 1, in all three colours; 0 with the sun off.
    /// The surface's own facing is not in it, its own rise is.
    Estimate sunVisible;
    std::uint64_t samples = 0; ///< paths
    std::uint64_t rays = 0;
};

/// The oracle for light: a path tracer over the bilinear surface and triangles, unbiased but for
/// rounding, and with the error it has.
///
/// Surfaces are diffuse (Lambert), the ground may be glossy besides. Receivers at posts have the
/// normal of surfaceNormal(), as the library's have; where light bounces it is the surface's own.
/// Beyond the data the horizon is open. From each place on a path goes one ray by the cosine's
/// density, or that of cosine and lobe together, which meets the sky, an emitter or the next place;
/// one towards a point of the sun's disc, uniform in solid angle; and one by the importance table,
/// where there is one (Veach and Guibas, SIGGRAPH 1995, for the two sky estimates). There is no
/// Russian roulette. Random numbers: LatinSupercube.
class PathTracer
{
public:
    /// Errors: those of RayScene::build().
    static Result<PathTracer> build(SceneDescription description);

    /// Light at each receiver, in their order. The k-th of a list draws other random numbers than
    /// the rest, so one receiver given n times gets n independent estimates.
    ///
    /// Errors, all Invalid: a receiver outside the tile, on a void post, outside its triangle or at
    /// a place that is not finite or has no unit normal; an option, radiance, irradiance, sun or
    /// table out of range; a table that is 0 all over the sky's extent; a radiance that comes out
    /// not finite.
    Result<std::vector<ReceivedLight>> trace(const Illumination& illumination,
                                             const std::vector<Receiver>& receivers,
                                             const PathTracerOptions& options = {}) const;

    const RayScene& scene() const { return *_scene; }

private:
    explicit PathTracer(std::unique_ptr<RayScene> scene);
    std::unique_ptr<RayScene> _scene;
};

} // namespace osgTerrainLight::reference
