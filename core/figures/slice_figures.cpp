// SPDX-License-Identifier: MIT
#include "core/figures/slice_figures.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/design/chain/chain.hpp"

namespace popcut {
namespace {

struct Chain {
  std::vector<double> x, z;
  double loss{};
};

Result<Chain> quarter_circle_chain(int units) {
  Chain chain;
  chain.x.resize(static_cast<std::size_t>(units) + 1);
  chain.z.resize(chain.x.size());
  const auto figures = ChainSolver().solve(SliceCurve(1.0, 1.0), units, chain.x, chain.z);
  if (!figures) return tl::unexpected(figures.error());
  chain.loss = figures->loss;
  return chain;
}

}  // namespace

double AzimuthalError::mean() const {
  return std::accumulate(value.begin(), value.end(), 0.0) / static_cast<double>(value.size());
}

Result<AzimuthalError> azimuthal_error(int units, AzimuthalConvention convention) {
  const auto chain = quarter_circle_chain(units);
  if (!chain) return tl::unexpected(chain.error());
  const double step = std::numbers::pi / (2.0 * units);
  AzimuthalError out;
  const auto add = [&](double x, double z, double due) {
    const double off = std::atan2(x, z) - due;
    out.value.push_back(off * off);
  };
  for (std::size_t i = 0; i < chain->x.size(); ++i) {
    const auto count = static_cast<double>(i);
    if (convention == AzimuthalConvention::Vertices) {
      add(chain->x[i], chain->z[i], count * step);
    } else if (i > 0) {
      add(chain->x[i], chain->z[i - 1], (count - 0.5) * step);
    }
  }
  return out;
}

Result<double> quarter_circle_loss(int units) {
  const auto chain = quarter_circle_chain(units);
  if (!chain) return tl::unexpected(chain.error());
  return chain->loss;
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double a = std::log(x[k]), b = std::log(y[k]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  const auto n = static_cast<double>(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace popcut
