#pragma once

#include "core/AzimuthSet.h"

#include <osgTerrainLight/DemTile.h>

/// Terrains in closed form, with the horizon and sky-view factors that they must give. Slopes are
/// tangents of the elevation above the horizontal, lengths metres, angles radians; column and row
/// are posts. A sky-view factor here counts the sky above the horizontal only.
namespace osgTerrainLight::analytic
{

/// A void-free tile with square cells, heights from a function of (column, row).
template <class HeightOf>
DemTile makeTile(int width, int height, double spacing, const HeightOf& heightOf)
{
    DemTile tile(width, height, spacing);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            tile.setHeight(column, row, static_cast<float>(heightOf(column, row)));
    return tile;
}

/// The three sky-view factors of one post.
struct SkyView
{
    double solidAngle = 1.0;
    double horizontal = 1.0;
    double surface = 1.0;
};

/// Level ground. Horizon 0, sky-view factors 1.
DemTile plane(int width, int height, double spacing, double heightOfPlane);

/// A plane that rises by slopeEast per metre eastwards and slopeNorth northwards.
DemTile ramp(int width, int height, double spacing, double slopeEast, double slopeNorth);
double rampHorizon(double slopeEast, double slopeNorth, const MapDirection& direction);
/// Of a ramp of slope tan S: 1 − S/π, (1 + cos S)/2, (1 + cos S)/2.
SkyView rampSkyView(double slope);

/// Level ground, and from `firstColumn` eastwards a plateau `rise` higher; one cell of steep face.
DemTile wall(int width, int height, double spacing, int firstColumn, double rise);
/// Seen from the ground `distance` before the plateau's first column, where the ray meets it.
double wallHorizon(double rise, double distance, const MapDirection& direction);
/// The same for a wall that ends `halfLength` to either side of the receiver, at the data's edge.
SkyView wallSkyView(double rise, double distance, double halfLength);

/// A square hillock: flanks of 45° that rise from the foot, `footRadius` posts from the centre post
/// in each of the four directions, to a flat top `topRadius` posts from it.
DemTile hillock(int width, int height, double spacing, int centreColumn, int centreRow,
                int footRadius, int topRadius);
/// At a corner of its foot the crest towards the centre rises by 1 in √2: 35.264°.
double hillockCornerHorizon();

/// A cone of height `rise` and foot radius `radius` about a post.
DemTile cone(int width, int height, double spacing, int centreColumn, int centreRow, double rise,
             double radius);
/// Seen from the ground at `distance` > radius from the axis, `offset` from the azimuth of the
/// apex.
double coneHorizon(double rise, double radius, double distance, double offset);

/// A valley that runs north, with planar sides of the slope given; its bottom is a column of posts.
DemTile valley(int width, int height, double spacing, int bottomColumn, double slope);
double valleyHorizon(double slope, const MapDirection& direction); ///< from the bottom
SkyView valleySkyView(double slope);                               ///< from the bottom

/// A pit in level ground, the lower half of a sphere about a post of the ground.
DemTile pit(int width, int height, double spacing, int centreColumn, int centreRow, double radius);
/// At the bottom: horizon 45° everywhere, 1 − √½, ½, ½.
SkyView pitBottomSkyView();
/// Anywhere on the pit's wall.
double pitWallSurfaceSkyView();

/// The upper half of a sphere on level ground.
DemTile dome(int width, int height, double spacing, int centreColumn, int centreRow, double radius);
/// Seen from the ground at `distance` > radius from its axis, `offset` from its azimuth; 0 beside
/// it.
double domeHorizon(double radius, double distance, double offset);

/// Stairs that rise eastwards: treads of `tread` posts, each `rise` above the last, first riser
/// before column `tread`.
DemTile staircase(int width, int height, double spacing, int tread, double rise);
/// From a column of it, towards any direction with an east part that meets the next tread.
double staircaseHorizon(double spacing, int tread, double rise, int column,
                        const MapDirection& direction);

/// Posts of 0 and `rise` in turn; post (0, 0) is 0.
DemTile checkerboard(int width, int height, double spacing, double rise);
/// From a low post, towards the next low post on the diagonal: the slope at the receiver itself.
double checkerboardDiagonalHorizon(double spacing, double rise);

} // namespace osgTerrainLight::analytic
