#include "scene/TileFades.h"

#include "scene/FadingLod.h"

#include <osgTerrain/Layer>
#include <osgTerrain/Locator>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace osgTerrainLight
{

namespace
{
using Stage = TileState::Stage;

const osgTerrain::Locator& locatorOf(const SceneTile& tile)
{
    return *tile.terrain->getElevationLayer()->getLocator();
}

osg::Vec3d modelOf(const SceneTile& tile, double east, double north)
{
    osg::Vec3d model;
    locatorOf(tile).convertLocalToModel(osg::Vec3d(east, north, 0.0), model);
    return model;
}

std::array<osg::Vec3d, 3> cornersOf(const SceneTile& tile)
{
    if (!tile.terrain) // a host's, whose place stays
        return {osg::Vec3d(0.0, 0.0, 0.0), {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    return {modelOf(tile, 0.0, 0.0), modelOf(tile, 1.0, 0.0), modelOf(tile, 0.0, 1.0)};
}

/// Within a thousandth of the tile.
bool areSame(const std::array<osg::Vec3d, 3>& a, const std::array<osg::Vec3d, 3>& b)
{
    const double most = 1.0e-3 * (a[1] - a[0]).length();
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!((a[i] - b[i]).length() <= most))
            return false;
    return true;
}

/// From places on a tile to texture coordinates of its light.
osg::Matrixd toTexture(const SceneTile& tile)
{
    return tile.lit->fromDrawn() * texelCentres(*tile.lit->lighting().shading());
}

/// From places on a tile to those on another one, which covers it. None where the other does not
/// cover it, or the way is not affine to a hundredth of the other's size over its posts: then it
/// would show.
std::optional<osg::Matrixd> wayTo(const SceneTile& tile, const SceneTile& other)
{
    const osg::Matrixd change = tile.version.toScene * osg::Matrixd::inverse(other.version.toScene);
    const auto onOther = [&](double east, double north)
    {
        osg::Vec3d place;
        locatorOf(other).convertModelToLocal(modelOf(tile, east, north) * change, place);
        return place;
    };
    const osg::Vec3d corner = onOther(0.0, 0.0);
    const osg::Vec3d east = onOther(1.0, 0.0) - corner;
    const osg::Vec3d north = onOther(0.0, 1.0) - corner;
    const osg::Matrixd way(east.x(), east.y(), 0.0, 0.0, north.x(), north.y(), 0.0, 0.0, 0.0, 0.0,
                           1.0, 0.0, corner.x(), corner.y(), 0.0, 1.0);
    const double posts = std::max(other.lit->lighting().width(), other.lit->lighting().height());
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.5}})
    {
        const osg::Vec3d place = onOther(x, y);
        const osg::Vec3d found = osg::Vec3d(x, y, 0.0) * way;
        const bool inside =
            place.x() > -0.01 && place.y() > -0.01 && place.x() < 1.01 && place.y() < 1.01;
        if (!(inside && std::abs(found.x() - place.x()) * posts < 0.01 &&
              std::abs(found.y() - place.y()) * posts < 0.01))
            return std::nullopt;
    }
    return way;
}

/// Of the tile's own where that is there, else what it waits with.
std::optional<FormerLight> lightOf(const SceneTile& tile)
{
    if (!tile.lit || !tile.binding || !tile.lit->failure().empty())
        return std::nullopt;
    if (tile.lit->state().stage != Stage::Lit)
        return tile.former;
    FormerLight light;
    light.shading = tile.lit->lighting().shading();
    light.edges = tile.binding->edges();
    light.toTexture = toTexture(tile);
    light.contexts = tile.lit->litContexts();
    return light;
}

void end(SceneTile& tile)
{
    if (tile.binding)
        tile.binding->setFade(1.0);
    if (tile.lit)
        tile.lit->setFormer(std::nullopt);
    tile.former.reset();
    tile.borders = {};
}

/// By a step at most.
double towards(double value, double goal, double step)
{
    const double change = std::clamp(goal - value, -step, step);
    // Sums of steps are not exact.
    return std::abs(goal - value - change) < 1.0e-6 ? goal : value + change;
}
} // namespace

