#pragma once

#include "lighting/TileLight.h"

#include <osg/Program>
#include <osg/Referenced>
#include <osg/RenderInfo>

#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// A tile's lighting and, per graphics context, how far it has come.
class LitTile : public osg::Referenced
{
public:
    LitTile(std::string name, TileLight* lighting) : _name(std::move(name)), _lighting(lighting) {}

    const std::string& name() const { return _name; }
    TileLight& lighting() const { return *_lighting; }

    enum class Stage
    {
        Waiting, ///< never computed: the host scene draws unlit
        Lit,
        Failed ///< said once, not tried again
    };
    Stage stage(unsigned context) const;
    void setStage(unsigned context, Stage stage);
    void fail(unsigned context, const std::string& message);
    /// Of the first context where it failed; empty where there is none.
    std::string failure() const;
    /// ~0u: all contexts.
    void forget(unsigned context);
    /// What failed may be tried again.
    void retry();

    /// Light sent by gloss is bound to its StateSet, so that programs may read it.
    std::atomic<bool> glossy{false};

private:
    ~LitTile() override = default;
    std::string _name;
    osg::ref_ptr<TileLight> _lighting;
    mutable std::mutex _mutex;
    std::map<unsigned, Stage> _stages;
    std::map<unsigned, std::string> _failures; ///< where the stage is Failed, or was
};

/// The tiles of one TerrainLighting as its draw traversals see them. Thread-safe.
class TileSet : public osg::Referenced
{
public:
    void add(LitTile* tile);
    void remove(LitTile* tile);

    /// Something that tiles depend on has changed.
    void touch() { ++_revision; }
    void forget(unsigned context);

    /// The default programs of all tiles: of those that are not glossy, and of those that are.
    /// Earlier ones are kept: draws may be using them.
    void setPrograms(osg::Program* plain, osg::Program* glossy);
    /// Null before setPrograms().
    osg::ref_ptr<osg::Program> program(bool glossy) const;

    std::atomic<bool> enabled{true};
    std::atomic<double> budget{50.0}; ///< [ms] per frame; 0: no limit

    /// Whether tile may be drawn with its shading.
    bool isLit(const LitTile& tile, unsigned context) const
    {
        return enabled && tile.stage(context) == LitTile::Stage::Lit;
    }

    /// False where compute() would run a stage.
    bool isDone(unsigned context) const;

    /// The first reason why a context or a tile draws unlit; empty where there is none.
    std::string failure() const;
    /// Once per message.
    void programFailed(const std::string& message) const;

    /// Computes what has changed, in turn, within the budget. Needs a current context.
    void compute(osg::State& state);

private:
    ~TileSet() override = default;

    struct Context
    {
        bool asked = false, supported = false;
        unsigned done = 0;    ///< revision at which every tile was up to date
        std::size_t next = 0; ///< tile to begin with
    };
    bool supports(osg::State& state, Context& context);

    mutable std::mutex _mutex;
    std::vector<osg::ref_ptr<LitTile>> _tiles;
    std::map<unsigned, Context> _contexts;
    std::atomic<unsigned> _revision{1};
    /// Plain, glossy; more than one pair where shaders are edited.
    std::vector<std::array<osg::ref_ptr<osg::Program>, 2>> _programs;
    std::string _unsupported;
    mutable std::string _programFailure;
};

/// A sentence about a program that did not link in the state's context.
std::string whyNotLinked(const osg::Program& program, osg::State& state);

/// Stands for the tiles' program, plain or glossy as its tile is, where its tile is lit in the
/// context, and for none where it is not: the host scene then draws as if nothing had been
/// installed.
class TileProgram : public osg::Program
{
public:
    /// Precondition: tiles have programs.
    TileProgram(const TileSet* tiles, const LitTile* tile);

    void apply(osg::State& state) const override;
    int compare(const osg::StateAttribute& other) const override;
    void compileGLObjects(osg::State& state) const override;
    void releaseGLObjects(osg::State* state = nullptr) const override;
    void resizeGLObjectBuffers(unsigned size) override;

private:
    osg::ref_ptr<const TileSet> _tiles;
    osg::ref_ptr<const LitTile> _tile;
};

} // namespace osgTerrainLight
