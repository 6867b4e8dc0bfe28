// A village on a hill, all of it made up: houses with gabled roofs and eaves, trees, and a car that
// drives around, and a blob that deforms. Its ground, walls and roofs are lit as placed objects.
// objects [--headless FILE.png] [--hour H]
#include <osgTerrainLight/HeadlessContext.h>
#include <osgTerrainLight/LightingHandler.h>
#include <osgTerrainLight/PlacedObject.h>
#include <osgTerrainLight/TerrainLighting.h>

#include <osg/Geode>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgDB/WriteFile>
#include <osgTerrain/Terrain>
#include <osgTerrain/TerrainTile>
#include <osgUtil/SmoothingVisitor>
#include <osgViewer/Viewer>
#include <osgViewer/ViewerEventHandlers>

#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace osgTerrainLight;

namespace
{

constexpr int posts = 129;
constexpr double spacing = 4.0; ///< [m]
constexpr double half = 0.5 * spacing * (posts - 1);

/// Of the ground [m], at a place east and north of the middle [m].
double groundAt(double east, double north)
{
    const auto hill = [&](double x, double y, double height, double width)
    {
        const double dx = (east - x) / width, dy = (north - y) / width;
        return height * std::exp(-dx * dx - dy * dy);
    };
    return hill(-20.0, 190.0, 90.0, 90.0) + hill(190.0, 60.0, 60.0, 80.0) +
           hill(-200.0, -30.0, 45.0, 90.0) + 0.03 * north + 1.2 * std::sin(east * 0.04);
}

osg::ref_ptr<osg::Node> createGround()
{
    const osg::ref_ptr<osg::HeightField> heights = new osg::HeightField;
    heights->allocate(posts, posts);
    for (unsigned row = 0; row < unsigned(posts); ++row)
        for (unsigned column = 0; column < unsigned(posts); ++column)
            heights->setHeight(column, row,
                               float(groundAt(column * spacing - half, row * spacing - half)));
    const osg::ref_ptr<osgTerrain::Locator> place = new osgTerrain::Locator;
    place->setCoordinateSystemType(osgTerrain::Locator::PROJECTED);
    place->setTransformAsExtents(-half, -half, half, half);
    const osg::ref_ptr<osgTerrain::HeightFieldLayer> layer =
        new osgTerrain::HeightFieldLayer(heights);
    layer->setLocator(place);

    const osg::ref_ptr<osg::Image> meadow = new osg::Image;
    meadow->allocateImage(1, 1, 1, GL_RGB, GL_UNSIGNED_BYTE);
    const unsigned char green[] = {128, 150, 92};
    std::copy(std::begin(green), std::end(green), meadow->data());
    const osg::ref_ptr<osgTerrain::ImageLayer> colour = new osgTerrain::ImageLayer(meadow);
    colour->setLocator(place);

    const osg::ref_ptr<osgTerrain::TerrainTile> tile = new osgTerrain::TerrainTile;
    tile->setTileID(osgTerrain::TileID(0, 0, 0));
    tile->setLocator(place);
    tile->setElevationLayer(layer);
    tile->setColorLayer(0, colour);
    const osg::ref_ptr<osgTerrain::Terrain> terrain = new osgTerrain::Terrain;
    terrain->addChild(tile);
    return terrain;
}

/// A mesh of faces in one colour each, with an edge between any two.
class Mesh
{
public:
    void face(const std::vector<osg::Vec3>& corners, const osg::Vec4& colour)
    {
        osg::Vec3 normal = (corners[1] - corners[0]) ^ (corners[2] - corners[0]);
        normal.normalize();
        for (std::size_t i = 2; i < corners.size(); ++i)
            for (const osg::Vec3& corner : {corners[0], corners[i - 1], corners[i]})
            {
                _vertices->push_back(corner);
                _normals->push_back(normal);
                _colours->push_back(colour);
            }
    }
    /// Between two polygons of as many corners, counter-clockwise as seen from the first one's
    /// front.
    void solid(const std::vector<osg::Vec3>& front, const std::vector<osg::Vec3>& back,
               const osg::Vec4& colour)
    {
        face(front, colour);
        face({back.rbegin(), back.rend()}, colour);
        for (std::size_t i = 0; i < front.size(); ++i)
        {
            const std::size_t next = (i + 1) % front.size();
            face({front[i], back[i], back[next], front[next]}, colour);
        }
    }
    void box(const osg::Vec3& low, const osg::Vec3& high, const osg::Vec4& colour)
    {
        const auto side = [&](float y)
        {
            return std::vector<osg::Vec3>{{low.x(), y, low.z()},
                                          {high.x(), y, low.z()},
                                          {high.x(), y, high.z()},
                                          {low.x(), y, high.z()}};
        };
        solid(side(low.y()), side(high.y()), colour);
    }
    osg::ref_ptr<osg::Geode> geode() const
    {
        const osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
        geometry->setUseVertexBufferObjects(true);
        geometry->setVertexArray(_vertices);
        geometry->setNormalArray(_normals, osg::Array::BIND_PER_VERTEX);
        geometry->setColorArray(_colours, osg::Array::BIND_PER_VERTEX);
        geometry->addPrimitiveSet(
            new osg::DrawArrays(GL_TRIANGLES, 0, static_cast<int>(_vertices->size())));
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(geometry);
        return geode;
    }

private:
    osg::ref_ptr<osg::Vec3Array> _vertices = new osg::Vec3Array, _normals = new osg::Vec3Array;
    osg::ref_ptr<osg::Vec4Array> _colours = new osg::Vec4Array;
};

osg::ref_ptr<PlacedObject> house(float length, float width, float eaves, const osg::Vec4& wall)
{
    const osg::Vec4 roof(0.55f, 0.25f, 0.18f, 1.0f), wood(0.3f, 0.2f, 0.14f, 1.0f);
    const float l = 0.5f * length, w = 0.5f * width, rise = 0.7f * w, cellar = -2.0f;
    const auto gable = [&](float x)
    {
        return std::vector<osg::Vec3>{{x, -w, cellar},
                                      {x, w, cellar},
                                      {x, w, eaves},
                                      {x, 0.0f, eaves + rise},
                                      {x, -w, eaves}};
    };
    Mesh mesh;
    mesh.solid(gable(l), gable(-l), wall);
    // Two slabs of 0.3 m that reach 0.7 m beyond the walls.
    const float over = 0.7f, out = w + over, drop = over * rise / w, thick = 0.3f;
    for (const float side : {-1.0f, 1.0f})
    {
        const auto slab = [&](float x)
        {
            std::vector<osg::Vec3> corners = {{x, side * out, eaves - drop},
                                              {x, 0.0f, eaves + rise},
                                              {x, 0.0f, eaves + rise + thick},
                                              {x, side * out, eaves - drop + thick}};
            if (side > 0.0f)
                std::swap(corners[1], corners[3]);
            return corners;
        };
        mesh.solid(slab(l + over), slab(-l - over), roof);
    }
    mesh.box({-0.5f, -w - 0.05f, 0.0f}, {0.5f, -w, 2.1f}, wood); // the door
    mesh.box({0.5f * l, 0.3f, eaves}, {0.5f * l + 0.8f, 1.1f, eaves + rise + 1.0f}, wall);
    const osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->setName("house");
    object->addChild(mesh.geode());
    return object;
}

osg::ref_ptr<PlacedObject> tree(float height, float radius)
{
    const auto drawn = [](osg::Shape* shape, const osg::Vec4& colour)
    {
        const osg::ref_ptr<osg::ShapeDrawable> drawable = new osg::ShapeDrawable(shape);
        drawable->setColor(colour);
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(drawable);
        return geode;
    };
    const osg::ref_ptr<osg::MatrixTransform> crown =
        new osg::MatrixTransform(osg::Matrix::scale(1.0, 1.0, double(0.4f * height / radius)) *
                                 osg::Matrix::translate(0.0, 0.0, double(0.58f * height)));
    crown->addChild(drawn(new osg::Sphere(osg::Vec3(), radius), {0.24f, 0.38f, 0.16f, 1.0f}));
    crown->getOrCreateStateSet()->setMode(GL_NORMALIZE, osg::StateAttribute::ON);
    const osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->setName("tree");
    object->addChild(crown);
    object->addChild(drawn(
        new osg::Cylinder(osg::Vec3(0.0f, 0.0f, 0.1f * height), 0.12f * radius, 0.4f * height),
        {0.35f, 0.26f, 0.18f, 1.0f}));
    return object;
}

osg::ref_ptr<PlacedObject> car()
{
    Mesh mesh;
    mesh.box({-2.1f, -0.9f, 0.3f}, {2.1f, 0.9f, 1.0f}, {0.75f, 0.12f, 0.1f, 1.0f});
    mesh.box({-1.3f, -0.8f, 1.0f}, {1.0f, 0.8f, 1.55f}, {0.2f, 0.22f, 0.25f, 1.0f});
    for (const float x : {-1.6f, 0.9f})
        mesh.box({x, -0.92f, 0.0f}, {x + 0.7f, 0.92f, 0.5f}, {0.08f, 0.08f, 0.08f, 1.0f});
    const osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->setName("car");
    object->setField(PlacedObject::Field::Box);
    object->addChild(mesh.geode());
    return object;
}

/// Along a circle around the village, 12 m/s.
class Drive : public osg::NodeCallback
{
public:
    static osg::Matrixd at(double time)
    {
        constexpr double radius = 24.0;
        const double angle = 12.0 / radius * time - 1.9;
        const double east = radius * std::cos(angle), north = radius * std::sin(angle);
        return osg::Matrixd::rotate(angle + 0.5 * osg::PI, osg::Z_AXIS) *
               osg::Matrixd::translate(east, north, groundAt(east, north) + 0.1);
    }
    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override
    {
        if (const osg::FrameStamp* stamp = visitor->getFrameStamp())
            static_cast<osg::MatrixTransform*>(node)->setMatrix(at(stamp->getSimulationTime()));
        traverse(node, visitor);
    }
};

/// A blob on the green, whose vertices it moves in every frame. The library finds its form by
/// itself: PlacedObject::Field::Star.
class Blob : public osg::NodeCallback
{
public:
    Blob()
    {
        const osg::ref_ptr<osg::DrawElementsUInt> triangles =
            new osg::DrawElementsUInt(GL_TRIANGLES);
        const auto at = [](int row, int column)
        { return static_cast<GLuint>(row * (columns + 1) + column); };
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column)
                for (const GLuint corner :
                     {at(row, column), at(row, column + 1), at(row + 1, column + 1),
                      at(row, column), at(row + 1, column + 1), at(row + 1, column)})
                    triangles->push_back(corner);
        const osg::ref_ptr<osg::Vec4Array> colour = new osg::Vec4Array;
        colour->push_back({0.35f, 0.62f, 0.72f, 1.0f});
        _geometry->setDataVariance(osg::Object::DYNAMIC);
        _geometry->setUseVertexBufferObjects(true);
        _geometry->setVertexArray(_vertices);
        _geometry->setNormalArray(_normals, osg::Array::BIND_PER_VERTEX);
        _geometry->setColorArray(colour, osg::Array::BIND_OVERALL);
        _geometry->addPrimitiveSet(triangles);
        deform(0.0);
    }
    osg::ref_ptr<PlacedObject> object()
    {
        const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
        geode->addDrawable(_geometry);
        const osg::ref_ptr<PlacedObject> object = new PlacedObject;
        object->setName("blob");
        object->setField(PlacedObject::Field::Star);
        object->addChild(geode);
        geode->setUpdateCallback(this);
        return object;
    }
    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override
    {
        if (const osg::FrameStamp* stamp = visitor->getFrameStamp())
            deform(stamp->getSimulationTime());
        traverse(node, visitor);
    }

private:
    static osg::Vec3d surface(double polar, double turn, double time)
    {
        const osg::Vec3d direction(std::sin(polar) * std::cos(turn),
                                   std::sin(polar) * std::sin(turn), -std::cos(polar));
        const double wave = std::sin(4.0 * direction.x() + 1.7 * time) +
                            std::sin(5.0 * direction.y() - 1.1 * time) +
                            std::sin(4.0 * direction.z() + 0.8 * time + direction.x());
        return direction * (1.9 + 0.28 * wave) + osg::Vec3d(0.0, 0.0, 2.1);
    }
    void deform(double time)
    {
        _vertices->clear();
        _normals->clear();
        constexpr double step = 1.0e-3;
        for (int row = 0; row <= rows; ++row)
            for (int column = 0; column <= columns; ++column)
            {
                // Off the poles, where the normal of both angles is none.
                const double polar = std::min(std::max(osg::PI * row / rows, step), osg::PI - step);
                const double turn = 2.0 * osg::PI * column / columns;
                const osg::Vec3d place = surface(polar, turn, time);
                osg::Vec3d normal = (surface(polar, turn + step, time) - place) ^
                                    (surface(polar + 0.5 * step, turn, time) - place);
                normal.normalize();
                _vertices->push_back(place);
                _normals->push_back(normal);
            }
        _vertices->dirty();
        _normals->dirty();
        _geometry->dirtyBound();
    }

