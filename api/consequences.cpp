#include "api/consequences.hpp"

#include <algorithm>
#include <string_view>

namespace quicksand {
namespace {

/// Takes the first step off a pointer.
std::string_view next_step(std::string_view& pointer) {
  const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
  const std::string_view step = pointer.substr(0, end);
  pointer.remove_prefix(end);
  return step;
}

/// True when every step of `pattern` ('*': any) is matched by `pointer`; `pointer` may go deeper if `below`.
bool matches(std::string_view pattern, std::string_view pointer, bool below) {
  while (!pattern.empty()) {
    if (pointer.empty()) return false;
    const std::string_view wanted = next_step(pattern), step = next_step(pointer);
    if (wanted != "/*" && wanted != step) return false;
  }
  return below || pointer.empty();
}

bool related(const std::string& a, const std::string& b) {
  return matches(a, b, true) || matches(b, a, true);
}

/// A fault at or below `fault` says nothing while a place that `refused` describes is refused.
struct Doubt {
  const char* fault;
  const char* refused;
  bool below = false;  ///< also for refused places below it
};
constexpr Doubt doubts[] = {
    {"/domain/cell_size", "/domain", true},
    {"/domain/cell_size", "/numerics", true},
    {"/materials/soils/*/max_porosity", "/materials/soils/*/porosity"},
    {"/materials/soils/*/model", "/materials/soils/*/model/friction_angle"},
    {"/materials/soils/*/model", "/materials/soils/*/model/cohesion"},
    {"/materials/soils/*/model/swelling_slope", "/materials/soils/*/model/compression_slope"},
    {"/stages/*/until_rest", "/stages/*/duration"},
    {"/stages/*/heads_ramp", "/stages/*/duration"},
    {"/initial/k0", "/materials", true},  // has every soil its own
    {"/reservoirs", "/walls", true},      // which may be an outside, or in the way
    {"/output/probes", "/walls", true},
    {"/loads/*/plate", "/bodies", true},
    {"/stages/*/loads", "/bodies", true},
    {"/materials", "/bodies", true},  // is it used, is there water
    {"/initial", "/bodies", true},
    {"/numerics", "/bodies", true},
    {"/stages/*/quasi_static", "/bodies", true},
    {"/numerics/quasi_static_transits", "/stages", true},
    {"/materials", "/reservoirs"},  // is there water
    {"/initial", "/reservoirs"},
    {"/numerics", "/reservoirs"},
    {"/output", "/reservoirs"},
    {"/bodies/*/soil", "/materials"},
    {"/bodies/*/soil", "/materials/soils"},
    {"/stages/*/open_gates", "/gates"},
    {"/stages/*/open_gates", "/gates/*"},
    {"/stages/*/open_gates", "/gates/*/name"},
    {"/stages/*/heads", "/reservoirs"},
    {"/stages/*/heads", "/reservoirs/*"},
    {"/stages/*/heads", "/reservoirs/*/name"},
    {"/stages/*/loads", "/loads"},
    {"/stages/*/loads", "/loads/*"},
    {"/stages/*/loads", "/loads/*/name"},
    {"/stages/*/remove_bodies", "/bodies", true},
    {"/gates", "/stages", true},  // is it ever opened
    {"/loads", "/stages", true},
    {"/loads/*/body", "/bodies", true},
    {"/output/heave", "/bodies", true},
    {"/output/heave", "/output/probes", true},
    {"/output/probes", "/bodies", true},
    {"/output/fields", "/bodies", true},
    {"/output/frame_interval", "/stages", true},
    {"/output/series_interval", "/stages", true},
};

bool doubtful(const Fault& fault, const std::string& refused) {
  if (related(fault.pointer, refused)) return true;
  return std::any_of(std::begin(doubts), std::end(doubts), [&](const Doubt& doubt) {
    return matches(doubt.fault, fault.pointer, true) && matches(doubt.refused, refused, doubt.below);
  });
}

}  // namespace

std::vector<Fault> without_consequences(std::vector<Fault> faults, const std::set<std::string>& refused) {
  std::erase_if(faults, [&](const Fault& fault) {
    return std::any_of(refused.begin(), refused.end(),
                       [&](const std::string& place) { return doubtful(fault, place); });
  });
  return faults;
}

}  // namespace quicksand
