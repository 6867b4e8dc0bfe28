#pragma once

#include "scene/TilePrograms.h"

#include <osg/Program>

namespace osgTerrainLight
{

/// The program of a DynamicTerrain, which must be displaced with light, with gloss besides, and
/// without: one of three, chosen per context.
class DisplacedProgram : public osg::Program
{
public:
    /// Null: never lit.
    explicit DisplacedProgram(const TilePrograms* programs = nullptr,
                              const Scheduler* scheduler = nullptr, const LitTile* tile = nullptr);

    void apply(osg::State& state) const override;
    int compare(const osg::StateAttribute& other) const override;
    void compileGLObjects(osg::State& state) const override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

private:
    osg::ref_ptr<const TilePrograms> _programs; ///< that are told of failures
    osg::ref_ptr<const Scheduler> _scheduler;
    osg::ref_ptr<const LitTile> _tile;
    osg::ref_ptr<osg::Program> _lit;    ///< null without a tile
    osg::ref_ptr<osg::Program> _glossy; ///< likewise
    osg::ref_ptr<osg::Program> _unlit;
};

} // namespace osgTerrainLight