    static constexpr int rows = 32, columns = 48;
    osg::ref_ptr<osg::Geometry> _geometry = new osg::Geometry;
    osg::ref_ptr<osg::Vec3Array> _vertices = new osg::Vec3Array, _normals = new osg::Vec3Array;
};

using Objects = std::vector<osg::ref_ptr<PlacedObject>>;

osg::ref_ptr<osg::MatrixTransform> placed(PlacedObject& object, double east, double north,
                                          double turn)
{
    const osg::ref_ptr<osg::MatrixTransform> place =
        new osg::MatrixTransform(osg::Matrixd::rotate(turn, osg::Z_AXIS) *
                                 osg::Matrixd::translate(east, north, groundAt(east, north)));
    place->addChild(&object);
    return place;
}

osg::ref_ptr<PlacedObject> solid(osg::Shape* shape, const osg::Vec4& colour)
{
    const osg::ref_ptr<osg::ShapeDrawable> drawn = new osg::ShapeDrawable(shape);
    drawn->setColor(colour);
    const osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    geode->addDrawable(drawn);
    const osg::ref_ptr<PlacedObject> object = new PlacedObject;
    object->addChild(geode);
    return object;
}

/// lamps: whether they are lit.
Objects addVillage(osg::Group& scene, bool lamps)
{
    struct Place
    {
        double east, north, turn;
        float length, width, eaves;
        osg::Vec4 colour;
    };
    const osg::Vec4 white(0.9f, 0.88f, 0.84f, 1.0f), ochre(0.85f, 0.68f, 0.42f, 1.0f),
        rose(0.8f, 0.55f, 0.48f, 1.0f);
    const Place places[] = {
        {-12.0, -7.0, 0.1, 10.0f, 7.0f, 3.2f, white}, {2.0, -9.0, 0.0, 9.0f, 6.5f, 3.0f, ochre},
        {14.0, -4.0, 1.3, 9.0f, 7.0f, 3.4f, white},   {-13.0, 6.0, 1.4, 9.0f, 6.0f, 3.0f, rose},
        {-1.0, 4.0, 0.2, 11.0f, 7.5f, 4.6f, white},   {11.0, 9.0, -0.3, 8.0f, 6.0f, 2.8f, ochre}};
    Objects objects;
    const auto add =
        [&](const osg::ref_ptr<PlacedObject>& object, double east, double north, double turn)
    {
        objects.push_back(object);
        scene.addChild(placed(*object, east, north, turn));
    };
    for (const Place& each : places)
        add(house(each.length, each.width, each.eaves, each.colour), each.east, each.north,
            each.turn);
    const double trees[][3] = {{-5.5, -14.0, 7.0}, {9.0, -14.0, 5.5},  {-19.0, 0.0, 8.0},
                               {7.0, 2.5, 6.0},    {20.0, 4.0, 7.5},   {-6.0, 13.0, 6.5},
                               {3.5, 14.0, 8.5},   {-17.0, -14.0, 6.0}};
    for (const auto& each : trees)
        add(tree(float(each[2]), 0.3f * float(each[2])), each[0], each[1], 0.0);
    add((new Blob)->object(), 3.0, -18.0, 0.0);
    const double lampPosts[][2] = {{8.5, -8.0}, {-5.5, -3.0}, {-9.0, -16.0}};
    for (const auto& each : lampPosts)
    {
        add(solid(new osg::Cylinder(osg::Vec3(0.0f, 0.0f, 1.5f), 0.12f, 3.4f),
                  osg::Vec4(0.2f, 0.2f, 0.2f, 1.0f)),
            each[0], each[1], 0.0);
        const osg::ref_ptr<PlacedObject> lamp =
            solid(new osg::Sphere(osg::Vec3(0.0f, 0.0f, 3.5f), 0.3f), osg::Vec4(1, 1, 1, 1));
        if (lamps)
            lamp->setEmission(osg::Vec3f(12.0f, 8.0f, 3.5f));
        add(lamp, each[0], each[1], 0.0);
    }
    const osg::ref_ptr<PlacedObject> driven = car();
    objects.push_back(driven);
    const osg::ref_ptr<osg::MatrixTransform> way = new osg::MatrixTransform(Drive::at(0.0));
    way->setUpdateCallback(new Drive);
    way->addChild(driven);
    scene.addChild(way);
    return objects;
}

