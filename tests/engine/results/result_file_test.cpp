#include "engine/results/result_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>

#include "tests/engine/results/h5_read.hpp"
#include "tests/engine/results/known_frames.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

class ResultFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "quicksand-results-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const char* name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

void expect_known_frame(const h5_read::File& file, std::size_t k, std::size_t count) {
  char group[32];
  std::snprintf(group, sizeof group, "/frames/%06zu", k);
  const std::string name = group;
  const Frame frame = known::frame(k, count);
  EXPECT_EQ(file.attribute(name, "time"), frame.time);
  EXPECT_EQ(file.doubles(name + "/position"), frame.position) << name;
  EXPECT_EQ(file.doubles(name + "/phase"), std::vector<double>(frame.phase.begin(), frame.phase.end()));
  EXPECT_EQ(file.doubles(name + "/body"), std::vector<double>(frame.body.begin(), frame.body.end()));
  for (const FrameField& field : frame.fields)
    EXPECT_EQ(file.doubles(name + "/" + field.name),
              std::vector<double>(field.values.begin(), field.values.end()))
        << name << ' ' << field.name;
}

std::size_t frames_in_xdmf(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_TRUE(text.str().ends_with("</Xdmf>\n")) << path;
  std::size_t count = 0;
  for (auto at = text.str().find("<Time "); at != std::string::npos; at = text.str().find("<Time ", at + 1))
    ++count;
  return count;
}

TEST_F(ResultFileTest, KeepsFramesOfChangingSize) {
  ResultFile file(folder_.string(), {{"case", "{}"}});
  for (std::size_t k = 0; k < known::frames; ++k) file.frame(known::frame(k));
  file.close();
  const h5_read::File read(path("result.vtkhdf"));
  for (std::size_t k = 0; k < known::frames; ++k) expect_known_frame(read, k, known::points[k]);
  EXPECT_EQ(read.attribute("/VTKHDF/Steps", "NSteps"), known::frames);
  EXPECT_EQ(frames_in_xdmf(path("result.xdmf")), known::frames);
}

TEST_F(ResultFileTest, StartsWithoutAnyPoint) {
  ResultFile file(folder_.string(), {});
  file.frame(known::frame(0, 0));
  file.frame(known::frame(1, 5000));
  file.close();
  const h5_read::File read(path("result.vtkhdf"));
  expect_known_frame(read, 0, 0);
  expect_known_frame(read, 1, 5000);
}

TEST_F(ResultFileTest, CarriesPartUntilClosed) {
  ResultFile file(folder_.string(), {});
  file.frame(known::frame(0));
  EXPECT_TRUE(fs::exists(path("result.vtkhdf.part")));
  EXPECT_TRUE(fs::exists(path("result.xdmf.part")));
  EXPECT_FALSE(fs::exists(path("result.vtkhdf")));
  file.close();
  EXPECT_TRUE(fs::exists(path("result.vtkhdf")));
  EXPECT_TRUE(fs::exists(path("result.xdmf")));
  EXPECT_FALSE(fs::exists(path("result.vtkhdf.part")));
  EXPECT_FALSE(fs::exists(path("result.xdmf.part")));
}

