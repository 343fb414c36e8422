#pragma once
// A run is a value: scene in, frames out through a sink, progress and cancellation through a monitor.
// The command line, the workers of the server and the tests all call `run`.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/plan/plan.hpp"
#include "engine/plan/step_bounds.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// One value per point; `values.size() == components * points`, point-major.
struct FrameField {
  std::string name;  ///< as in the result file, e.g. "pore_pressure"
  std::string unit;
  int components = 1;  ///< 1, 3 (vectors, third zero in the plane) or 4/6 (xx yy zz xy [yz zx])
  std::vector<float> values;
  template <class A>
  void keep(A& a) {
    a(name, unit, components, values);
  }
};

/// State of all points at one time: moving grains, fixed grains, water, each in the order in which they were
/// made (seeded, then let in), so that a point keeps its place as long as none before it leaves.
struct Frame {
  std::size_t index = 0;
  double time = 0;  ///< s
  std::string stage;
  std::vector<double> position;     ///< m, 3 per point
  std::vector<std::uint8_t> phase;  ///< 0 solid, 1 water
  std::vector<std::int32_t> body;   ///< index into Scene::bodies
  std::vector<FrameField> fields;   ///< only the fields asked for
  std::size_t points() const { return phase.size(); }
};

struct SeriesInfo {
  std::string name;  ///< "probe.<name>", "section.<name>", "body.<name>.rise", "ledger.water_volume", …
  std::string unit;
  int components = 1;
};

/// A run between two steps, from which `run` goes on to the same results, bit for bit.
struct Checkpoint {
  std::string state;
  std::size_t frames = 0, samples = 0;  ///< that reached the sink before it
  double time = 0;                      ///< s
  template <class A>
  void keep(A& a) {
    a(state, frames, samples, time);
  }
};

/// Receives results as the run goes. Called from one thread, in order of time. Implementations throw
/// std::runtime_error when they cannot store (the run then ends as failed, code "output").
/// Called from one thread at a time, which need not be the one that computes.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  virtual void begin(const std::vector<SeriesInfo>& series) = 0;
  virtual void frame(Frame frame) = 0;
  /// `values` holds every series' components one after the other, in the order of `begin`.
  virtual void sample(double time, const std::vector<double>& values) = 0;
  /// Everything before it has been handed over. One that cannot be stored is no failure: there is the one
  /// before.
  virtual void checkpoint(const Checkpoint&) {}
};

struct Progress {
  double fraction = 0;  ///< 0…1 of simulated time
  std::string stage;
  double sim_time = 0, end_time = 0;  ///< s
  long step = 0;
  double time_step = 0;    ///< s, last
  std::string bound;       ///< what limits it
  std::size_t frames = 0;  ///< that the sink has
  double eta_s = 0;
  double wall_seconds = 0;  ///< that the run has computed, before it was resumed included
};

/// Called after every step from the run's own thread; must be cheap.
class RunMonitor {
 public:
  virtual ~RunMonitor() = default;
  virtual void progress(const Progress&) {}
  virtual void log(const std::string& /*line*/) {}
  /// What the next step, of that stage and from that time (s), is chosen by.
  virtual void situation(std::size_t /*stage*/, double /*time*/, const StepSituation&) {}
  virtual bool cancelled() { return false; }
  /// Asks for a checkpoint and the run's end (RunStatus::suspended).
  virtual bool suspended() { return false; }
};

/// What was conserved, and everything that was done to the state other than by the equations.
struct Ledger {
  double water_mass_initial = 0, water_mass = 0;      ///< kg (per metre in the plane)
  double solid_mass_initial = 0, solid_mass = 0;      ///< kg
  double water_volume_initial = 0, water_volume = 0;  ///< m³, room that the water takes (sampling.hpp)
  double water_in = 0, water_out = 0, soil_out = 0;   ///< kg, through reservoirs and open sides
  double water_removed = 0, soil_removed = 0;         ///< kg, of bodies that stages removed
  double water_volume_drift_max = 0;        ///< largest change of room − mass/ρw, over V0 or mass/ρw
  double water_volume_drift = 0;            ///< mean of it (signed) over the second half of the samples
  std::array<double, 3> momentum_change{};  ///< N·s, Σ m v now less at the start; m × inertia if scaled
  std::array<double, 3> impulse_gravity{}, impulse_walls{}, impulse_loads{};  ///< N·s
  std::array<double, 3> impulse_surface{};  ///< N·s, to drops that the water surface carries along
  std::array<double, 3> impulse_flow{};     ///< N·s, momentum of what came in less what left
  std::array<double, 3> impulse_stages{};   ///< N·s, given where a stage begins: inertia scaled back
  std::array<double, 3> impulse_damping{};  ///< N·s, of damping
  std::array<double, 3> impulse_removed{};  ///< N·s, momentum of removed bodies, negative
  double momentum_residual = 0;  ///< |change − Σ impulses| / (∫ |weight, loads| dt + Σ |m v| at the start)
  double energy_kinetic = 0, energy_potential = 0, energy_strain = 0;  ///< J
  double energy_damped = 0;  ///< J, kinetic energy that damping has taken
  long clipped_points = 0;   ///< positions put back in front of a wall
  long clamped_values = 0;
  long deleted_points = 0;
  long cut_steps = 0;  ///< steps repeated with a smaller time step
  long retries = 0;    ///< times that a failed run went back to its last good state
};

