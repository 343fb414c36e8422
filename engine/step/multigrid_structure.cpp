// Levels of the multigrid: cubes of cells, their neighbours, and runs of rows.

#include <algorithm>

#include "engine/step/multigrid.hpp"
#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Levels are added until one has at most this many rows, which a few sweeps solve.
constexpr std::size_t kFewRows = 16;
/// Rows of a run at most, so that threads find parts of it.
constexpr int kLongestRun = 1024;

}  // namespace

template <int D>
void Multigrid<D>::find_runs(Level& level, const Neighbors& neighbor) {
  const int n = static_cast<int>(level.rows());
  std::vector<Run>& runs = level.runs;
  runs.clear(), level.parts.clear();
  int in_part = static_cast<int>(kChunk);
  const auto goes_on = [&](const Run& run, int r) {
    if (run.count == kLongestRun) return false;
    for (int k = 0; k < kSides; ++k) {
      const bool none = run.neighbor[k] == run.first;
      if (neighbor[k][r] != (none ? -1 : run.neighbor[k] + run.count)) return false;
    }
    return true;
  };
  for (int r = 0; r < n; ++r) {
    if (r == level.even) level.odd_part = static_cast<int>(level.parts.size());
    const bool new_part = in_part >= static_cast<int>(kChunk) || r == level.even;
    if (new_part) level.parts.push_back(static_cast<int>(runs.size())), in_part = 0;
    if (new_part || !goes_on(runs.back(), r)) {
      runs.push_back({r, 0, {}});
      for (int k = 0; k < kSides; ++k) runs.back().neighbor[k] = neighbor[k][r] < 0 ? r : neighbor[k][r];
    }
    ++runs.back().count, ++in_part;
  }
  if (level.even == n) level.odd_part = static_cast<int>(level.parts.size());
  level.parts.push_back(static_cast<int>(runs.size()));
}

template <int D>
void Multigrid<D>::build_structure(const Grid<D>& grid, const PressureSystem<D>& m) {
  std::vector<Cell<D>> place;
  for (const int cell : m.cell) place.push_back(grid.cell(cell));
  levels_.assign(1, {});
  const auto make_vectors = [](Level& level, std::size_t rows, int even) {
    level.even = even;
    for (auto* v : {&level.inverse, &level.x, &level.b}) v->assign(rows, 0);
    level.left.assign(even, 0);
  };
  make_vectors(levels_[0], m.cell.size(), m.even);
  find_runs(levels_[0], m.neighbor);
  while (levels_.back().rows() > kFewRows) {
    Level coarse;
    const Neighbors neighbor = coarsen(levels_.back(), coarse, place);
    make_vectors(coarse, place.size(), coarse.even);
    find_runs(coarse, neighbor);
    const bool stuck = coarse.rows() == levels_.back().rows();
    if (stuck) break;
    levels_.push_back(std::move(coarse));
  }
}

/// Rows of the cubes that hold rows of `fine`; `place`, of the rows of `fine`, becomes that of the cubes.
template <int D>
typename Multigrid<D>::Neighbors Multigrid<D>::coarsen(Level& fine, Level& coarse,
                                                       std::vector<Cell<D>>& place) {
  Cell<D> low = place[0], high = low, size, step;
  for (const Cell<D>& c : place)
    for (int d = 0; d < D; ++d) low[d] = std::min(low[d], c[d] >> 1), high[d] = std::max(high[d], c[d] >> 1);
  std::size_t slots = 1;
  for (int d = 0; d < D; ++d) {
    size[d] = high[d] - low[d] + 1;
    step[d] = static_cast<int>(slots);
    slots *= size[d];
  }
  const auto slot = [&](const Cell<D>& c) {
    int i = 0;
    for (int d = 0; d < D; ++d) i += ((c[d] >> 1) - low[d]) * step[d];
    return i;
  };
  std::vector<int> row_at(slots, -1);
  for (const Cell<D>& c : place) row_at[slot(c)] = 0;
  std::vector<Cell<D>> cubes;
  std::vector<int> at;  // slots
  for (const int color : {0, 1}) {
    for (std::size_t first = 0; first < slots; first += size[0]) {
      Cell<D> c = low;
      for (std::size_t d = 1, rest = first / size[0]; d < D; rest /= size[d], ++d)
        c[d] += static_cast<int>(rest % size[d]);
      int parity = 0;
      for (const int i : c) parity ^= i & 1;
      for (int x = parity ^ color; x < size[0]; x += 2) {
        if (row_at[first + x] < 0) continue;
        at.push_back(static_cast<int>(first) + x);
        c[0] = low[0] + x;
        cubes.push_back(c);
      }
    }
    if (color == 0) coarse.even = static_cast<int>(cubes.size());
  }
  const int n = static_cast<int>(cubes.size());
  for (int r = 0; r < n; ++r) row_at[at[r]] = r;
  coarse.children.resize(n);
  for (auto& of : coarse.children) of.fill(-1);
  fine.parent.resize(place.size());
  for (std::size_t r = 0; r < place.size(); ++r) {
    int child = 0;
    for (int d = 0; d < D; ++d) child |= (place[r][d] & 1) << d;
    const int row = row_at[slot(place[r])];
    coarse.children[row][child] = static_cast<int>(r);
    fine.parent[r] = row;
  }
  coarse.own.resize(n);
  Neighbors neighbor;
  for (int k = 0; k < kSides; ++k) {
    neighbor[k].resize(n);
    const int d = k / 2, edge = k % 2 ? high[d] : low[d], by = k % 2 ? step[d] : -step[d];
    for (int r = 0; r < n; ++r) neighbor[k][r] = cubes[r][d] == edge ? -1 : row_at[at[r] + by];
  }
  place = std::move(cubes);
  return neighbor;
}

template void Multigrid<2>::find_runs(Level&, const Neighbors&);
template void Multigrid<3>::find_runs(Level&, const Neighbors&);
template void Multigrid<2>::build_structure(const Grid<2>&, const PressureSystem<2>&);
template void Multigrid<3>::build_structure(const Grid<3>&, const PressureSystem<3>&);
template Multigrid<2>::Neighbors Multigrid<2>::coarsen(Level&, Level&, std::vector<Cell<2>>&);
template Multigrid<3>::Neighbors Multigrid<3>::coarsen(Level&, Level&, std::vector<Cell<3>>&);

}  // namespace quicksand