/// A day in June at 47 degrees north, with noon in the south.
SkyLight lightAt(double hour)
{
    const double latitude = osg::DegreesToRadians(47.0), tilt = osg::DegreesToRadians(23.4);
    const double angle = (hour - 12.0) * osg::PI / 12.0;
    const double up =
        std::sin(latitude) * std::sin(tilt) + std::cos(latitude) * std::cos(tilt) * std::cos(angle);
    const double west = std::cos(tilt) * std::sin(angle);
    const double north =
        std::cos(latitude) * std::sin(tilt) - std::sin(latitude) * std::cos(tilt) * std::cos(angle);
    SkyLight sky;
    sky.skyModel = SkyModel::Clear;
    sky.sunElevation = osg::RadiansToDegrees(std::asin(up));
    sky.sunAzimuth = osg::RadiansToDegrees(std::atan2(-west, north));
    return sky;
}

int drawPicture(osgViewer::Viewer& viewer, TerrainLighting& lit, const Objects& objects,
                const std::string& file)
{
    constexpr int width = 1280, height = 720;
    std::string problem;
    const std::unique_ptr<HeadlessContext> context =
        HeadlessContext::create(width, height, problem);
    if (!context)
    {
        std::cerr << "no OpenGL without a display: " << problem << '\n';
        return 1;
    }
    osg::Camera& camera = *viewer.getCamera();
    camera.setGraphicsContext(context->window());
    camera.setViewport(0, 0, width, height);
    camera.setProjectionMatrixAsPerspective(40.0, double(width) / height, 1.0, 1.0e4);
    camera.setViewMatrixAsLookAt(osg::Vec3d(20.0, -50.0, groundAt(20.0, -50.0) + 24.0),
                                 osg::Vec3d(-1.0, 0.0, groundAt(0.0, 0.0) + 1.0),
                                 osg::Vec3d(0.0, 0.0, 1.0));
    viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer.realize();
    lit.setTimeBudget(0.0);
    const auto begin = std::chrono::steady_clock::now();
    const auto isReady = [&]
    {
        for (const auto& object : objects)
            if (!object->isFieldReady())
                return false;
        return true;
    };
    do
    {
        viewer.frame(0.0);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    } while (!isReady() && std::chrono::steady_clock::now() - begin < std::chrono::minutes(2));
    for (int i = 0; i < 3; ++i)
        viewer.frame(0.0);
    const osg::ref_ptr<osg::Image> image = new osg::Image;
    image->readPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE);
    if (!lit.getFailure().empty())
        std::cerr << "not lit: " << lit.getFailure() << '\n';
    viewer.setSceneData(nullptr);
    return osgDB::writeImageFile(*image, file) ? 0 : 1;
}

} // namespace

