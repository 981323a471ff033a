#include "data/core/paths.h"

#include <cstdlib>

#include "tests/data/files/file_fixture.h"

namespace cloth::paths_test {

using namespace cloth::test;

using Paths = FileTest;

TEST_F(Paths, FindsWhatTheProjectShips) {
    EXPECT_TRUE(std::filesystem::exists(asset_path("body_rig.json")));
    EXPECT_TRUE(std::filesystem::exists(model_path("Collada/human.zae")));
}

TEST_F(Paths, AMissingModelNamesThePackage) {
    expect_load_error([] { model_path("no/such.obj"); }, "/usr/share/assimp/models/no/such.obj",
                      "apt-get install assimp-testmodels");
}

TEST_F(Paths, AMissingAssetNamesEveryFolderThatWasSearchedAndTheRemedy) {
    const auto look = [] { asset_path("no_such.json", "/opt/game/assets"); };
    expect_load_error(look, "no_such.json", "no such file in /opt/game/assets and /");
    expect_load_error(look, "no_such.json", "pkg-config --variable=assets fastcloth");
    setenv("CLOTH_ASSETS", "/opt/own", 1);
    expect_load_error(look, "no_such.json", "no such file in /opt/own, by CLOTH_ASSETS");
    unsetenv("CLOTH_ASSETS");
}

TEST_F(Paths, EnvironmentVariablesMoveTheFolders) {
    write("own.obj", "v 0 0 0\n");
    const std::string folder = std::filesystem::path(path("own.obj")).parent_path().string();
    setenv("CLOTH_MODELS", folder.c_str(), 1);
    setenv("CLOTH_SHARED_DATA", folder.c_str(), 1);
    EXPECT_EQ(model_path("own.obj"), path("own.obj"));
    EXPECT_EQ(shared_data_path("own.obj"), path("own.obj"));
    EXPECT_FALSE(shared_data_path("motions").has_value());
    unsetenv("CLOTH_MODELS");
    unsetenv("CLOTH_SHARED_DATA");
}

}  // namespace cloth::paths_test
