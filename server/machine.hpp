#pragma once
// What this machine has and what this process takes of it. Bytes.

namespace quicksand {

double machine_memory();
/// Memory of this process that lies in RAM.
double resident_memory();
int machine_cores();

}  // namespace quicksand
