#include "core/Result.h"

#include <gtest/gtest.h>

#include <memory>

using namespace osgTerrainLight;

TEST(Result, HoldsAValue)
{
    Result<std::string> result = std::string("heights");
    ASSERT_TRUE(result.ok());
    EXPECT_TRUE(static_cast<bool>(result));
    EXPECT_EQ(*result, "heights");
    EXPECT_EQ(result->size(), 7u);
    result.value() += "!";
    EXPECT_EQ(result.value(), "heights!");
}

TEST(Result, HoldsAnError)
{
    const Result<int> result = Error{ErrorCode::NotFound, "a.tif: no such file"};
    ASSERT_FALSE(result.ok());
    EXPECT_FALSE(static_cast<bool>(result));
    EXPECT_EQ(result.error().code, ErrorCode::NotFound);
    EXPECT_EQ(result.error().message, "a.tif: no such file");
}

TEST(Result, MovesWhatCannotBeCopied)
{
    Result<std::unique_ptr<int>> result = std::make_unique<int>(4);
    ASSERT_TRUE(result.ok());
    const std::unique_ptr<int> taken = std::move(*result);
    EXPECT_EQ(*taken, 4);
}

TEST(Result, StatusHasNothingToReturn)
{
    const Status good = Nothing{};
    const Status bad = Error{ErrorCode::Failed, "disk full"};
    EXPECT_TRUE(good.ok());
    EXPECT_FALSE(bad.ok());
}
