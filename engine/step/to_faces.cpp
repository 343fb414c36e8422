// Points → faces and cells: masses, momenta, internal forces, drag, volumes.

#include "engine/grid/stencil.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"
#include "engine/step/soil_to_faces.hpp"
#include "engine/step/water_to_faces.hpp"

namespace quicksand {

template <int D>
void points_to_faces(State<D>& s) {
  if (s.plates_left_rows) mark_plates(s);
  activate_blocks(s);
  const bool has_fixed = s.fixed.size() > 0;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, true, [&](int i, const Cell<D>&) {
      for (int d = 0; d < D; ++d) {
        s.sums[d].clear(i);
        FaceImage& image = s.image[d][i];  // but beside walls it stays as it is, untouched in memory
        if (image.soil != 0 || image.water != 0) image = {};
        s.soil_walls.commit_separated(d, i);
      }
      if (s.counts_room) s.cell_sums[i] = has_fixed ? s.fixed_cell[i] : CellSums{};
    });
  });
  with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    s.blocks.by_color([&](int b) {
      for_batches(s.blocks, s.soil_blocks, b,
                  [&](const PointBatch<D>& batch) { soil_to_faces<S, D>(s, batch); });
      for_batches(s.blocks, s.water_blocks, b,
                  [&](const PointBatch<D>& batch) { water_to_faces<S, D>(s, batch); });
    });
  });
  loads_to_faces(s);
  fold_plates(s);
  if (s.constants.kernel == Kernel::linear) join_light_faces(s);
}

namespace {

template <class Shape, int D>
void measure_fixed_with(State<D>& s) {
  for (auto& f : s.fixed_face) f = Field<FixedFace>(s.grid.count());
  s.fixed_cell = Field<CellSums>(s.grid.count());
  for (std::size_t p = 0; p < s.fixed.size(); ++p) {
    const SoilMaterial& material = s.constants.soils[s.fixed.soil[p]];
    const PointKernel<D, Shape> kernel(s.grid, s.fixed.x[p]);
    const double n = s.fixed.porosity[p], grains = s.fixed.mass[p] / material.grain_density;
    const double bulk = grains / (1 - n),
                 resistivity = material.drag.resistivity(n, discharge_of(s.fixed, p));
    for (int d = 0; d < D; ++d)
      for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, double w, double, const Vec<D>&) {
        const double volume = s.volume.face(d, face);
        s.fixed_face[d][face].phi += w * grains / volume;
        s.fixed_face[d][face].bulk += w * bulk / volume;
        s.fixed_face[d][face].resistivity += w * bulk * resistivity / volume;
      });
    for_centers(s.grid, s.water_walls, kernel, [&](int cell, double w) {
      s.fixed_cell[cell].grains += w * grains;
      s.fixed_cell[cell].soil_bulk += w * bulk;
    });
  }
}

}  // namespace

template <int D>
void measure_fixed(State<D>& s) {
  with_kernel(s.constants.kernel, [&](auto shape) { measure_fixed_with<decltype(shape)>(s); });
}

template void points_to_faces<2>(State<2>&);
template void points_to_faces<3>(State<3>&);
template void measure_fixed<2>(State<2>&);
template void measure_fixed<3>(State<3>&);

}  // namespace quicksand
