#pragma once

#include "scene/Scheduler.h"

#include <osg/Program>
#include <osg/Referenced>

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// The default programs of all tiles of a scene: of those that are not glossy, and of those that
/// are. Thread-safe.
class TilePrograms : public osg::Referenced
{
public:
    /// Made anew from the shaders as they are now. Earlier ones are kept: draws may be using them.
    void create();
    /// Null before create().
    osg::ref_ptr<osg::Program> get(bool glossy) const;

    /// Said once per message.
    void fail(const std::string& message) const;
    /// Empty where nothing has failed since create().
    std::string failure() const;

private:
    ~TilePrograms() override = default;
    mutable std::mutex _mutex;
    /// Plain, glossy; more than one pair where shaders are edited.
    std::vector<std::array<osg::ref_ptr<osg::Program>, 2>> _programs;
    mutable std::string _failure;
};

/// A sentence about a program that did not link in the state's context.
std::string whyNotLinked(const osg::Program& program, osg::State& state);

/// Stands for the tiles' program, plain or glossy as its tile is, where its tile is lit in the
/// context, and for none where it is not: the host scene then draws as if nothing had been
/// installed.
class TileProgram : public osg::Program
{
public:
    /// Precondition: programs have been created.
    TileProgram(const TilePrograms* programs, const Scheduler* scheduler, const LitTile* tile);

    void apply(osg::State& state) const override;
    int compare(const osg::StateAttribute& other) const override;
    void compileGLObjects(osg::State& state) const override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

private:
    osg::ref_ptr<const TilePrograms> _programs;
    osg::ref_ptr<const Scheduler> _scheduler;
    osg::ref_ptr<const LitTile> _tile;
};

} // namespace osgTerrainLight
