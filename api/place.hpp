#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "api/words.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// What all places of one document share while it is read.
struct Reading {
  std::set<std::string>& refused;  ///< pointers of values that must not be read
  std::vector<Fault>& faults;
  std::size_t dimensions = 0;  ///< length that vectors must have; 0 while unknown

  void refuse(const std::string& pointer, std::string detail);
  /// True when the place or anything in it was refused.
  bool broken(const std::string& pointer) const;
};

/// A place in the document that may be absent. `read` leaves its argument as it is when the place is absent
/// or was refused, so that what is right can be read beside what is wrong.
class Place {
 public:
  Place(const nlohmann::json& root, Reading& reading) : value_(&root), reading_(&reading) {}

  Place operator[](const std::string& key) const;
  /// Items of a list or members of an object, in order; for members with their key.
  std::vector<std::pair<std::string, Place>> items() const;

  bool given() const { return value_ != nullptr; }
  bool is_list() const { return value_ && value_->is_array(); }
  bool refused() const { return reading_->refused.contains(pointer_); }
  bool broken() const { return reading_->broken(pointer_); }
  const std::string& pointer() const { return pointer_; }
  Reading& reading() const { return *reading_; }

  void read(double& out) const;
  void read(int& out) const;
  void read(long& out) const;
  void read(bool& out) const;
  void read(std::string& out) const;
  void read(std::optional<double>& out) const;  ///< null: no value
  void read(std::vector<std::string>& out) const;
  void read(Vec3& out) const;     ///< refuses a length other than the scene's dimensions
  void read(Segment& out) const;  ///< with a fault in it: one of no length
  void read(Region& out) const;   ///< a region with a fault anywhere becomes one that holds nothing

  template <typename Choice>
  requires std::is_enum_v<Choice>
  void read(Choice& out) const {
    std::string word;
    read(word);
    for (const auto& [value, name] : words_of(Choice{}))
      if (word == name) out = value;
  }

 private:
  Place(const nlohmann::json* value, std::string pointer, Reading* reading);
  void read_parts(Region& out) const;

  const nlohmann::json* value_;  ///< null: absent or refused
  std::string pointer_;
  Reading* reading_;
};

}  // namespace quicksand
