// Google Benchmark's main, and
//
//   bench --print-case=<scene>:<points>     a timed scene as a case, e.g. bed2:100000

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include "api/case_json.hpp"
#include "tests/bench/scenes.hpp"

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

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* kPrintCase = "--print-case=";
  if (argc == 2 && std::strncmp(argv[1], kPrintCase, std::strlen(kPrintCase)) == 0)
    return print_case(argv[1] + std::strlen(kPrintCase));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
}
