// SPDX-License-Identifier: MIT
#include "core/deploy/shut_stack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

/// A border of a panel on the shut card.
struct Event {
  double from_spine{};
  int step{};  ///< +1 where a panel begins, -1 where it ends
};

/// The piles of one strip, the worst of them kept in `worst`.
void pile_up(std::vector<Event>& events, double v, double thickness_mm, ShutStack& worst) {
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    // Ends go first: panels that only touch do not lie on each other.
    return a.from_spine != b.from_spine ? a.from_spine < b.from_spine : a.step < b.step;
  });
  int layers = 0;
  for (const Event& event : events) {
    layers += event.step;
    worst.layers = std::max(worst.layers, layers);
    if (event.step < 0 || layers <= 2 || !(event.from_spine > 0)) continue;
    const double pile = (layers - 2) * thickness_mm;
    const double angle = pile / event.from_spine;
    if (angle <= worst.stays_open_rad) continue;
    worst.stays_open_rad = angle;
    worst.pile_mm = pile;
    worst.from_spine_mm = event.from_spine;
    worst.v_mm = v;
  }
}

}  // namespace

ShutStack shut_stack(const Strips& strips, double thickness_mm) {
  ShutStack worst;
  worst.smallest_panel_mm = std::numeric_limits<double>::infinity();
  std::vector<Event> events;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    events.clear();
    for (std::size_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
      if (strips.is_cut(p)) continue;
      const std::size_t q = p + s;
      const double from = strips.x[q] + strips.z[q], to = strips.x[q + 1] + strips.z[q + 1];
      events.push_back({std::min(from, to), 1});
      events.push_back({std::max(from, to), -1});
      worst.smallest_panel_mm = std::min(worst.smallest_panel_mm, std::abs(to - from));
    }
    pile_up(events, 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]), thickness_mm, worst);
  }
  return worst;
}

std::optional<Warning> thickness_warning(const ShutStack& stack, double thickness_mm) {
  constexpr double kMostOpenRad = radians(5), kSmallestInThicknesses = 3 * (1 - 1e-6);
  std::string said;
  if (stack.stays_open_rad > kMostOpenRad)
    said = fmt::format(
        "when shut, {:.1f} mm of paper lie between wall and ground {:.1f} mm from "
        "the spine at v = {:.1f} mm: it stays open by {:.0f} degrees",
        stack.pile_mm, stack.from_spine_mm, stack.v_mm, degrees(stack.stays_open_rad));
  if (stack.smallest_panel_mm < kSmallestInThicknesses * thickness_mm) {
    said += fmt::format(
        "{}the smallest panel, {:.2g} mm, is too short to fold flat in paper of "
        "{:g} mm",
        said.empty() ? "" : "; ", stack.smallest_panel_mm, thickness_mm);
  }
  if (said.empty()) return std::nullopt;
  return Warning{
      .code = "too_thick",
      .message = said + "; thinner paper, fewer units or a larger min_panel_mm would help",
      .place = {.u_mm = stack.from_spine_mm, .v_mm = stack.v_mm}};
}

}  // namespace popcut
