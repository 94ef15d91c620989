// SPDX-License-Identifier: MIT
#include "core/design/lattice/panel_error.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

// Gauss's three points on [0, 1].
constexpr std::array<double, 3> kGaussAt{0.1127016653792583, 0.5, 0.8872983346207417};
constexpr std::array<double, 3> kGaussWeight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

}  // namespace

PanelError::PanelError(const RunTarget& target) {
  const int slices = target.slices();
  std::vector<double> s_mm;
  for (int j = 0; j < slices; ++j) {
    const auto k = static_cast<std::size_t>(j);
    section_.emplace_back(target.slice_curves[k]);
    width_.push_back(0.5 * target.slice_width_mm[k]);
    s_mm.push_back(target.slice_s_mm[k]);
    if (k >= target.connector_curves.size()) continue;
    section_.emplace_back(target.connector_curves[k]);
    width_.push_back(0.25 * (target.slice_width_mm[k] + target.slice_width_mm[k + 1]));
    s_mm.push_back(target.connector_s_mm[k]);
  }
  for (int strip = 0; strip < strips(); ++strip) {
    const int before = std::max(0, strip - 1), after = std::min(strips() - 1, strip + 1);
    const double apart =
        s_mm[static_cast<std::size_t>(after)] - s_mm[static_cast<std::size_t>(before)];
    for (int place = 0; place < kSteepPlaces; ++place) {
      const SectionPoint p = section(strip).at(-1.0 + 2.0 * place / (kSteepPlaces - 1));
      const double slope =
          apart > 0.0 ? (section(after).foot(p).e - section(before).foot(p).e) / apart : 0.0;
      steep_.push_back(1.0 / (1.0 + slope * slope));
    }
  }
}

double PanelError::steepness(int strip, double t) const {
  const double* const q = steep_.data() + static_cast<std::ptrdiff_t>(strip) * kSteepPlaces;
  const double at = std::clamp(0.5 * (t + 1.0), 0.0, 1.0) * (kSteepPlaces - 1);
  const int k = std::min(static_cast<int>(at), kSteepPlaces - 2);
  return q[k] + (at - k) * (q[k + 1] - q[k]);
}

double PanelError::value(const Panel& panel, const std::vector<double>& p) const {
  const double begin = panel.begin.of(p), length = panel.end.of(p) - begin;
  const double plane = panel.plane.of(p);
  const SectionDistance& section_here = section(panel.strip);
  double sum = 0.0;
  for (std::size_t g = 0; g < kGaussAt.size(); ++g) {
    const double s = begin + kGaussAt[g] * length;
    const SectionDistance::Foot foot =
        section_here.foot(panel.level ? SectionPoint{s, plane} : SectionPoint{plane, s});
    sum += kGaussWeight[g] * foot.e * foot.e * steepness(panel.strip, foot.t);
  }
  return width(panel.strip) * length * sum;
}

PanelError::Jet PanelError::jet(const Panel& panel, const std::vector<double>& p) const {
  const double begin = panel.begin.of(p), length = panel.end.of(p) - begin;
  const double plane = panel.plane.of(p);
  const SectionDistance& section_here = section(panel.strip);
  // Sums over Gauss's points, times their weights, of f = q e^2 and of its derivatives along the
  // panel (s) and across it (c), each with (1 - xi) for the begin and xi for the end.
  double f = 0.0, c = 0.0, cc = 0.0;
  double s_begin = 0.0, s_end = 0.0, ss_bb = 0.0, ss_be = 0.0, ss_ee = 0.0;
  double sc_begin = 0.0, sc_end = 0.0;
  for (std::size_t g = 0; g < kGaussAt.size(); ++g) {
    const double xi = kGaussAt[g], s = begin + xi * length;
    const SectionDistance::Foot foot =
        section_here.foot(panel.level ? SectionPoint{s, plane} : SectionPoint{plane, s});
    const double along = panel.level ? foot.ex : foot.ez;
    const double across = panel.level ? foot.ez : foot.ex;
    const double q = kGaussWeight[g] * steepness(panel.strip, foot.t);
    const double fs = 2.0 * q * foot.e * along, fss = 2.0 * q * along * along;
    const double fsc = 2.0 * q * along * across;
    f += q * foot.e * foot.e;
    c += 2.0 * q * foot.e * across, cc += 2.0 * q * across * across;
    s_begin += (1.0 - xi) * fs, s_end += xi * fs;
    ss_bb += (1.0 - xi) * (1.0 - xi) * fss, ss_be += xi * (1.0 - xi) * fss, ss_ee += xi * xi * fss;
    sc_begin += (1.0 - xi) * fsc, sc_end += xi * fsc;
  }
  const double w = width(panel.strip);
  Jet out;
  out.value = w * length * f;
  out.first = {w * (length * s_begin - f), w * (length * s_end + f), w * length * c};
  out.second = {w * (length * ss_bb - 2.0 * s_begin),
                w * (length * ss_be + s_begin - s_end),
                w * (length * sc_begin - c),
                w * (length * ss_ee + 2.0 * s_end),
                w * (length * sc_end + c),
                w * length * cc};
  return out;
}

}  // namespace popcut
