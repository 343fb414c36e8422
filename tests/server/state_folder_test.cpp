#include "server/state_folder.hpp"

#include <gtest/gtest.h>

#include "server/files.hpp"
#include "server/run_json.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

TEST(StateFolderTest, BelongsToOneServerAtATime) {
  const TemporaryFolder folder;
  {
    StateFolder first(folder.path());
    first.announce("http://127.0.0.1:1");
    try {
      const StateFolder second(folder.path());
      FAIL() << "two servers share a state folder";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("http://127.0.0.1:1"), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(StateFolder{folder.path()});
}

TEST(StateFolderTest, AnnouncesWhileItServes) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "server.json";
  {
    StateFolder state(folder.path());
    state.announce("http://127.0.0.1:8080");
    const Json json = Json::parse(read_text(file).value());
    EXPECT_EQ(json.at("url"), "http://127.0.0.1:8080");
    EXPECT_EQ(json.at("pid"), ::getpid());
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(StateFolderTest, SaysWhenItCannotBeCreated) {
  const TemporaryFolder folder;
  write_atomically(folder.path() / "file", "");
  EXPECT_THROW(StateFolder{folder.path() / "file"}, std::runtime_error);
}

}  // namespace
}  // namespace quicksand
