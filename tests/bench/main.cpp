// Google Benchmark's main, and
//
//   bench --print-case=<scene>:<points>     a timed scene as a case, e.g. bed2:100000
//   bench --point-steps=<n> …               how much one measurement takes, instead of 4e6: a second of one
//   core
//                                           at 4 million point-steps/s

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include "api/case_json.hpp"
#include "tests/bench/groups.hpp"
#include "tests/bench/scenes.hpp"
#include "tests/bench/workload.hpp"

namespace {

int print_case(const std::string& text) {
  using namespace quicksand::bench;
  for (const NamedKind& k : kinds())
    for (int dimensions : {2, 3}) {
      const std::string begin = scene_name(k.kind, dimensions) + ":";
      if (text.compare(0, begin.size(), begin) != 0) continue;
      const double points = std::atof(text.c_str() + begin.size());
      if (!(points >= 100)) break;
      std::cout << quicksand::resolved_case(make_scene(k.kind, {dimensions, points, 1}));
      return 0;
    }
  std::cerr << "bench: no scene " << text << '\n';
  return 2;
}

/// What follows `option` in `text`, or null.
const char* value_of(const char* text, const char* option) {
  const std::size_t n = std::strlen(option);
  return std::strncmp(text, option, n) == 0 ? text + n : nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  double point_steps = 4e6;
  if (argc > 1) {
    if (const char* scene = value_of(argv[1], "--print-case=")) return print_case(scene);
    if (const char* number = value_of(argv[1], "--point-steps=")) {
      point_steps = std::atof(number);
      argv[1] = argv[0];
      ++argv, --argc;
    }
  }
  using namespace quicksand::bench;
  register_machine();
  register_steps(point_steps);
  register_pressure();
  register_program(point_steps);
  benchmark::AddCustomContext("reduced_steps", kReducedSteps ? "yes" : "no");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
}