void TileFades::place(SceneTile& tile, const osg::NodePath& above)
{
    const bool isKnown = tile.finer.valid();
    TileLevels::place(tile, above);
    if (tile.finer && !isKnown &&
        std::none_of(_families.begin(), _families.end(),
                     [&](const Family& family) { return family.handle == tile.handle; }))
        _families.push_back({tile.handle});
}

void TileFades::keep(SceneTile& tile) const
{
    if (!tile.lit)
        return;
    tile.former = lightOf(tile);
    tile.borders = {};
}

std::optional<FormerLight> TileFades::above(const SceneTile& tile) const
{
    for (TileHandle handle = tile.handle; handle.level > 0;)
    {
        handle = TileHandle::at(handle.level - 1, handle.x / 2, handle.y / 2);
        const SceneTile* other = _registry.find(handle);
        if (!other || !other->terrain)
            continue;
        // Of the two lights that a tile fades between the nearer one.
        const bool early = other->former && !other->former->waits && other->former->part > 0.5;
        std::optional<FormerLight> light = early ? other->former : lightOf(*other);
        const std::optional<osg::Matrixd> way = light ? wayTo(tile, *other) : std::nullopt;
        if (!way)
            continue;
        light->toTexture = *way * light->toTexture;
        light->isAbove = true;
        light->waits = true;
        light->part = 1.0;
        return light;
    }
    return std::nullopt;
}

/// Binds the former light that the tile has. False where it is not drawn with it, and loses it.
bool TileFades::borrow(SceneTile& tile) const
{
    // Who has put a texture there keeps it, and the tile is drawn without.
    const osg::StateSet& stateSet = *tile.binding->stateSet();
    for (const unsigned unit : {ShadingTexture::formerUnit, ShadingTexture::formerEdgeUnit})
        if (unit == tile.binding->unit() || unit == _units.gloss ||
            stateSet.getTextureAttribute(unit, osg::StateAttribute::TEXTURE))
        {
            tile.former.reset();
            return false;
        }
    const osg::Matrixd own = toTexture(tile);
    tile.binding->setFormer(*tile.former, osg::Matrixd::inverse(own) * tile.former->toTexture, own);
    tile.lit->setFormer(tile.former->contexts, !tile.former->waits);
    if (tile.former->waits || tile.lit->isFormerEverywhere())
        return true;
    end(tile);
    return false;
}

/// Gives a tile that has its own light that of a tile above besides, of which nothing is drawn yet.
bool TileFades::addAbove(SceneTile& tile) const
{
    tile.former = above(tile);
    if (!tile.former)
        return false;
    tile.former->waits = false;
    tile.former->part = 0.0;
    return borrow(tile);
}

/// Whether the tile above has been lit since, or anew, into another texture.
bool TileFades::isRenewed(const SceneTile& tile) const
{
    const SceneTile* next =
        _registry.find(TileHandle::at(tile.handle.level - 1, tile.handle.x / 2, tile.handle.y / 2));
    if (next && next->lit && next->binding && !next->former &&
        next->lit->lighting().shading() == tile.former->shading &&
        next->binding->edges() == tile.former->edges)
        return false; // as nearly always
    const std::optional<FormerLight> now = above(tile);
    return now && !(now->shading == tile.former->shading && now->edges == tile.former->edges);
}

void TileFades::begin(SceneTile& tile)
{
    const std::array<osg::Vec3d, 3> corners = cornersOf(tile);
    if (tile.former && !areSame(corners, tile.corners))
        tile.former.reset();
    tile.corners = corners;
    if (!tile.former && tile.terrain)
        tile.former = above(tile);
    follow(tile.handle);
    if (!tile.former)
        return;
    tile.former->waits = true;
    tile.former->part = 1.0;
    if (borrow(tile))
        _tiles.insert(tile.handle);
}

void TileFades::follow(const TileHandle& handle)
{
    if (handle.level < 0)
        return;
    _tiles.insert(handle);
    for (const TileHandle& neighbour : TileLevels::around(handle))
        if (_registry.find(neighbour))
            _tiles.insert(neighbour);
}

