#include "api/place.hpp"

#include "api/json_text.hpp"

namespace quicksand {

void Reading::refuse(const std::string& pointer, std::string detail) {
  refused.insert(pointer);
  faults.push_back({pointer, std::move(detail)});
}

bool Reading::broken(const std::string& pointer) const {
  if (refused.contains(pointer)) return true;
  const auto below = refused.lower_bound(pointer + "/");
  return below != refused.end() && below->rfind(pointer + "/", 0) == 0;
}

Place::Place(const nlohmann::json* value, std::string pointer, Reading* reading)
    : value_(value), pointer_(std::move(pointer)), reading_(reading) {
  if (refused()) value_ = nullptr;
}

Place Place::operator[](const std::string& key) const {
  const nlohmann::json* member = nullptr;
  if (value_ && value_->is_object())
    if (const auto found = value_->find(key); found != value_->end()) member = &*found;
  return Place(member, pointer_ + "/" + pointer_step(key), reading_);
}

std::vector<std::pair<std::string, Place>> Place::items() const {
  std::vector<std::pair<std::string, Place>> all;
  if (!value_ || !value_->is_structured()) return all;
  for (const auto& item : value_->items())
    all.emplace_back(item.key(), Place(&item.value(), pointer_ + "/" + pointer_step(item.key()), reading_));
  return all;
}

void Place::read(double& out) const {
  if (value_ && value_->is_number()) out = value_->get<double>();
}

void Place::read(int& out) const {
  if (value_ && value_->is_number_integer()) out = value_->get<int>();
}

void Place::read(long& out) const {
  if (value_ && value_->is_number_integer()) out = value_->get<long>();
}

void Place::read(bool& out) const {
  if (value_ && value_->is_boolean()) out = value_->get<bool>();
}

void Place::read(std::string& out) const {
  if (value_ && value_->is_string()) out = value_->get<std::string>();
}

void Place::read(std::optional<double>& out) const {
  if (value_ && value_->is_null()) out.reset();
  if (value_ && value_->is_number()) out = value_->get<double>();
}

void Place::read(std::vector<std::string>& out) const {
  if (!value_ || !value_->is_array()) return;
  out.clear();
  for (const auto& [index, place] : items()) place.read(out.emplace_back());
}

void Place::read(Vec3& out) const {
  if (!value_ || broken()) return;
  const std::size_t expected = reading_->dimensions;
  if (expected != 0 && value_->size() != expected)
    return reading_->refuse(pointer_, "a list of " + std::to_string(value_->size()) +
                                          " is not allowed: give " + std::to_string(expected) +
                                          " numbers, as domain.dimension asks");
  for (std::size_t axis = 0; axis < value_->size(); ++axis) out[axis] = (*value_)[axis].get<double>();
}

void Place::read(Segment& out) const {
  Segment segment;
  (*this)["from"].read(segment.from);
  (*this)["to"].read(segment.to);
  out = broken() ? Segment{} : segment;
}

void Place::read(Region& out) const {
  if (!given()) return;
  Region region;
  const Place& here = *this;
  if (const Place box = here["box"]; box.given()) {
    box["min"].read(region.min);
    box["max"].read(region.max);
  } else if (const Place polygon = here["polygon"]; polygon.given()) {
    region.kind = Region::Kind::polygon;
    if (!broken())
      for (const auto& vertex : *polygon.value_)
        region.vertices.push_back({vertex[0].get<double>(), vertex[1].get<double>()});
  } else if (const Place disc = here["disc"]; disc.given()) {
    region.kind = Region::Kind::disc;
    if (const Place center = disc["center"]; !center.broken() && center.given())
      for (std::size_t axis = 0; axis < 2; ++axis) region.center[axis] = (*center.value_)[axis].get<double>();
    disc["radius"].read(region.radius);
  } else if (const Place all = here["union"]; all.given()) {
    region.kind = Region::Kind::union_of;
    all.read_parts(region);
  } else if (const Place less = here["difference"]; less.given()) {
    region.kind = Region::Kind::difference;
    less.read_parts(region);
  }
  if (broken()) {
    region = Region{};
    region.kind = Region::Kind::polygon;
  }
  out = region;
}

void Place::read_parts(Region& out) const {
  for (const auto& [index, place] : items()) place.read(out.parts.emplace_back());
}

}  // namespace quicksand
