#include "engine/run/frame.hpp"

#include <algorithm>
#include <numeric>

#include "engine/run/sampling.hpp"

namespace quicksand {
namespace {

template <int D>
struct Builder {
  const Scene& scene;
  const State<D>& s;
  Frame frame;
  std::vector<std::uint32_t> soil = by_id(s.soil), fixed = by_id(s.fixed), water = by_id(s.water);

  template <class Set>
  static std::vector<std::uint32_t> by_id(const Set& set) {
    std::vector<std::uint32_t> order(set.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t p, std::uint32_t q) { return set.id[p] < set.id[q]; });
    return order;
  }

  bool wanted(const std::string& name) const {
    const auto& fields = scene.output.fields;
    return fields.empty() || std::find(fields.begin(), fields.end(), name) != fields.end();
  }

  /// Adds a field if it is asked for; value(set, point, out) writes `components` values.
  template <class Value>
  void add(const std::string& name, const std::string& unit, int components, Value&& value) {
    if (!wanted(name)) return;
    FrameField field{name, unit, components, {}};
    field.values.assign(frame.points() * components, 0.0f);
    float* out = field.values.data();
    const auto each = [&](const auto& set, const std::vector<std::uint32_t>& order) {
      for (const std::size_t p : order) value(set, p, out), out += components;
    };
    each(s.soil, soil), each(s.fixed, fixed), each(s.water, water);
    frame.fields.push_back(std::move(field));
  }

  void places() {
    const std::size_t count = soil.size() + fixed.size() + water.size();
    frame.position.reserve(3 * count), frame.phase.reserve(count), frame.body.reserve(count);
    const auto each = [&](const auto& set, const std::vector<std::uint32_t>& order, std::uint8_t phase) {
      for (const std::size_t p : order) {
        for (int d = 0; d < 3; ++d) frame.position.push_back(d < D ? set.x[p][d] : 0);
        frame.phase.push_back(phase);
        frame.body.push_back(set.body[p]);
      }
    };
    each(s.soil, soil, 0), each(s.fixed, fixed, 0), each(s.water, water, 1);
  }
};

template <class Set>
constexpr bool is_soil = requires(const Set& set) {
  set.stress;
};

}  // namespace

const std::vector<std::string>& frame_fields() {
  static const std::vector<std::string> names{
      "displacement", "velocity", "porosity", "pore_pressure", "effective_stress", "plastic_strain", "head"};
  return names;
}

template <int D>
Frame make_frame(const Scene& scene, const State<D>& s, std::size_t index, const std::string& stage) {
  Builder<D> b{scene, s, {}};
  b.frame.index = index;
  b.frame.time = s.time;
  b.frame.stage = stage;
  b.places();
  b.add("displacement", "m", 3, [](const auto& set, std::size_t p, float* out) {
    for (int d = 0; d < D; ++d) out[d] = static_cast<float>(set.x[p][d] - set.start[p][d]);
  });
  b.add("velocity", "m/s", 3, [](const auto& set, std::size_t p, float* out) {
    for (int d = 0; d < D; ++d) out[d] = static_cast<float>(set.v[p][d]);
  });
  b.add("porosity", "1", 1, [&](const auto& set, std::size_t p, float* out) {
    if constexpr (is_soil<std::decay_t<decltype(set)>>)
      *out = static_cast<float>(set.porosity[p]);
    else
      *out = static_cast<float>(porosity_at<D>(s, set.x[p]));
  });
  b.add("pore_pressure", "Pa", 1, [&](const auto& set, std::size_t p, float* out) {
    *out = static_cast<float>(pressure_at<D>(s, set.x[p]));
  });
  b.add("effective_stress", "Pa", kStress<D>, [](const auto& set, std::size_t p, float* out) {
    if constexpr (is_soil<std::decay_t<decltype(set)>>)
      for (int i = 0; i < kStress<D>; ++i) out[i] = static_cast<float>(set.stress[p][i]);
  });
  b.add("plastic_strain", "1", 1, [](const auto& set, std::size_t p, float* out) {
    if constexpr (is_soil<std::decay_t<decltype(set)>>) *out = static_cast<float>(set.plastic_strain[p]);
  });
  b.add("head", "m", 1, [&](const auto& set, std::size_t p, float* out) {
    *out = static_cast<float>(head_at<D>(s, set.x[p], pressure_at<D>(s, set.x[p])));
  });
  return std::move(b.frame);
}

template Frame make_frame<2>(const Scene&, const State<2>&, std::size_t, const std::string&);
template Frame make_frame<3>(const Scene&, const State<3>&, std::size_t, const std::string&);

}  // namespace quicksand
