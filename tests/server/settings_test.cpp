#include "server/settings.hpp"

#include <gtest/gtest.h>

namespace quicksand {
namespace {

TEST(Settings, DefaultsAreWithinTheirRanges) {
  const Settings settings;
  for (const Setting& setting : settings_table())
    if (const auto count = std::get_if<Count Settings::*>(&setting.place)) {
      EXPECT_GE(settings.*(*count), setting.least) << setting.name;
      EXPECT_LE(settings.*(*count), setting.most) << setting.name;
    }
}

TEST(Settings, PrintedOnesReadBackTheSame) {
  Settings settings;
  settings.port = 9000;
  settings.state = "/var/lib/x y";
  settings.max_body_bytes = 5 << 20;
  settings.max_data_bytes = (1 << 20) + 1;
  const std::string text = print_settings(settings);
  EXPECT_NE(text.find("\nmax_body_bytes = 5M\n"), std::string::npos) << text;
  Settings again;
  EXPECT_TRUE(read_settings(text, again).empty());
  EXPECT_EQ(print_settings(again), text);
  EXPECT_EQ(again.state, settings.state);
  EXPECT_EQ(again.max_data_bytes, settings.max_data_bytes);
}

TEST(Settings, EveryOneIsDocumentedOnce) {
  const std::string text = print_settings({});
  for (const Setting& setting : settings_table()) {
    const std::string line = std::string("\n") + setting.name + " = ";
    EXPECT_NE(text.find(line), std::string::npos) << setting.name;
    EXPECT_EQ(text.find(line), text.rfind(line)) << setting.name;
    EXPECT_GT(std::string(setting.help).size(), 10u) << setting.name;
  }
}

TEST(Settings, SizesTakeSuffixes) {
  Settings settings;
  EXPECT_EQ(set(settings, "max_body_bytes", "2M"), "");
  EXPECT_EQ(settings.max_body_bytes, 2 << 20);
  EXPECT_EQ(set(settings, "max_body_bytes", "4096"), "");
  EXPECT_EQ(settings.max_body_bytes, 4096);
}

TEST(Settings, WhatIsWrongIsNamedWithItsRange) {
  Settings settings;
  for (const char* value : {"", "x", "1x", "-1", "0", "65", "1k", "1 2", "99999999999999999999"}) {
    const std::string wrong = set(settings, "workers", value);
    EXPECT_NE(wrong.find("workers"), std::string::npos) << value;
    EXPECT_NE(wrong.find("1 to 64"), std::string::npos) << value;
  }
  EXPECT_NE(set(settings, "max_body_bytes", "9000000T"), "");
  EXPECT_NE(set(settings, "max_body_bytes", "2Mi"), "");
  EXPECT_NE(set(settings, "log_level", "loud"), "");
  EXPECT_NE(set(settings, "colour", "blue").find("colour"), std::string::npos);
}

TEST(Settings, AFileTellsAllFaultsByLine) {
  Settings settings;
  const auto faults =
      read_settings("# ours\nworkers = 2 # two\n\nport\ncolour = blue\nworkers = 3\n", settings);
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_EQ(faults[0].pointer, "line 4");
  EXPECT_EQ(faults[1].pointer, "line 5");
  EXPECT_EQ(faults[2].pointer, "line 6");
}

TEST(Settings, ALimitIsNamedWithItsSetting) {
  EXPECT_EQ(named_limit({}, &Settings::max_body_bytes), "4M (max_body_bytes)");
  EXPECT_EQ(named_limit({}, &Settings::max_queued), "1000 (max_queued)");
}

}  // namespace
}  // namespace quicksand
