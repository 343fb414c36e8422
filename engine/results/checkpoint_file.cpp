#include "engine/results/checkpoint_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "engine/run/archive.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

constexpr const char *newest_name = "checkpoint", *older_name = "checkpoint.before",
                     *unfinished_name = "checkpoint.part";
/// Changes with what is stored.
constexpr std::string_view heading = "quicksand checkpoint 1\n";

/// FNV-1a: torn and damaged files, not malice. `sum`: of the bytes before.
std::uint64_t checksum(std::string_view bytes, std::uint64_t sum = 14695981039346656037ULL) {
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return sum;
}

[[noreturn]] void refuse(const char* what) {
  throw std::runtime_error(std::string(what) + " the checkpoint: " + std::generic_category().message(errno));
}

/// An open descriptor.
struct Descriptor {
  int number;
  Descriptor(const fs::path& path, int flags) : number(open(path.c_str(), flags | O_CLOEXEC, 0644)) {
    if (number < 0) refuse("cannot open");
  }
  ~Descriptor() { close(number); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void write_all(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t done = write(number, bytes.data(), bytes.size());
      if (done < 0 && errno != EINTR) refuse("cannot write");
      if (done > 0) bytes.remove_prefix(static_cast<std::size_t>(done));
    }
  }
  void to_disk() const {
    if (fsync(number) != 0) refuse("cannot write");
  }
};

}  // namespace

void store_checkpoint(const fs::path& folder, std::string identity, std::string results,
                      const Checkpoint& run) {
  // As StoredCheckpoint::keep writes it, but for a copy of the state, which is most of a run's memory.
  Saver before, after;
  std::size_t size = run.state.size(), frames = run.frames, samples = run.samples;
  double time = run.time;
  before(identity, results, size);
  after(frames, samples, time);
  const std::uint64_t sum = checksum(after.bytes, checksum(run.state, checksum(before.bytes)));
  try {
    const Descriptor file(folder / unfinished_name, O_WRONLY | O_CREAT | O_TRUNC);
    file.write_all(heading);
    file.write_all({reinterpret_cast<const char*>(&sum), sizeof sum});
    for (const std::string_view part :
         {std::string_view(before.bytes), std::string_view(run.state), std::string_view(after.bytes)})
      file.write_all(part);
    file.to_disk();
  } catch (const std::runtime_error&) {
    std::error_code none;
    fs::remove(folder / unfinished_name, none);  // its room may be needed
    throw;
  }
  std::error_code none;
  fs::rename(folder / newest_name, folder / older_name, none);  // the first one has none before it
  fs::rename(folder / unfinished_name, folder / newest_name);
  Descriptor(folder, O_RDONLY | O_DIRECTORY).to_disk();
}

std::vector<fs::path> checkpoint_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const char* name : {newest_name, older_name})
    if (fs::exists(folder / name, none)) files.push_back(folder / name);
  return files;
}

StoredCheckpoint read_checkpoint(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::string_view rest = bytes;
  if (rest.substr(0, heading.size()) != heading)
    throw std::runtime_error("it is none, or of another version of quicksand");
  rest.remove_prefix(heading.size());
  std::uint64_t sum = 0;
  if (rest.size() < sizeof sum) throw std::runtime_error("it ends too soon");
  std::memcpy(&sum, rest.data(), sizeof sum);
  rest.remove_prefix(sizeof sum);
  if (checksum(rest) != sum) throw std::runtime_error("it is damaged");
  StoredCheckpoint checkpoint;
  Loader from(rest);
  from(checkpoint);
  return checkpoint;
}

void remove_checkpoints(const fs::path& folder) {
  std::error_code none;
  for (const char* name : {unfinished_name, older_name, newest_name}) fs::remove(folder / name, none);
}

}  // namespace quicksand