/// The part of former light that all of the tile has, moved by a step.
double TileFades::faded(const SceneTile& tile, bool isCurrent) const
{
    const bool leaves = TileLevels::leaves(tile) && tile.former->isAbove && isCurrent;
    return towards(tile.former->part, leaves ? 1.0 : 0.0, _step);
}

/// Moves the part of former light that all of the tile has.
void TileFades::fade(SceneTile& tile)
{
    const bool isLit = tile.lit->state().stage == Stage::Lit;
    if (!tile.former && isLit && TileLevels::leaves(tile))
        addAbove(tile);
    if (!tile.former)
        return;
    if (!tile.lit->isFormerEverywhere() || !tile.lit->failure().empty())
        return end(tile);
    // Nobody sees it.
    if (tile.former->isAbove && !_levels.isReached(tile) && isRenewed(tile))
    {
        const bool waits = tile.former->waits;
        end(tile);
        if (!addAbove(tile))
            return;
        tile.former->part = 1.0;
        tile.former->waits = waits;
        tile.lit->setFormer(tile.former->contexts, !waits);
    }
    FormerLight& former = *tile.former;
    const double before = former.part;
    const bool begins = isLit && former.waits;
    if (isLit == former.waits)
    {
        former.waits = !isLit;
        former.part = 1.0;
        tile.lit->setFormer(former.contexts, isLit);
    }
    if (isLit && (!begins || !(seconds > 0.0)))
        former.part = faded(tile, !former.isAbove || !isRenewed(tile));
    if (former.part != before)
        follow(tile.handle);
}

/// Moves the parts along the borders.
void TileFades::blend(SceneTile& tile)
{
    BorderParts goal;
    const bool isSeen = _levels.isReached(tile) && !TileLevels::isRefined(tile);
    // Neither finer ones that take its place have it, nor did those whose place it takes.
    const bool givesWay =
        tile.finer && tile.finer->getNumChildren() > 1 && TileLevels::wantsFiner(*tile.finer);
    if (tile.coarser && isSeen && !givesWay && !(tile.former && !tile.former->isAbove))
    {
        const std::array<TileHandle, 8> around = TileLevels::around(tile.handle);
        for (std::size_t i = 0; i < 4; ++i)
        {
            goal.sides[i] = _levels.coarserPart(around[i]);
            goal.corners[i] = _levels.coarserPart(around[4 + i]);
        }
    }
    const bool isLit = tile.lit->state().stage == Stage::Lit;
    if (!tile.former && goal.any() && isLit)
        addAbove(tile);
    // The one above may not be lit yet.
    tile.lacksAbove =
        !tile.former && tile.coarser && (goal.any() || !isLit) && tile.lit->failure().empty();
    if (!tile.former)
        return;
    // Other light comes into the borders once the former one has gone.
    if (isLit && tile.former->part <= 0.0 && goal.any() && isRenewed(tile))
        goal = {};
    // A tile that is drawn with the light above alone has it along borders from the first.
    const double step = tile.former->part >= 1.0 || !isSeen ? 1.0 : _step;
    for (std::size_t i = 0; i < 4; ++i)
    {
        const auto move = [step](float& part, float to)
        { part = static_cast<float>(towards(double(part), double(to), step)); };
        move(tile.borders.sides[i], goal.sides[i]);
        move(tile.borders.corners[i], goal.corners[i]);
    }
    if (tile.former->part > 0.0 || tile.borders.any() || goal.any())
        tile.binding->setFade(1.0 - tile.former->part, tile.borders);
    else
        end(tile);
}

