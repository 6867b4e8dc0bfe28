#include "osgdb/Register.h"

#include "core/EnumNames.h"
#include "core/SettingsTable.h"
#include "osgdb/FormerScene.h"
#include "osgdb/LostLight.h"
#include "scene/TileUnits.h"
#include <osgTerrainLight/Environment.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/SunPosition.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Notify>
#include <osgDB/InputStream>
#include <osgDB/ObjectWrapper>
#include <osgDB/OutputStream>

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace osgTerrainLight
{

namespace
{
/// What is read of a node, before it is set: rows of the table are set together.
struct SavedNode
{
    SkyLight sky;
    LightingSettings settings;
    std::optional<EarthPlace> place;
    std::optional<UtcTime> time;
    bool lightEnabled = true, defaultProgram = true;
    double timeBudget = 50.0;
    double fadeSeconds = 0.5;
    int textureUnit = static_cast<int>(ShadingTexture::defaultUnit);
    int glossUnit = static_cast<int>(ShadingTexture::glossUnit);
    int glossLayer = -1;
};

SavedNode savedNode(const TerrainLighting& node)
{
    SavedNode saved;
    saved.sky = node.getSkyLight();
    saved.settings = node.getSettings();
    saved.place = node.getPlace();
    saved.time = node.getTime();
    saved.lightEnabled = node.getLightEnabled();
    saved.defaultProgram = node.getDefaultProgramEnabled();
    saved.timeBudget = node.getTimeBudget();
    saved.fadeSeconds = node.getFadeSeconds();
    saved.textureUnit = static_cast<int>(node.getTextureUnit());
    saved.glossUnit = static_cast<int>(node.getGlossUnit());
    saved.glossLayer = node.getGlossLayer();
    return saved;
}

void restore(TerrainLighting& node, const SavedNode& saved)
{
    node.setTextureUnit(static_cast<unsigned>(saved.textureUnit));
    node.setGlossUnit(static_cast<unsigned>(saved.glossUnit));
    node.setSkyLight(saved.sky);
    node.setSettings(saved.settings);
    if (saved.place)
        node.setPlace(*saved.place);
    if (saved.time)
        node.setTime(*saved.time);
    node.setLightEnabled(saved.lightEnabled);
    node.setTimeBudget(saved.timeBudget);
    node.setFadeSeconds(saved.fadeSeconds);
    node.setDefaultProgramEnabled(saved.defaultProgram);
    node.setGlossLayer(saved.glossLayer);
}

/// A property of the node in a file: its name, and its value as text. A file that lacks it leaves
/// the default; a file may have more than are known here.
struct Property
{
    std::string name;
    std::function<std::string(const SavedNode&)> text;
    /// Empty where the text was read; else what is wrong, and nothing has changed.
    std::function<std::string(SavedNode&, const std::string&)> read;
};

template <class Owner>
void addRows(std::vector<Property>& properties, Owner SavedNode::*part)
{
    for (const Setting<Owner>& setting : settingsOf<Owner>())
        properties.push_back(
            {setting.name,
             [&setting, part](const SavedNode& saved) { return setting.textOf(saved.*part); },
             [&setting, part](SavedNode& saved, const std::string& text) -> std::string
             {
                 const Result<SettingValue> value = setting.read(text, setting.name);
                 if (!value)
                     return value.error().message;
                 setting.set(saved.*part, *value);
                 return {};
             }});
}

Property switchOf(const char* name, bool SavedNode::*member)
{
    return {name, [member](const SavedNode& saved) { return std::string(nameOf(saved.*member)); },
            [name, member](SavedNode& saved, const std::string& text)
            {
                return readName(text, saved.*member) ? std::string()
                                                     : refused(name, text, "on or off").message;
            }};
}

template <class Number>
Property numberOf(const char* name, Number SavedNode::*member, const ValueForm& form)
{
    SettingRow row;
    row.name = name;
    row.form = form;
    return {name,
            [member](const SavedNode& saved)
            { return numberText(static_cast<double>(saved.*member)); },
            [row, member](SavedNode& saved, const std::string& text)
            {
                const Result<SettingValue> value = row.read(text, row.name);
                if (!value)
                    return value.error().message;
                saved.*member = static_cast<Number>(std::get<std::vector<double>>(*value).front());
                return std::string();
            }};
}

Property environmentOf()
{
    return {"sky-file",
            [](const SavedNode& saved)
            { return saved.sky.environment ? saved.sky.environment->name : std::string(); },
            [](SavedNode& saved, const std::string& file)
            {
                // The sun is the one that was saved, found in the file or not.
                std::string problem;
                if (!file.empty() && !(saved.sky.environment = readEnvironment(file, problem)))
                    return "left out the sky: " + problem;
                return std::string();
            }};
}

Property placeOf()
{
    return {"place",
            [](const SavedNode& saved)
            {
                return saved.place ? numberText(saved.place->longitude) + "," +
                                         numberText(saved.place->latitude) + "," +
                                         numberText(saved.place->convergence)
                                   : std::string();
            },
            [](SavedNode& saved, const std::string& text)
            {
                if (text.empty())
                    return std::string();
                const std::vector<double> numbers = numbersIn(text);
                if (numbers.size() != 3)
                    return refused("place", text, "longitude,latitude,convergence").message;
                saved.place = EarthPlace{numbers[0], numbers[1], numbers[2]};
                return std::string();
            }};
}

Property timeOf()
{
    return {"time",
            [](const SavedNode& saved)
            { return saved.time ? toString(*saved.time) : std::string(); },
            [](SavedNode& saved, const std::string& text)
            {
                UtcTime time;
                const std::string problem = text.empty() ? "" : readUtcTime(text, time);
                if (problem.empty() && !text.empty())
                    saved.time = time;
                return problem.empty() ? problem : "time = " + problem;
            }};
}

const std::vector<Property>& properties()
{
    static const std::vector<Property> all = []
    {
        std::vector<Property> list;
        addRows(list, &SavedNode::settings);
        addRows(list, &SavedNode::sky);
        const auto whole = [](double minimum, double maximum)
        { return ValueForm{ValueForm::Kind::Whole, minimum, maximum, "", 1, false, {}}; };
        const ValueForm milliseconds = {ValueForm::Kind::Real, 0.0, 1e9, "ms", 1, false, {}};
        const ValueForm seconds = {ValueForm::Kind::Real, 0.0, 3600.0, "s", 1, false, {}};
        for (const Property& property :
             {environmentOf(), placeOf(), timeOf(),
              switchOf("light-enabled", &SavedNode::lightEnabled),
              switchOf("default-program", &SavedNode::defaultProgram),
              numberOf("time-budget", &SavedNode::timeBudget, milliseconds),
              numberOf("fade-seconds", &SavedNode::fadeSeconds, seconds),
              numberOf("texture-unit", &SavedNode::textureUnit, whole(0, TileUnits::last)),
              numberOf("gloss-unit", &SavedNode::glossUnit, whole(0, TileUnits::last)),
              numberOf("gloss-layer", &SavedNode::glossLayer, whole(-1, 4))})
            list.push_back(property);
        return list;
    }();
    return all;
}

void readProperty(SavedNode& saved, const std::string& name, const std::string& text)
{
    for (const Property& property : properties())
        if (property.name == name)
        {
            if (const std::string problem = property.read(saved, text); !problem.empty())
                OSG_WARN << "osgTerrainLight: read from file: " << problem << std::endl;
            return;
        }
    OSG_NOTICE << "osgTerrainLight: read from file: skipped " << name << " = \"" << text
               << "\", which a later version may know" << std::endl;
}

/// The node's properties as pairs of name and text, so that text, XML and binary files alike can
/// be read by versions with fewer or more of them. osgDB's own serializers are found by name in
/// text only; in a binary file each must be where it was written.
class LightingSerializer : public osgDB::BaseSerializer
{
public:
    LightingSerializer() : osgDB::BaseSerializer(READ_WRITE_PROPERTY) {}

    const std::string& getName() const override { return _name; }

    bool read(osgDB::InputStream& is, osg::Object& object) override
    {
        TerrainLighting& node = dynamic_cast<TerrainLighting&>(object);
        bool isFormer = false; // the mark of what was the first field
        if (is.isBinary())
            is >> isFormer;
        else
            isFormer = !is.matchString(_name);
        if (isFormer)
        {
            readFormerScene(is, node);
            return true;
        }
        unsigned count = 0;
        is >> count >> is.BEGIN_BRACKET;
        if (count > mostProperties)
            is.throwException("osgTerrainLight: " + std::to_string(count) +
                              " properties; needs at most " + std::to_string(mostProperties));
        SavedNode saved;
        for (unsigned i = 0; i < count && !is.getException(); ++i)
        {
            std::string name, text;
            is.readWrappedString(name);
            is.readWrappedString(text);
            if (!is.getException())
                readProperty(saved, name, text);
        }
        is >> is.END_BRACKET;
        restore(node, saved);
        return true;
    }

    bool write(osgDB::OutputStream& os, const osg::Object& object) override
    {
        const TerrainLighting& node = dynamic_cast<const TerrainLighting&>(object);
        const SavedNode saved = savedNode(node);
        if (saved.sky.environment && saved.sky.environment->name.empty())
            OSG_WARN << "osgTerrainLight: a sky that is of no file is not saved" << std::endl;
        if (os.isBinary())
            os << false;
        else
            os << os.PROPERTY(_name.c_str());
        os << static_cast<unsigned>(properties().size()) << os.BEGIN_BRACKET << std::endl;
        for (const Property& property : properties())
        {
            os.writeWrappedString(property.name);
            os.writeWrappedString(property.text(saved));
            os << std::endl;
        }
        os << os.END_BRACKET << std::endl;
        return true;
    }

private:
    static constexpr unsigned mostProperties = 4096;
    const std::string _name = "Lighting";
};

osg::Object* createLighting()
{
    return new TerrainLighting;
}

void addLightingProperties(osgDB::ObjectWrapper* wrapper)
{
    wrapper->addSerializer(new LightingSerializer, osgDB::BaseSerializer::RW_USER);
}

osg::Object* createHandler()
{
    return new LightingHandler;
}

void addHandlerProperties(osgDB::ObjectWrapper*) {}

osg::Object* createObject()
{
    return new PlacedObject;
}

bool hasAlbedo(const PlacedObject& object)
{
    return object.getAlbedo().has_value();
}

bool readAlbedo(osgDB::InputStream& stream, PlacedObject& object)
{
    osg::Vec3f albedo;
    stream >> albedo;
    object.setAlbedo(albedo);
    return true;
}

bool writeAlbedo(osgDB::OutputStream& stream, const PlacedObject& object)
{
    stream << *object.getAlbedo() << std::endl;
    return true;
}

void addObjectProperties(osgDB::ObjectWrapper* wrapper)
{
    using Field = PlacedObject::Field;
    osg::ref_ptr<osgDB::EnumSerializer<PlacedObject, Field, void>> field =
        new osgDB::EnumSerializer<PlacedObject, Field, void>(
            "Field", Field::Automatic, &PlacedObject::getField, &PlacedObject::setField);
    field->add("AUTOMATIC", Field::Automatic);
    field->add("BOX", Field::Box);
    field->add("ELLIPSOID", Field::Ellipsoid);
    field->add("CYLINDER", Field::Cylinder);
    field->add("MESH", Field::Mesh);
    field->add("NONE", Field::None);
    field->add("STAR", Field::Star);
    field->add("HEIGHT_FIELD", Field::HeightField);
    field->add("TWO_HEIGHT_FIELDS", Field::TwoHeightFields);
    wrapper->addSerializer(field, osgDB::BaseSerializer::RW_ENUM);
    wrapper->addSerializer(
        new osgDB::PropByRefSerializer<PlacedObject, osg::Vec3f>(
            "Emission", osg::Vec3f(), &PlacedObject::getEmission, &PlacedObject::setEmission),
        osgDB::BaseSerializer::RW_VEC3F);
    wrapper->addSerializer(
        new osgDB::UserSerializer<PlacedObject>("Albedo", &hasAlbedo, &readAlbedo, &writeAlbedo),
        osgDB::BaseSerializer::RW_USER);
}
} // namespace

void registerSerializers()
{
    // REGISTER_OBJECT_WRAPPER would do it when the library is loaded, in applications that only
    // link it too.
    static const osgDB::RegisterWrapperProxy lighting(
        createLighting, "osgTerrainLight::TerrainLighting",
        "osg::Object osg::Node osg::Group osgTerrainLight::TerrainLighting", addLightingProperties);
    static const osgDB::RegisterWrapperProxy handler(
        createHandler, "osgTerrainLight::LightingHandler",
        "osg::Object osg::Callback osg::NodeCallback osgTerrainLight::LightingHandler",
        addHandlerProperties);
    static const osgDB::RegisterWrapperProxy object(
        createObject, "osgTerrainLight::PlacedObject",
        "osg::Object osg::Node osg::Group osgTerrainLight::PlacedObject", addObjectProperties);
    warnOfLostLight();
}

} // namespace osgTerrainLight
