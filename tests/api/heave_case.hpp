#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "api/case_json.hpp"

namespace quicksand::test {

/// A sound case that uses most of the format: tank, pipe with gate, chamber with filter, sand and water.
inline const std::string& heave_case() {
  static const std::string text = R"json({
  "schema": "quicksand.case/1",
  "name": "Heave",
  "description": "Tank left, pipe below, sand on a filter right.",
  "domain": {"max": [0.6, 0.6], "cell_size": 0.01, "sides": {"bottom": {"kind": "no_slip"}}},
  "gravity": [0, -9.81],
  "materials": {
    "soils": {
      "sand": {"grain_density": 2650, "porosity": 0.4, "max_porosity": 0.5, "permeability": {"value": 1e-4},
               "model": {"law": "mohr_coulomb", "young_modulus": 1e7, "poisson_ratio": 0.3,
                         "friction_angle": 30, "dilation_angle": 5}},
      "plate": {"permeability": {"law": "constant", "value": 1e-2},
                "model": {"law": "linear_elastic", "young_modulus": 1e9, "poisson_ratio": 0.2}}
    },
    "water": {"bulk_modulus": 2e7}
  },
  "bodies": [
    {"name": "tank", "kind": "water", "region": {"union": [
      {"box": {"min": [0, 0], "max": [0.2, 0.54]}}, {"box": {"min": [0.2, 0], "max": [0.24, 0.08]}}]}},
    {"name": "chamber", "kind": "water", "region": {"difference": [
      {"box": {"min": [0.24, 0], "max": [0.6, 0.1]}}, {"box": {"min": [0.24, 0.08], "max": [0.3, 0.1]}}]}},
    {"name": "filter", "kind": "saturated_soil", "soil": "plate", "fixed": true,
     "region": {"box": {"min": [0.3, 0.1], "max": [0.6, 0.12]}}},
    {"name": "sand", "kind": "saturated_soil", "soil": "sand",
     "region": {"polygon": [[0.3, 0.12], [0.6, 0.12], [0.6, 0.24], [0.3, 0.24]]}},
    {"name": "pond", "kind": "water", "region": {"box": {"min": [0.3, 0.24], "max": [0.6, 0.3]}}}
  ],
  "walls": [
    {"name": "divider", "block": {"box": {"min": [0.2, 0.08], "max": [0.3, 0.6]}}},
    {"name": "baffle", "line": {"from": [0.44, 0.4], "to": [0.44, 0.5]}, "no_slip": true}
  ],
  "gates": [{"name": "valve", "line": {"from": [0.24, 0], "to": [0.24, 0.08]}}],
  "initial": {"k0": 0.5},
  "loads": [{"name": "cover", "kind": "traction", "body": "sand", "traction": [0, -100], "ramp": 0.1}],
  "stages": [
    {"name": "settle", "duration": 0.5, "until_rest": {"speed": 1e-4}, "loads": []},
    {"name": "heave", "duration": 2, "open_gates": ["valve"]}
  ],
  "output": {
    "frame_interval": 0.05,
    "fields": ["displacement", "pore_pressure"],
    "probes": [
      {"name": "below", "at": [0.45, 0.12], "quantity": "head"},
      {"name": "above", "at": [0.45, 0.24], "quantity": "head"}
    ],
    "heave": {"body": "sand", "below": "below", "above": "above"}
  },
  "numerics": {"preset": "draft", "pressure_tolerance": 1e-8}
})json";
  return text;
}

inline std::vector<std::string> pointers(const std::vector<Fault>& faults) {
  std::vector<std::string> all;
  for (const Fault& fault : faults) all.push_back(fault.pointer);
  std::sort(all.begin(), all.end());
  return all;
}

/// All faults as text, for the message of a failed test.
inline std::string said(const std::vector<Fault>& faults) {
  std::string all;
  for (const Fault& fault : faults) all += "\n  " + fault.pointer + ": " + fault.detail;
  return all;
}

}  // namespace quicksand::test
