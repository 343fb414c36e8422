// Points in the order of the cells they lie in: neighbours in space are then neighbours in memory, whatever
// way they have come.

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Steps between two sorts. A point stays within two cells of its place in memory, as a step moves it by
/// `kMaxTravel` cells at the most and mostly by far less.
constexpr long kSortInterval = 64;

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
  reorder(s.soil, s.soil_blocks.order);
  const std::vector<std::uint32_t>& order = s.water_blocks.order;
  reorder(s.water, order);
  if (s.straddlers.empty()) return;
  std::vector<std::uint32_t> now(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) now[order[i]] = static_cast<std::uint32_t>(i);
  for (Straddler& straddler : s.straddlers) straddler.point = now[straddler.point];
}

template void sort_points<2>(State<2>&);
template void sort_points<3>(State<3>&);

}  // namespace quicksand
