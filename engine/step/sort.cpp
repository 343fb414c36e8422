// Points in the order of the cells they lie in: neighbours in space are then neighbours in memory, whatever
// way they have come.

#include <algorithm>
#include <numeric>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Steps between two sorts. A point stays within two cells of its place in memory, as a step moves it by
/// `kMaxTravel` cells at the most and mostly by far less.
constexpr long kSortInterval = 64;

/// Order of a set's points by block, and by cell within a block.
template <int D>
std::vector<std::uint32_t> order_by_cell(const State<D>& s, const std::vector<Vec<D>>& x,
                                         const BlockList& list) {
  std::vector<std::uint32_t> order = list.order;
  std::vector<int> cell(x.size());
  for (std::size_t p = 0; p < x.size(); ++p) cell[p] = s.grid.index(s.grid.cell_of(x[p]));
  s.blocks.all([&](int b) {
    std::stable_sort(order.begin() + list.begin[b], order.begin() + list.begin[b + 1],
                     [&](std::uint32_t p, std::uint32_t q) { return cell[p] < cell[q]; });
  });
  return order;
}

template <class Set>
void reorder(Set& set, const std::vector<std::uint32_t>& order) {
  for_arrays(set, [&](auto& array) {
    if (array.empty()) return;
    std::decay_t<decltype(array)> sorted;
    sorted.reserve(array.size());
    for (const std::uint32_t p : order) sorted.push_back(array[p]);
    array.swap(sorted);
  });
}

}  // namespace

template <int D>
void sort_points(State<D>& s) {
  if (s.steps++ % kSortInterval != 0) return;
  activate_blocks(s);
  reorder(s.soil, order_by_cell<D>(s, s.soil.x, s.soil_blocks));
  const std::vector<std::uint32_t> order = order_by_cell<D>(s, s.water.x, s.water_blocks);
  reorder(s.water, order);
  if (s.straddlers.empty()) return;
  std::vector<std::uint32_t> now(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) now[order[i]] = static_cast<std::uint32_t>(i);
  for (Straddler& straddler : s.straddlers) straddler.point = now[straddler.point];
}

template void sort_points<2>(State<2>&);
template void sort_points<3>(State<3>&);

}  // namespace quicksand
