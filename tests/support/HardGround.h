#pragma once

#include <osgTerrainLight/DemTile.h>

#include <cstdint>

/// Ground of the kinds that light between slopes finds hard, made from a seed. No setting was tuned
/// on the seeds that the tests use.
namespace osgTerrainLight::hard
{

/// Buildings with flat roofs, 4 to 16 m high, and streets 5 to 12 m wide: a surface model with a
/// post per metre, whose walls are one cell wide.
DemTile town(int side, std::uint32_t seed);

/// An open pit: a wavy bowl cut into benches 12 m high, with a post per 5 m. A face between two
/// benches is one cell wide.
DemTile mine(int side, std::uint32_t seed);

/// Dunes that the wind drives: gentle to windward, 32 degrees to leeward, posts 2 m apart.
DemTile dunes(int side, std::uint32_t seed);

/// Level ground with sinkholes, steep at the rim and round at the bottom, posts 2 m apart.
DemTile sinkholes(int side, std::uint32_t seed);

/// Sides of slope `tangent` that rise and fall in turn, each `sidePosts` posts long along a
/// direction `turned` degrees counter-clockwise from east; posts 1 m apart. The middle post stands
/// `up` posts up the side that faces in that direction.
DemTile corrugation(int width, int height, double sidePosts, double tangent, double turned,
                    double up);

/// What that post receives in the first bounce, irradiance / π, of a sun that shines in that
/// direction, `elevation` degrees high, with irradiance 1, albedo 1 and no sky, where the
/// corrugation is endless: the lit strip of the other side, which a strip of one radiance and
/// another make by the sines of the angles at which its edges are seen.
double corrugationBounce(double sidePosts, double tangent, double elevation, double up);

} // namespace osgTerrainLight::hard
