#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/results/result_file.hpp"
#include "tests/engine/results/h5_read.hpp"
#include "tests/engine/results/known_frames.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

class CheckpointTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "quicksand-checkpoint-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string text(const char* name) const {
    std::stringstream all;
    all << std::ifstream(folder_ / name).rdbuf();
    return all.str();
  }
  /// Frames and samples from..to−1 of a run, three samples to a frame.
  static void write(ResultFile& file, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      for (std::size_t i = 3 * k; i < 3 * k + 3; ++i) file.sample(static_cast<double>(i), known::sample(i));
      file.frame(known::frame(k));
    }
  }
  static Checkpoint after(std::size_t frames) {
    return {"state after " + std::to_string(frames), frames, 3 * frames, known::time(frames)};
  }

  fs::path folder_;
  const std::map<std::string, std::string> documents_{{"case_resolved", "{}"}, {"engine_version", "1"}};
};

std::vector<double> column(const h5_read::File& file, const std::string& name) { return file.doubles(name); }

TEST_F(CheckpointTest, ResultsAreCutBackAndGoOn) {
  ResultFile whole((folder_).string(), documents_);
  whole.begin(known::series());
  write(whole, 0, known::frames);
  whole.close();
  const std::string view = text("result.xdmf");
  fs::rename(folder_ / "result.vtkhdf", folder_ / "whole.vtkhdf");
  {
    ResultFile first(folder_.string(), documents_);
    first.begin(known::series());
    write(first, 0, 2);
    first.checkpoint(after(2));
    write(first, 2, 4);
  }                                       // left behind with two frames too many
  for (int time = 0; time < 2; ++time) {  // interrupted again before the next checkpoint
    const StoredCheckpoint from = read_checkpoint(checkpoint_files(folder_).front());
    EXPECT_EQ(from.run.state, "state after 2");
    EXPECT_EQ(from.identity, run_identity(documents_));
    ResultFile rest(folder_.string(), documents_, &from);
    rest.begin(known::series());
    write(rest, 2, known::frames);
    if (time == 1) rest.close();
  }
  EXPECT_EQ(text("result.xdmf"), view);
  const h5_read::File a((folder_ / "whole.vtkhdf").string()), b((folder_ / "result.vtkhdf").string());
  for (std::size_t k = 0; k < known::frames; ++k)
    for (const char* field : {"position", "phase", "body", "displacement", "effective_stress", "vertex"}) {
      const std::string name = "/frames/00000" + std::to_string(k) + "/" + field;
      EXPECT_EQ(column(a, name), column(b, name)) << name;
    }
  for (const char* name : {"/series/section.pipe/value", "/series/ledger.water_volume/time",
                           "/VTKHDF/Steps/PointOffsets", "/VTKHDF/Steps/Values", "/VTKHDF/NumberOfPoints",
                           "/VTKHDF/Vertices/Offsets", "/VTKHDF/Steps/PointDataOffsets/strain"})
    EXPECT_EQ(column(a, name), column(b, name)) << name;
  EXPECT_EQ(b.attribute("/VTKHDF/Steps", "NSteps"), known::frames);
}

TEST_F(CheckpointTest, ARunThatEndsSoonerKeepsNothingOfWhatCameAfter) {
  {
    ResultFile first(folder_.string(), documents_);
    first.begin(known::series());
    write(first, 0, 2);
    first.checkpoint(after(2));
    write(first, 2, known::frames);
  }
  const StoredCheckpoint from = read_checkpoint(checkpoint_files(folder_).front());
  ResultFile rest(folder_.string(), documents_, &from);
  rest.begin(known::series());
  write(rest, 2, 4);
  rest.close();
  const h5_read::File file((folder_ / "result.vtkhdf").string());
  EXPECT_EQ(file.attribute("/VTKHDF/Steps", "NSteps"), 4);
  EXPECT_EQ(column(file, "/series/probe.below/value").size(), 12u);
  EXPECT_EQ(column(file, "/VTKHDF/Steps/Values").size(), 4u);
  EXPECT_EQ(column(file, "/frames/000003/position"), known::frame(3).position);
  EXPECT_ANY_THROW(column(file, "/frames/000004/position"));
}

TEST_F(CheckpointTest, TheOneBeforeServesWhenTheNewestIsDamaged) {
  for (const char* state : {"first", "second", "third"}) {
    StoredCheckpoint stored{"case", "", {state, 1, 2, 3}};
    store_checkpoint(folder_, stored.identity, stored.results, stored.run);
  }
  auto files = checkpoint_files(folder_);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(read_checkpoint(files[0]).run.state, "third");
  EXPECT_EQ(read_checkpoint(files[1]).run.state, "second");
  fs::resize_file(files[0], fs::file_size(files[0]) - 1);
  EXPECT_THROW(read_checkpoint(files[0]), std::runtime_error);
  std::fstream(files[1], std::ios::in | std::ios::out).seekp(40).put('!');
  EXPECT_THROW(read_checkpoint(files[1]), std::runtime_error);
  std::ofstream(files[1]) << "something else";
  EXPECT_THROW(read_checkpoint(files[1]), std::runtime_error);
  remove_checkpoints(folder_);
  EXPECT_TRUE(checkpoint_files(folder_).empty());
}

TEST_F(CheckpointTest, ANewRunForgetsThoseOfAnother) {
  StoredCheckpoint stored{"case", "", {}};
  store_checkpoint(folder_, stored.identity, stored.results, stored.run);
  const ResultFile file(folder_.string(), documents_);
  EXPECT_TRUE(checkpoint_files(folder_).empty());
}

TEST_F(CheckpointTest, WhatIsLeftBehindBecomesTheResults) {
  EXPECT_FALSE(finish_result_files(folder_.string()));
  {
    ResultFile left(folder_.string(), documents_);
    left.begin(known::series());
    write(left, 0, 2);
  }
  EXPECT_TRUE(finish_result_files(folder_.string()));
  const h5_read::File file((folder_ / "result.vtkhdf").string());
  EXPECT_EQ(column(file, "/frames/000001/position"), known::frame(1).position);
  EXPECT_TRUE(fs::exists(folder_ / "result.xdmf"));
}

TEST_F(CheckpointTest, WhatCannotBeOpenedDoesNot) {
  { ResultFile left(folder_.string(), documents_); }
  fs::resize_file(folder_ / "result.vtkhdf.part", 100);
  EXPECT_FALSE(finish_result_files(folder_.string()));
  EXPECT_FALSE(fs::exists(folder_ / "result.vtkhdf"));
}

TEST_F(CheckpointTest, MissingResultsAreSaid) {
  const StoredCheckpoint from{run_identity(documents_), "", after(1)};
  EXPECT_THROW(ResultFile(folder_.string(), documents_, &from), std::runtime_error);
}

}  // namespace
}  // namespace quicksand