TEST_F(ResultFileTest, CanBeReadWhileItIsWritten) {
  ResultFile file(folder_.string(), {});
  file.frame(known::frame(0));
  const pid_t reader = fork();  // HDF5 in this process would hand out the writer's own file
  if (reader == 0) {
    execl("/usr/bin/python3", "python3", "-c",
          "import h5py, sys; sys.exit(int(h5py.File(sys.argv[1])['frames/000000/pore_pressure'][999] != 999 "
          "* 16))",
          path("result.vtkhdf.part").c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(reader, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(ResultFileTest, KeepsSeriesSampledBetweenFrames) {
  ResultFile file(folder_.string(), {});
  file.begin(known::series());
  constexpr std::size_t samples = 10000;  // more than are kept in memory at once
  for (std::size_t s = 0; s < samples; ++s) file.sample(0.5 * static_cast<double>(s), known::sample(s));
  file.close();
  const h5_read::File read(path("result.vtkhdf"));
  const auto time = read.doubles("/series/section.pipe/time");
  const auto below = read.doubles("/series/probe.below/value");
  const auto pipe = read.doubles("/series/section.pipe/value");
  const auto water = read.doubles("/series/ledger.water_volume/value");
  ASSERT_EQ(time.size(), samples);
  ASSERT_EQ(pipe.size(), 3 * samples);
  for (std::size_t s = 0; s < samples; ++s) {
    const auto expected = known::sample(s);
    EXPECT_EQ(time[s], 0.5 * static_cast<double>(s));
    EXPECT_EQ(below[s], expected[0]);
    EXPECT_EQ(pipe[3 * s + 2], expected[3]);
    EXPECT_EQ(water[s], expected[4]);
  }
}

TEST_F(ResultFileTest, ReplacesADocument) {
  ResultFile file(folder_.string(), {{"case", "first"}});
  file.document("case", "second, and longer");
  file.document("report", "");
  file.close();
  const h5_read::File read(path("result.vtkhdf"));
  EXPECT_EQ(read.text("/run/case"), "second, and longer");
  EXPECT_EQ(read.text("/run/report"), "");
}

TEST_F(ResultFileTest, RefusesFramesThatDoNotMatchTheFirst) {
  ResultFile file(folder_.string(), {});
  file.frame(known::frame(0));
  Frame other = known::frame(1);
  other.fields.pop_back();
  EXPECT_THROW(file.frame(other), std::logic_error);
}

TEST_F(ResultFileTest, SmallRunsMakeSmallFiles) {
  ResultFile file(folder_.string(), {});
  file.begin(known::series());
  for (std::size_t k = 0; k < 100; ++k) file.frame(known::frame(k, 40));
  file.close();
  // 40 points take 4 kB a frame; the views of a frame some 15 kB.
  EXPECT_LT(fs::file_size(path("result.vtkhdf")), 100U * 25'000U);
}

TEST_F(ResultFileTest, EqualRunsGiveEqualFiles) {
  const auto bytes = [&] {
    ResultFile file(folder_.string(), {{"case", "{}"}});
    file.begin(known::series());
    for (std::size_t k = 0; k < 3; ++k) file.frame(known::frame(k));
    file.close();
    std::stringstream text;
    text << std::ifstream(path("result.vtkhdf"), std::ios::binary).rdbuf();
    return text.str();
  };
  const std::string first = bytes();
  EXPECT_TRUE(first == bytes());
}

TEST_F(ResultFileTest, AFolderThatIsNotThereIsSaidWithoutItsPath) {
  try {
    ResultFile file(path("nowhere"), {});
    FAIL() << "created a file in a folder that does not exist";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "result.vtkhdf: cannot create the file: No such file or directory");
  }
}

TEST_F(ResultFileTest, KilledRunKeepsEveryFlushedFrame) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t writer = fork();
  if (writer == 0) {
    ResultFile file(folder_.string(), {{"case", "{}"}});
    file.begin(known::series());
    for (std::size_t k = 0; k < known::frames; ++k) {
      file.sample(known::time(k), known::sample(k));
      file.frame(known::frame(k));
    }
    for (std::size_t s = 0; s < 100; ++s) file.sample(9, known::sample(s));  // not flushed yet
    [[maybe_unused]] const auto written = write(ready[1], "x", 1);
    pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);

  // As the README says: drop ".part" from both names.
  fs::rename(path("result.vtkhdf.part"), path("result.vtkhdf"));
  const h5_read::File read(path("result.vtkhdf"));
  for (std::size_t k = 0; k < known::frames; ++k) expect_known_frame(read, k, known::points[k]);
  EXPECT_EQ(read.attribute("/VTKHDF/Steps", "NSteps"), known::frames);
  EXPECT_EQ(read.doubles("/series/probe.below/value").size(), known::frames);
  EXPECT_EQ(frames_in_xdmf(path("result.xdmf.part")), known::frames);
}

/// Ends the process with 0 when `write` throws a runtime_error that names the file and `reason`.
[[noreturn]] void exit_by_refusal(const std::function<void()>& write, const std::string& reason) {
  try {
    write();
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    std::cerr << text << '\n';
    std::exit(text.starts_with("result.vtkhdf: ") && text.find(reason) != text.npos ? 0 : 2);
  }
  std::exit(3);
}

void write_frames(ResultFile& file, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k) file.frame(known::frame(k, 4000));
}

TEST_F(ResultFileTest, NoRoomForAFrameLeavesTheFileGood) {
  const auto write = [&] {
    const rlimit limit{6'000'000, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    ResultFile file(folder_.string(), {});
    std::size_t k = 0;
    try {
      for (;; ++k) file.frame(known::frame(k, 40000));
    } catch (const std::runtime_error&) {
      file.document("frames", std::to_string(k));
      file.close();
      throw;
    }
  };
  EXPECT_EXIT(exit_by_refusal(write, "File too large"), testing::ExitedWithCode(0),
              "room for the next frame");
  const h5_read::File read(path("result.vtkhdf"));
  const std::size_t frames = std::stoul(read.text("/run/frames"));
  EXPECT_GE(frames, 1U);
  EXPECT_EQ(read.attribute("/VTKHDF/Steps", "NSteps"), frames);
  for (std::size_t k = 0; k < frames; ++k) expect_known_frame(read, k, 40000);
  EXPECT_EQ(frames_in_xdmf(path("result.xdmf")), frames);
}

/// The descriptor under which this process has `path` open.
int descriptor_of(const std::string& path) {
  for (int fd = 0; fd < 256; ++fd) {
    std::error_code error;
    if (fs::read_symlink("/proc/self/fd/" + std::to_string(fd), error) == path) return fd;
  }
  return -1;
}

/// From now on everything written to `path` meets a full disk.
void fill_disk_under(const std::string& path) {
  const int full = open("/dev/full", O_RDWR);
  if (dup2(full, descriptor_of(path)) < 0) std::exit(4);
}

TEST_F(ResultFileTest, ADiskThatRefusesInTheMiddleIsAnExceptionAndNoCrash) {
  const auto write = [&] {
    ResultFile file(folder_.string(), {});
    write_frames(file, 0, 2);
    fill_disk_under(path("result.vtkhdf.part"));
    write_frames(file, 2, 3);
  };
  EXPECT_EXIT(exit_by_refusal(write, "No space left on device"), testing::ExitedWithCode(0), "No space left");
  const h5_read::File read(path("result.vtkhdf.part"));
  for (std::size_t k = 0; k < 2; ++k) expect_known_frame(read, k, 4000);
}

TEST_F(ResultFileTest, AnXdmfThatCannotGrowKeepsItsFrames) {
  const auto write = [&] {
    ResultFile file(folder_.string(), {});
    write_frames(file, 0, 2);
    fill_disk_under(path("result.xdmf.part"));
    write_frames(file, 2, 3);
  };
  EXPECT_EXIT(exit_by_refusal(write, "No space left on device"), testing::ExitedWithCode(0), "xdmf");
  EXPECT_EQ(frames_in_xdmf(path("result.xdmf.part")), 2U);
}

TEST_F(ResultFileTest, NothingIsWrittenAfterAFailure) {
  const auto write = [&] {
    ResultFile file(folder_.string(), {});
    write_frames(file, 0, 1);
    fill_disk_under(path("result.vtkhdf.part"));
    EXPECT_THROW(write_frames(file, 1, 2), std::runtime_error);
    file.document("report", "{}");
  };
  EXPECT_EXIT(exit_by_refusal(write, "an earlier write failed"), testing::ExitedWithCode(0), "earlier write");
}

TEST_F(ResultFileTest, AnotherRunCanFollowAFailure) {
  const auto write = [&] {
    try {
      ResultFile file(folder_.string(), {});
      write_frames(file, 0, 1);
      fill_disk_under(path("result.vtkhdf.part"));
      write_frames(file, 1, 2);
    } catch (const std::runtime_error&) {
      fs::remove(path("result.vtkhdf.part"));  // its inode may be the next file's
      ResultFile next(folder_.string(), {});
      write_frames(next, 0, 3);
      next.close();
      throw;
    }
  };
  EXPECT_EXIT(exit_by_refusal(write, "No space left on device"), testing::ExitedWithCode(0), "No space left");
  const h5_read::File read(path("result.vtkhdf"));
  for (std::size_t k = 0; k < 3; ++k) expect_known_frame(read, k, 4000);
}

}  // namespace
}  // namespace quicksand