/// Notes which tiles are drawn in the place of others, and which should be.
void TileFades::followLevels(const osg::FrameStamp* stamp)
{
    for (std::size_t i = 0; i < _families.size();)
    {
        Family& family = _families[i];
        const SceneTile* tile = _registry.find(family.handle);
        if (!tile || !tile->finer)
        {
            family = _families.back();
            _families.pop_back();
            continue;
        }
        const bool isFading = tile->former && !tile->former->waits &&
                              (tile->former->part > 0.0 || tile->borders.any());
        if (auto* lod = dynamic_cast<FadingLod*>(tile->finer.get());
            lod && stamp && isFading && !family.isRefined && lod->getNumChildren() > 1)
            lod->holdCoarser(stamp->getFrameNumber());
        const bool isRefined = TileLevels::isRefined(*tile->finer);
        const bool wantsFiner = TileLevels::wantsFiner(*tile->finer);
        const unsigned children = tile->finer->getNumChildren();
        if (isRefined != family.isRefined || wantsFiner != family.wantsFiner ||
            children != family.children)
        {
            family.isRefined = isRefined;
            family.wantsFiner = wantsFiner;
            family.children = children;
            _tiles.insert(family.handle);
            for (const SceneTile* child : _levels.below(*tile))
                if (child)
                    follow(child->handle);
        }
        ++i;
    }
}

/// Whether the tile above may be drawn in the place of this one, and nobody sees a step.
bool TileFades::mayLeave(const SceneTile& tile) const
{
    if (!tile.lit || !tile.binding || !tile.lit->failure().empty())
        return true;
    if (TileLevels::isRefined(tile))
        return false;
    return !tile.former || (tile.former->isAbove && tile.former->part >= 1.0 && !isRenewed(tile));
}

/// Finer tiles stay until they have the light above.
void TileFades::hold(const osg::FrameStamp* stamp)
{
    if (!stamp || !(seconds > 0.0))
        return;
    for (const Family& family : _families)
    {
        const SceneTile* tile = _registry.find(family.handle);
        auto* lod = tile ? dynamic_cast<FadingLod*>(tile->finer.get()) : nullptr;
        if (!lod || !family.isRefined)
            continue;
        bool isHeld = family.wantsFiner;
        if (!isHeld)
            for (const SceneTile* child : _levels.below(*tile))
                isHeld = isHeld || (child && !mayLeave(*child));
        if (isHeld)
            lod->holdFiner(stamp->getFrameNumber());
    }
}

/// By simulation time, so that a flight that is recorded with a fixed time per frame is the same
/// each time. Where that stands still, by reference time: else light would stay a former one.
void TileFades::advance(const osg::FrameStamp* stamp)
{
    _step = 1.0;
    if (!stamp)
        return;
    const double simulation = stamp->getSimulationTime() - _simulation;
    const double reference = stamp->getReferenceTime() - _reference;
    const double passed = simulation > 0.0 ? simulation : std::max(reference, 0.0);
    if (passed < seconds)
        _step = passed / seconds;
    _simulation = stamp->getSimulationTime();
    _reference = stamp->getReferenceTime();
}

void TileFades::update(const osg::FrameStamp* stamp, bool isOn)
{
    advance(stamp);
    followLevels(isOn ? stamp : nullptr);
    const auto forEach = [this](void (TileFades::*what)(SceneTile&))
    {
        for (const TileHandle& handle : std::vector<TileHandle>(_tiles.begin(), _tiles.end()))
            if (SceneTile* tile = _registry.find(handle); tile && tile->lit && tile->binding)
                (this->*what)(*tile);
    };
    if (!_tiles.empty())
    {
        forEach(&TileFades::fade);
        forEach(&TileFades::blend);
    }
    for (auto handle = _tiles.begin(); handle != _tiles.end();)
    {
        const SceneTile* tile = _registry.find(*handle);
        const bool stays = tile && tile->lit && (tile->former || tile->lacksAbove);
        handle = stays ? std::next(handle) : _tiles.erase(handle);
    }
    hold(isOn ? stamp : nullptr);
}

void TileFades::releaseGLObjects(osg::State* state) const
{
    for (const TileHandle& handle : _tiles)
        if (const SceneTile* tile = _registry.find(handle); tile && tile->former)
            for (const osg::Texture2D* texture :
                 {tile->former->shading.get(), tile->former->edges.get()})
                if (texture)
                    texture->releaseGLObjects(state);
}

} // namespace osgTerrainLight