/// A stage with scaled inertia, and whether it mattered.
struct QuasiStaticReport {
  std::string stage;
  double inertia = 1;       ///< –, what inertia was multiplied by
  double process_time = 0;  ///< s, see engine/plan/quasi_static.hpp
  double transit_time = 0;  ///< s, of a wave with the scaled inertia
  /// –, largest kinetic over strain energy, after the first tenth of the process time
  double inertia_ratio = 0;
  bool negligible = true;  ///< whether the ratio stayed below 0.01
  template <class A>
  void keep(A& a) {
    a(stage, inertia, process_time, transit_time, inertia_ratio, negligible);
  }
};

/// Headline figures of a watched body (Output::heave).
struct HeaveReport {
  bool moved = false;
  double time = 0;                      ///< s, when the mean rise passed the threshold
  double head_difference = 0;           ///< m, largest between the probes until the body had moved
  double gradient = 0;                  ///< –, head_difference over the distance of the probes
  double critical_gradient = 0;         ///< –, (1−n)(ρs/ρw − 1)
  double final_rise = 0, max_rise = 0;  ///< m, mean upward movement of the body
  double max_point_displacement = 0;    ///< m
};

struct Failure {
  std::string code;               ///< "diverged", "max_steps", "output" (could not store)
  std::string message;            ///< when, where, which phase, likely cause, what to change
  double time = 0;                ///< s
  std::array<double, 3> place{};  ///< m
};

enum class RunStatus { succeeded, failed, canceled, suspended };

struct PhaseTime {
  std::string name;    ///< phase of the step: "to grid", "pressure", …; "output": frames and samples
  double seconds = 0;  ///< wall time
};

struct RunReport {
  RunStatus status = RunStatus::succeeded;
  Failure failure;                    ///< if failed
  std::vector<std::string> cautions;  ///< plain sentences: what about the answer is not as it should be
  Ledger ledger;
  std::vector<HeaveReport> heave;               ///< empty or one
  std::vector<QuasiStaticReport> quasi_static;  ///< per quasi-static stage that was begun
  double sim_time = 0, wall_seconds = 0, point_steps = 0;
  long steps = 0;
  double time_step_min = 0, time_step_max = 0;
  std::vector<StepBound> steps_bound_by;  ///< name → simulated seconds spent under it
  double pressure_iterations_mean = 0;
  std::size_t frames = 0;
  std::vector<PhaseTime> phases;
};

struct RunOptions {
  int threads = 0;  ///< 0: all cores. Never changes the result.
  /// s of wall time between two checkpoints; 0: none. Checkpoints are good states. The first ones come
  /// sooner, so that little more than half of what was computed is ever lost.
  double checkpoint_interval = 0;
  const Checkpoint* resume = nullptr;  ///< of the same scene; goes on from it
  /// Steps after which a state counts as good and is kept in memory. From it a run goes on with shorter steps
  /// when one failed. Keeping it costs about a third of a step. What the sink gets is held back until
  /// then.
  long good_every = 128;
  int retries = 6;  ///< times that steps are halved before a failure is one of the run; 0: none
};

/// Requires `check(scene)` to be empty. Never throws for what happens in the simulation; frames up to a
/// failure or cancellation have reached the sink. Resumed, the sink gets `begin`, then only what comes after
/// the checkpoint.
RunReport run(const Scene& scene, ResultSink& sink, RunMonitor& monitor, const RunOptions& options = {});

}  // namespace quicksand
