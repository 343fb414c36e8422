#pragma once
// The groups of benchmarks. `point_steps`: about how many one measurement takes.

namespace quicksand::bench {

void register_machine();
void register_steps(double point_steps);
void register_pressure();
void register_program(double point_steps);

}  // namespace quicksand::bench
