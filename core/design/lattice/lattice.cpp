// SPDX-License-Identifier: MIT
#include "core/design/lattice/lattice.hpp"

#include <algorithm>

namespace popcut {

double RunTarget::mean_step() const {
  const std::vector<SliceCurve>& curves =
      connector_curves.empty() ? slice_curves : connector_curves;
  double sum = 0.0;
  for (const SliceCurve& c : curves) sum += c.d() + c.h();
  return sum / (2.0 * units * static_cast<double>(curves.size()));
}

Planes lattice_slices(const RunTarget& target) {
  Planes planes{target.units, std::vector<double>(target.chain_x.size())};
  for (int j = 0; j < target.slices(); ++j)
    for (int i = 0; i <= target.units; ++i)
      planes.at(j, i) = Planes::holds_height(j, i) ? target.chain_z[target.at(j, i)]
                                                   : target.chain_x[target.at(j, i)];
  return planes;
}

Planes lattice_branching(const RunTarget& target) {
  Planes planes{target.units, std::vector<double>(target.chain_x.size())};
  for (int j = 0; j < target.slices(); ++j) {
    const int branch = j & ~1;  // the even slice of the pair
    for (int i = 0; i <= target.units; ++i) {
      const int source = std::min(branch + (i & 1), target.slices() - 1);
      planes.at(j, i) = Planes::holds_height(j, i) ? target.chain_z[target.at(source, i)]
                                                   : target.chain_x[target.at(source, i)];
    }
  }
  return planes;
}

}  // namespace popcut
