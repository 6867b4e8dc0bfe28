#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace osgTerrainLight
{

/// A folder for the files of the running test, below the build folder and named after the test. It
/// is empty when the test first asks, and goes with the test unless it fails.
inline std::filesystem::path testFolder()
{
    class Remover : public ::testing::EmptyTestEventListener
    {
    public:
        void OnTestEnd(const ::testing::TestInfo& test) override
        {
            if (!folder.empty() && !test.result()->Failed())
                std::filesystem::remove_all(folder);
            folder.clear();
        }
        std::filesystem::path folder;
    };
    static Remover* const remover = []
    {
        auto* made = new Remover; // GoogleTest deletes it
        ::testing::UnitTest::GetInstance()->listeners().Append(made);
        return made;
    }();
    if (remover->folder.empty())
    {
        const auto& test = *::testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string(test.test_suite_name()) + "." + test.name();
        std::replace(name.begin(), name.end(), '/', '_'); // of tests with parameters
        remover->folder = std::filesystem::path(OTL_BINARY_DIR) / "test_folders" / name;
        std::filesystem::remove_all(remover->folder);
        std::filesystem::create_directories(remover->folder);
    }
    return remover->folder;
}

} // namespace osgTerrainLight
