#include "fields/MeshField.h"

#include "support/TestMeshes.h"

#include <gtest/gtest.h>

using namespace osgTerrainLight;

// Only in builds without Embree. Expected: an error by which a caller takes the mesh's box.
TEST(FieldsWithoutEmbree, SayWhy)
{
    const Result<BakedField> field = bakeMesh(makeHouse().mesh);
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().code, ErrorCode::NotSupported);
    EXPECT_NE(field.error().message.find("built without Embree"), std::string::npos);
}
