// Any bytes as a case: read, checked and planned, never a crash.
#include <cstddef>
#include <cstdint>
#include <string>

#include "api/case_json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  const quicksand::ParsedCase parsed = quicksand::parse_case(text);
  if (parsed.scene.has_value() != parsed.faults.empty()) __builtin_trap();  // accepted or told why not
  if (parsed.scene) {
    const quicksand::Plan plan = quicksand::make_plan(*parsed.scene);
    quicksand::plan_json(plan);
    // What is written as resolved is a case again.
    if (!quicksand::parse_case(quicksand::resolved_case(*parsed.scene)).scene) __builtin_trap();
  }
  return 0;
}
