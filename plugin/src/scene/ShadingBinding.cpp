#include "scene/ShadingBinding.h"

#include "gpu/ShaderLibrary.h"
#include <osgTerrainLight/DynamicTerrain.h>
#include <osgTerrainLight/LightProbe.h>
#include <osgTerrainLight/PlacedObject.h>

#include <algorithm>
#include <cassert>

namespace osgTerrainLight
{

namespace
{
constexpr const char* fromVertexName = "osgTerrainLight_fromVertex";
constexpr const char* hasColourName = "osgTerrainLight_hasColour";
constexpr const char* colourName = "osgTerrainLight_colour";

/// A texture that another tile computes. The StateSet that it is on neither releases nor resizes
/// what that tile relies on.
class BorrowedTexture : public osg::Texture2D
{
public:
    explicit BorrowedTexture(osg::Texture2D* texture) : _texture(texture) {}

    void apply(osg::State& state) const override { _texture->apply(state); }
    void compileGLObjects(osg::State&) const override {}
    void releaseGLObjects(osg::State*) const override {}
    void resizeGLObjectBuffers(unsigned) override {}

private:
    ~BorrowedTexture() override = default;
    osg::ref_ptr<osg::Texture2D> _texture;
};

osg::ref_ptr<osg::Texture2D> borrowed(osg::Texture2D* texture)
{
    return new BorrowedTexture(texture);
}

osg::Vec2f texelsOf(const osg::Texture2D& texture)
{
    return {static_cast<float>(texture.getTextureWidth()),
            static_cast<float>(texture.getTextureHeight())};
}

/// Of files in this order; messages call it by the last.
osg::ref_ptr<osg::Shader> composedShader(osg::Shader::Type type,
                                         const std::vector<std::string>& files,
                                         const std::string& version)
{
    std::string text = "#version " + version + "\n";
    for (const std::string& file : files)
    {
        const Result<std::string> part = ShaderLibrary::instance().source(file);
        assert(part.ok());
        text += "#line 1\n" + (part ? *part : "");
    }
    osg::ref_ptr<osg::Shader> shader = new osg::Shader(type, text);
    shader->setName(files.back());
    return shader;
}

osg::ref_ptr<osg::Shader> hostShader(osg::Shader::Type type, const std::string& file,
                                     const std::string& version)
{
    return composedShader(type, {"host/" + file}, version);
}

/// One that writes colours.
osg::ref_ptr<osg::Shader> colourShader(const std::string& file, const std::string& version)
{
    return composedShader(osg::Shader::FRAGMENT, {"host/srgb.glsl", "host/" + file}, version);
}

osg::ref_ptr<osg::Shader> glossShader(osg::Shader::Type type, const std::string& version)
{
    return composedShader(
        type, {"preamble.glsl", "lib/angle.glsl", "lib/legendre.glsl", "host/terrain_gloss.glsl"},
        version);
}

osg::ref_ptr<osg::Shader> objectShader(osg::Shader::Type type, const std::string& version)
{
    return composedShader(type,
                          {"preamble.glsl", "lib/angle.glsl", "lib/object_light.glsl",
                           "lib/ambient_cube.glsl", "host/terrain_objects.glsl"},
                          version);
}

void addGloss(osg::Program& program, const std::string& version)
{
    program.addShader(hostShader(osg::Shader::VERTEX, "viewer_direction.vert", version));
    program.addShader(glossShader(osg::Shader::FRAGMENT, version));
}
} // namespace

osg::Matrixd texelCentres(const osg::Texture2D& shading)
{
    const double width = shading.getTextureWidth();
    const double height = shading.getTextureHeight();
    return osg::Matrixd::scale((width - 1.0) / width, (height - 1.0) / height, 1.0) *
           osg::Matrixd::translate(0.5 / width, 0.5 / height, 0.0);
}

osg::ref_ptr<osg::Shader> createShadingShader(osg::Shader::Type type, int version)
{
    return hostShader(type, "terrain_shading.glsl", std::to_string(version));
}

osg::ref_ptr<osg::Shader> createGlossShader(osg::Shader::Type type, int version)
{
    return glossShader(type, std::to_string(version));
}

osg::ref_ptr<osg::Shader> createObjectShader(osg::Shader::Type type, int version)
{
    return objectShader(type, std::to_string(version));
}

osg::ref_ptr<osg::Program> createObjectProgram()
{
    const std::string version = "330 compatibility";
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName("osgTerrainLight default object");
    program->addShader(hostShader(osg::Shader::VERTEX, "default_object.vert", version));
    program->addShader(objectShader(osg::Shader::FRAGMENT, version));
    program->addShader(colourShader("default_object.frag", version));
    return program;
}

osg::ref_ptr<osg::Shader> createHeightShader(osg::Shader::Type type, int version)
{
    return hostShader(type, "terrain_heights.glsl", std::to_string(version));
}

osg::ref_ptr<osg::Shader> createProbeShader(osg::Shader::Type type, int version)
{
    return hostShader(type, "terrain_probe.glsl", std::to_string(version));
}

osg::ref_ptr<osg::Program> createDefaultProgram(bool glossy)
{
    const std::string version = glossy ? "330 compatibility" : "120";
    const std::string define = glossy ? "\n#define GLOSS" : "";
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName(glossy ? "osgTerrainLight default glossy terrain"
                            : "osgTerrainLight default terrain");
    for (osg::Shader::Type type : {osg::Shader::VERTEX, osg::Shader::FRAGMENT})
        program->addShader(hostShader(type, "terrain_shading.glsl", version));
    program->addShader(hostShader(osg::Shader::VERTEX, "default_terrain.vert", version + define));
    program->addShader(colourShader("default_terrain.frag", version + define));
    if (glossy)
        addGloss(*program, version);
    return program;
}

osg::ref_ptr<osg::Program> createSkyProgram()
{
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName("osgTerrainLight sky");
    program->addShader(hostShader(osg::Shader::VERTEX, "sky_dome.vert", "120"));
    program->addShader(colourShader("sky_dome.frag", "120"));
    return program;
}

osg::ref_ptr<osg::Program> createDisplacedProgram(bool lit, bool glossy)
{
    const std::string version = "330 compatibility";
    const std::string define = glossy ? "\n#define GLOSS" : "";
    osg::ref_ptr<osg::Program> program = new osg::Program;
    program->setName(lit ? "osgTerrainLight dynamic terrain" : "osgTerrainLight unlit terrain");
    for (const char* file : {"terrain_shading.glsl", "terrain_heights.glsl"})
        program->addShader(hostShader(osg::Shader::VERTEX, file, version));
    program->addShader(hostShader(osg::Shader::VERTEX, "dynamic_terrain.vert", version + define));
    if (lit)
    {
        program->addShader(hostShader(osg::Shader::FRAGMENT, "terrain_shading.glsl", version));
        program->addShader(
            colourShader("default_terrain.frag", version + "\n#define HOLES" + define));
        if (glossy)
            addGloss(*program, version);
    }
    else
        program->addShader(hostShader(osg::Shader::FRAGMENT, "unlit_terrain.frag", version));
    return program;
}

/// The uniform of the sampler, which knows what has put it there. Copied by its class, or read from
/// a file, it is a plain one.
class ShadingBinding::Mark : public osg::Uniform
{
public:
    Mark(ShadingBinding* by, unsigned unit)
        : osg::Uniform(ShadingTexture::sampler, static_cast<int>(unit)), binding(by)
    {
    }
    ShadingBinding* binding; ///< null once it has been taken off

private:
    ~Mark() override = default;
};

ShadingBinding* ShadingBinding::on(const osg::StateSet* stateSet)
{
    const auto* mark =
        stateSet ? dynamic_cast<const Mark*>(stateSet->getUniform(ShadingTexture::sampler))
                 : nullptr;
    return mark ? mark->binding : nullptr;
}

ShadingBinding::ShadingBinding(osg::StateSet* stateSet, osg::Texture2D* shading, unsigned unit,
                               const ShadingCoordinates& coordinates, osg::Program* program)
    : _stateSet(stateSet), _program(program), _theirVariance(stateSet->getDataVariance())
{
    stateSet->setDataVariance(osg::Object::DYNAMIC);
    if (const auto* pair = stateSet->getAttributePair(osg::StateAttribute::PROGRAM))
        _theirProgram = *pair;

    install(_shading, shading, unit);
    _mark = new Mark(this, unit);
    add(_mark);
    add(new osg::Uniform(ShadingTexture::matrix,
                         osg::Matrixf(coordinates.toTile * texelCentres(*shading))));
    _hasEdges = new osg::Uniform(ShadingTexture::hasEdges, false);
    _posts = new osg::Uniform(ShadingTexture::posts, osg::Vec2f());
    add(_hasEdges);
    add(_posts);
    _formerPart = new osg::Uniform(ShadingTexture::formerPart, 0.0f);
    _formerMatrix = new osg::Uniform(ShadingTexture::formerMatrix, osg::Matrixf());
    _formerPosts = new osg::Uniform(ShadingTexture::formerPosts, osg::Vec2f());
    _hasBorders = new osg::Uniform(ShadingTexture::hasBorders, false);
    add(_formerPart);
    add(_formerMatrix);
    add(_formerPosts);
    add(_hasBorders);
    // Without a texture a sampler has the shading's unit: OpenGL forbids samplers of two types in
    // one.
    _edgeSampler = new osg::Uniform(ShadingTexture::edgeSampler, static_cast<int>(unit));
    _formerSampler = new osg::Uniform(ShadingTexture::formerSampler, static_cast<int>(unit));
    _formerEdgeSampler =
        new osg::Uniform(ShadingTexture::formerEdgeSampler, static_cast<int>(unit));
    add(_edgeSampler);
    add(_formerSampler);
    add(_formerEdgeSampler);
    _objectSampler = new osg::Uniform(ShadingTexture::objectsSampler, static_cast<int>(unit));
    _objectCount = new osg::Uniform(ShadingTexture::objectCount, 0);
    add(_objectSampler);
    add(_objectCount);
    if (!program)
        return;
    stateSet->setAttribute(program);
    const osg::Matrixd& f = coordinates.frame;
    add(new osg::Uniform(ShadingTexture::frame,
                         osg::Matrix3(static_cast<float>(f(0, 0)), static_cast<float>(f(0, 1)),
                                      static_cast<float>(f(0, 2)), static_cast<float>(f(1, 0)),
                                      static_cast<float>(f(1, 1)), static_cast<float>(f(1, 2)),
                                      static_cast<float>(f(2, 0)), static_cast<float>(f(2, 1)),
                                      static_cast<float>(f(2, 2)))));
    add(new osg::Uniform(fromVertexName, coordinates.source == ShadingCoordinates::Source::Vertex));
    add(new osg::Uniform(colourName, 0));
    _hasColour = new osg::Uniform(hasColourName, false);
    add(_hasColour);
}

void ShadingBinding::add(osg::Uniform* uniform)
{
    Slot slot{uniform->getName(), uniform, {}};
    if (const auto* pair = _stateSet->getUniformPair(uniform->getName()))
        slot.theirs = *pair;
    _uniforms.push_back(slot);
    _stateSet->addUniform(uniform);
}

template <class T>
void ShadingBinding::install(Bound<T>& bound, T* texture, unsigned unit)
{
    bound = {};
    bound.texture = texture;
    bound.unit = unit;
    bound.theirUnits = _stateSet->getTextureAttributeList().size();
    bound.theirModes = _stateSet->getTextureModeList();
    if (const auto* pair = _stateSet->getTextureAttributePair(unit, osg::StateAttribute::TEXTURE))
        bound.theirs = *pair;
    // No mode: fixed-function drawing must not see the texture.
    _stateSet->setTextureAttribute(unit, texture);
}

template <class T>
void ShadingBinding::remove(osg::StateSet& stateSet, const Bound<T>& bound)
{
    const unsigned unit = bound.unit;
    if (bound.texture &&
        stateSet.getTextureAttribute(unit, osg::StateAttribute::TEXTURE) == bound.texture)
    {
        stateSet.removeTextureAttribute(unit, osg::StateAttribute::TEXTURE);
        if (bound.theirs.first)
            stateSet.setTextureAttribute(unit, bound.theirs.first, bound.theirs.second);
        // Taking the texture off also took modes off its unit; and the lists have grown.
        auto& modes = stateSet.getTextureModeList();
        if (unit < modes.size())
            modes[unit] =
                unit < bound.theirModes.size() ? bound.theirModes[unit] : osg::StateSet::ModeList();
        while (modes.size() > bound.theirModes.size() && modes.back().empty())
            modes.pop_back();
        auto& attributes = stateSet.getTextureAttributeList();
        while (attributes.size() > bound.theirUnits && attributes.back().empty())
            attributes.pop_back();
    }
}

void ShadingBinding::setGloss(osg::Texture2DArray* light, unsigned unit)
{
    if (light == _gloss.texture)
        return;
    remove(*_stateSet, _gloss);
    _gloss = {};
    if (light)
        install(_gloss, light, unit);
}

void ShadingBinding::setEdges(osg::Texture2D* edges)
{
    if (edges == _edges.texture)
        return;
    remove(*_stateSet, _edges);
    _edges = {};
    if (edges)
    {
        install(_edges, edges, ShadingTexture::edgeUnit);
        _posts->set(texelsOf(*edges));
    }
    _edgeSampler->set(static_cast<int>(edges ? ShadingTexture::edgeUnit : unit()));
    _hasEdges->set(edges != nullptr);
}

void ShadingBinding::setObjects(osg::Texture2D* factor, const TileObjects& objects)
{
    if (factor != _objects.texture)
    {
        remove(*_stateSet, _objects);
        _objects = {};
        if (factor)
            install(_objects, factor, ShadingTexture::objectsUnit);
        _objectSampler->set(static_cast<int>(factor ? ShadingTexture::objectsUnit : unit()));
    }
    const std::size_t count = factor ? std::min(objects.size(), mostObjects) : 0;
    if (count > 0 && !_objectPlaces)
    {
        const auto array = [this](const char* name)
        {
            const osg::ref_ptr<osg::Uniform> uniform =
                new osg::Uniform(osg::Uniform::FLOAT_VEC4, name, int(mostObjects));
            add(uniform);
            return uniform;
        };
        _objectPlaces = array(ShadingTexture::objectPlaces);
        _objectCorners = array(ShadingTexture::objectCorners);
    }
    for (std::size_t i = 0; i < count; ++i)
    {
        // Texel of a shading coordinate c: (c * posts - 0.5) * spacing is its place in metres.
        const TileObject& object = objects[i];
        const glm::dvec2 texels(factor->getTextureWidth(), factor->getTextureHeight());
        const glm::dvec2 posts(_shading.texture->getTextureWidth(),
                               _shading.texture->getTextureHeight());
        const glm::dvec2& spacing = object.spacing;
        const glm::dvec2 perMetre = 1.0 / (object.pitch * texels);
        const glm::dvec2 middle = (glm::dvec2(0.0, object.row) + 0.5) / texels; // of the first
        const glm::dvec2 scale = posts * spacing * perMetre;
        const glm::dvec2 offset = (-0.5 * spacing - object.first) * perMetre + middle;
        // Beyond the outermost centres, which are 1, nothing is read.
        const glm::dvec2 last = middle + (glm::dvec2(object.texels) - 1.0) / texels;
        const auto vector = [](const glm::dvec2& xy, const glm::dvec2& zw)
        {
            return osg::Vec4f(static_cast<float>(xy.x), static_cast<float>(xy.y),
                              static_cast<float>(zw.x), static_cast<float>(zw.y));
        };
        _objectPlaces->setElement(static_cast<unsigned>(i), vector(scale, offset));
        _objectCorners->setElement(static_cast<unsigned>(i), vector(middle, last));
    }
    _objectCount->set(static_cast<int>(count));
}

void ShadingBinding::setFormer(const FormerLight& light, const osg::Matrixd& toFormer,
                               const osg::Matrixd& toShading)
{
    removeFormer();
    _toShading = toShading;
    install(_former, borrowed(light.shading).get(), ShadingTexture::formerUnit);
    _formerSampler->set(static_cast<int>(ShadingTexture::formerUnit));
    if (light.edges)
    {
        install(_formerEdges, borrowed(light.edges).get(), ShadingTexture::formerEdgeUnit);
        _formerEdgeSampler->set(static_cast<int>(ShadingTexture::formerEdgeUnit));
        _formerPosts->set(texelsOf(*light.edges));
    }
    _formerMatrix->set(osg::Matrixf(toFormer));
    _formerPart->set(1.0f);
}

void ShadingBinding::setFade(double own, const BorderParts& borders)
{
    if (own >= 1.0 && !borders.any())
        return removeFormer();
    _formerPart->set(1.0f - static_cast<float>(own));
    setBorders(borders);
}

void ShadingBinding::setBorders(const BorderParts& borders)
{
    _hasBorders->set(borders.any());
    if (!borders.any())
        return;
    if (!_borders)
    {
        _borders = new osg::Uniform(ShadingTexture::borders, osg::Vec4f());
        _corners = new osg::Uniform(ShadingTexture::borderCorners, osg::Vec4f());
        _drawn = new osg::Uniform(ShadingTexture::drawn, osg::Vec4f());
        _bands = new osg::Uniform(ShadingTexture::bands, osg::Vec2f());
        for (osg::Uniform* uniform : {_borders.get(), _corners.get(), _drawn.get(), _bands.get()})
            add(uniform);
    }
    const auto vector = [](const std::array<float, 4>& parts)
    { return osg::Vec4f(parts[0], parts[1], parts[2], parts[3]); };
    _borders->set(vector(borders.sides));
    _corners->set(vector(borders.corners));
    const osg::Vec3d first = osg::Vec3d(0.0, 0.0, 0.0) * _toShading;
    const osg::Vec3d last = osg::Vec3d(1.0, 1.0, 0.0) * _toShading;
    _drawn->set(osg::Vec4f(osg::Vec4d(first.x(), first.y(), last.x(), last.y())));
    constexpr float band = 8.0f; // [posts]
    _bands->set(texelsOf(*_shading.texture) / band);
}

void ShadingBinding::removeFormer()
{
    remove(*_stateSet, _formerEdges);
    remove(*_stateSet, _former);
    _former = {};
    _formerEdges = {};
    _formerSampler->set(static_cast<int>(unit()));
    _formerEdgeSampler->set(static_cast<int>(unit()));
    _formerPosts->set(osg::Vec2f());
    _formerPart->set(0.0f);
    _hasBorders->set(false);
}

void ShadingBinding::setHasColour(bool hasColour)
{
    bool current = hasColour;
    if (_hasColour && _hasColour->get(current) && current != hasColour)
        _hasColour->set(hasColour);
}

ShadingBinding::~ShadingBinding()
{
    takeOff();
}

void ShadingBinding::takeOff()
{
    if (_mark->binding)
        removeAll(*_stateSet);
    _mark->binding = nullptr;
}

osg::ref_ptr<osg::StateSet> ShadingBinding::without(const osg::StateSet& bound) const
{
    osg::ref_ptr<osg::StateSet> copy = new osg::StateSet(bound);
    removeAll(*copy);
    return copy;
}

void ShadingBinding::removeAll(osg::StateSet& stateSet) const
{
    stateSet.setDataVariance(_theirVariance);
    for (const Slot& slot : _uniforms)
    {
        if (stateSet.getUniform(slot.name) != slot.ours)
            continue; // the host has put its own there
        stateSet.removeUniform(slot.name);
        if (slot.theirs.first)
            stateSet.addUniform(slot.theirs.first, slot.theirs.second);
    }
    if (_program && stateSet.getAttribute(osg::StateAttribute::PROGRAM) == _program)
    {
        stateSet.removeAttribute(osg::StateAttribute::PROGRAM);
        if (_theirProgram.first)
            stateSet.setAttribute(_theirProgram.first, _theirProgram.second);
    }
    remove(stateSet, _objects);
    remove(stateSet, _formerEdges); // in the reverse order: each restores the lists that it found
    remove(stateSet, _former);
    remove(stateSet, _edges);
    remove(stateSet, _gloss);
    remove(stateSet, _shading);
}

} // namespace osgTerrainLight