int main(int argc, char** argv)
{
    osg::ArgumentParser arguments(&argc, argv);
    std::string file;
    double hour = 16.5;
    arguments.read("--headless", file);
    arguments.read("--hour", hour);
    arguments.reportRemainingOptionsAsUnrecognized();
    if (arguments.errors() || arguments.argc() > 1 || !(hour >= 0.0 && hour <= 24.0))
    {
        std::cerr << "objects [--headless FILE.png] [--hour H]: a village in the light of hour H, "
                     "0 ... 24 (16.5), in a window or as a picture\n";
        return 2;
    }
    const osg::ref_ptr<TerrainLighting> lit = new TerrainLighting;
    lit->addChild(createGround());
    const SkyLight light = lightAt(hour);
    const bool isDusk = light.sunElevation < 4.0; // degrees
    const Objects objects = addVillage(*lit, isDusk);
    lit->setSkyLight(light);
    LightingSettings settings = lit->getSettings();
    settings.bounces = 1;
    settings.exposure = isDusk ? 2.5 : 1.0; // stops
    lit->setSettings(settings);

    osgViewer::Viewer viewer;
    viewer.setSceneData(lit);
    viewer.getCamera()->setClearColor(isDusk ? osg::Vec4(0.35f, 0.38f, 0.5f, 1.0f)
                                             : osg::Vec4(0.62f, 0.72f, 0.85f, 1.0f));
    if (!file.empty())
        return drawPicture(viewer, *lit, objects, file);
    viewer.addEventHandler(new LightingHandler(lit));
    viewer.addEventHandler(new osgViewer::StatsHandler);
    return viewer.run();
}
