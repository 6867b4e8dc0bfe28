#pragma once

#include "lighting/TileObjects.h"
#include "scene/FormerLight.h"
#include <osgTerrainLight/ShadingTexture.h>

#include <osg/Program>
#include <osg/StateSet>
#include <osg/Texture2D>
#include <osg/Texture2DArray>

#include <string>
#include <vector>

namespace osgTerrainLight
{

/// Puts a shading texture on a host's StateSet, and takes it off when destroyed: the StateSet is
/// then what it was, but for what the host itself changed meanwhile. Between, the StateSet is
/// osg::Object::DYNAMIC: updates wait for threads that draw with it, so that it may be changed.
class ShadingBinding
{
public:
    /// program: null where the host's own shaders read the texture. Precondition: stateSet was
    /// DYNAMIC in the last frame, or not drawn in it.
    ShadingBinding(osg::StateSet* stateSet, osg::Texture2D* shading, unsigned unit,
                   const ShadingCoordinates& coordinates, osg::Program* program);
    ~ShadingBinding();
    ShadingBinding(const ShadingBinding&) = delete;
    ShadingBinding& operator=(const ShadingBinding&) = delete;

    osg::StateSet* stateSet() const { return _stateSet.get(); }
    unsigned unit() const { return _shading.unit; } ///< of the shading

    /// What is bound to the StateSet, or to the one that it is a copy of. Null where nothing is.
    static ShadingBinding* on(const osg::StateSet* stateSet);
    /// A copy of a StateSet with this binding on it, as it is without.
    osg::ref_ptr<osg::StateSet> without(const osg::StateSet& bound) const;

    /// Its tile is gone, and it only waits for frames that still use it: another may be bound.
    void retire() { _retired = true; }
    bool isRetired() const { return _retired; }
    /// What the destructor does, now.
    void takeOff();

    /// What the StateSet was if the caller has made it DYNAMIC.
    void setTheirVariance(osg::Object::DataVariance variance) { _theirVariance = variance; }

    /// Light sent by gloss, in a texture unit; null: none, and no unit.
    void setGloss(osg::Texture2DArray* light, unsigned unit);
    osg::Texture2DArray* gloss() const { return _gloss.texture.get(); }

    /// The edges of the sun's shadow, in their unit; null: none, and nothing in it.
    void setEdges(osg::Texture2D* edges);
    osg::Texture2D* edges() const { return _edges.texture.get(); }

    /// What placed objects leave of the light, in its unit; null: none, and nothing in it. At most
    /// mostObjects.
    void setObjects(osg::Texture2D* factor, const TileObjects& objects);
    osg::Texture2D* objects() const { return _objects.texture.get(); }
    static constexpr std::size_t mostObjects = 8; ///< as in terrain_shading.glsl

    /// Former light, in its units. toFormer: from the texture coordinates of the shading to those
    /// of the former one. toShading: to the former coordinates, from places on the tile that is
    /// drawn, (0, 0) to (1, 1). All of the light is the former one until setFade().
    void setFormer(const FormerLight& light, const osg::Matrixd& toFormer,
                   const osg::Matrixd& toShading = {});
    /// How much of the light is the tile's own, 0 … 1, and what of the former light there is at
    /// least along borders. Where there is none of it the former light is let go, and nothing is in
    /// its units.
    void setFade(double own, const BorderParts& borders = {});

    /// Whether texture unit 0 holds the tile's colours. Effective with a program.
    void setHasColour(bool hasColour);

private:
    /// A texture of ours, and what the host had in its unit.
    template <class T>
    struct Bound
    {
        osg::ref_ptr<T> texture;
        unsigned unit = 0;
        osg::StateSet::RefAttributePair theirs;
        osg::StateSet::TextureModeList theirModes;
        std::size_t theirUnits = 0;
    };
    template <class T>
    void install(Bound<T>& bound, T* texture, unsigned unit);
    template <class T>
    static void remove(osg::StateSet& stateSet, const Bound<T>& bound);
    void removeFormer();
    void setBorders(const BorderParts& borders);
    void add(osg::Uniform* uniform);
    void removeAll(osg::StateSet& stateSet) const;

    class Mark;

    osg::ref_ptr<osg::StateSet> _stateSet;
    Bound<osg::Texture2D> _shading, _edges, _former, _formerEdges, _objects;
    Bound<osg::Texture2DArray> _gloss;
    osg::Matrixd _toShading; ///< effective with former light
    osg::ref_ptr<osg::Program> _program;
    osg::Object::DataVariance _theirVariance;

    struct Slot
    {
        std::string name;
        osg::ref_ptr<osg::Uniform> ours;
        osg::StateSet::RefUniformPair theirs; ///< null where there was none
    };
    std::vector<Slot> _uniforms;
    osg::StateSet::RefAttributePair _theirProgram;
    osg::ref_ptr<osg::Uniform> _hasColour, _edgeSampler, _hasEdges, _posts;
    osg::ref_ptr<osg::Uniform> _formerPart, _formerSampler, _formerMatrix, _formerEdgeSampler,
        _formerPosts, _hasBorders, _borders, _corners, _drawn, _bands;
    osg::ref_ptr<osg::Uniform> _objectSampler, _objectCount, _objectPlaces, _objectCorners;
    osg::ref_ptr<Mark> _mark;
    bool _retired = false;
};

/// From tile coordinates to texture coordinates: outermost posts are half a texel inside.
osg::Matrixd texelCentres(const osg::Texture2D& shading);

/// The program for stock osgTerrain tiles, from shaders/host. glossy: adds light sent by gloss.
osg::ref_ptr<osg::Program> createDefaultProgram(bool glossy = false);

/// The same for DynamicTerrain, which it displaces; without light where !lit. Needs OpenGL 3.3.
osg::ref_ptr<osg::Program> createDisplacedProgram(bool lit, bool glossy = false);

/// The program for placed objects without shaders of their own. Needs OpenGL 3.3.
osg::ref_ptr<osg::Program> createObjectProgram();

/// The program of a SkyDome.
osg::ref_ptr<osg::Program> createSkyProgram();

} // namespace osgTerrainLight
