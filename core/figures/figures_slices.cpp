// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/figures/figures.hpp"
#include "core/figures/slice_figures.hpp"
#include "core/plot/plot.hpp"

namespace popcut::figures {
namespace {

constexpr std::array<int, 3> kUnits{5, 9, 15};
constexpr std::array<const char*, 3> kColours{plot::kBlue, plot::kGreen, plot::kRed};

/// Whether `value` falls to its middle and rises from it, as Fig. 2C's caption says.
bool least_in_the_middle(const std::vector<double>& value) {
  for (std::size_t k = 0; k + 1 < value.size(); ++k) {
    const bool before = 2 * (k + 1) <= value.size() - 1;
    if (before && !(value[k] > value[k + 1])) return false;
    if (2 * k >= value.size() - 1 && !(value[k + 1] > value[k])) return false;
  }
  return true;
}

Result<plot::Panel> azimuthal_panel(AzimuthalConvention convention, PaperFigures& out,
                                    std::string& csv) {
  const bool corners = convention == AzimuthalConvention::OuterCorners;
  plot::Panel panel;
  panel.title = corners ? "Fig. 2C top: at the outer corners" : "Fig. 2C top: as printed";
  panel.remarks = {corners ? "corner (Xᵢ, Zᵢ₋₁) of unit i against (i − 1/2) π/2N"
                           : "vertices j = 0 … N against j π/2N: zero at both ends"};
  panel.x = {corners ? "unit i" : "vertex j", corners ? 0.5 : -0.5, 15.5, false};
  panel.y = {"Lᵩ / ⟨Lᵩ⟩", -0.1, 3.3, false};
  for (std::size_t k = 0; k < kUnits.size(); ++k) {
    const auto error = azimuthal_error(kUnits[k], convention);
    if (!error) return tl::unexpected(error.error());
    plot::Curve curve;
    curve.name = fmt::format("N = {}", kUnits[k]);
    curve.colour = kColours[k];
    curve.marks = true;
    const double mean = error->mean();
    for (std::size_t i = 0; i < error->value.size(); ++i) {
      const auto index = i + (corners ? 1 : 0);
      curve.points.push_back({static_cast<double>(index), error->value[i] / mean});
      add_row(csv, "{},{},{},{},{}\n", corners ? "outer_corner" : "as_printed", kUnits[k], index,
              error->value[i], error->value[i] / mean);
    }
    panel.curves.push_back(std::move(curve));
    if (corners) {
      const bool holds = least_in_the_middle(error->value);
      state(out, "2C top",
            fmt::format("N = {}: L_phi at the outer corners is least at i = (N + 1)/2 and grows to "
                        "both edges; its value there over the mean",
                        kUnits[k]),
            error->value[error->value.size() / 2] / mean, holds);
    } else {
      constexpr double kZero = 1e-24;
      const double ends = std::max(error->value.front(), error->value.back());
      state(out, "2C top",
            fmt::format("N = {}: L_phi as printed is zero at both ends; at most {:g}", kUnits[k],
                        kZero),
            ends, ends <= kZero);
    }
  }
  return panel;
}

Result<void> add_azimuthal(PaperFigures& out) {
  std::string csv = "convention,N,index,L_phi,L_phi_over_mean\n";
  std::array<plot::Panel, 2> panels;
  constexpr std::array kBoth{AzimuthalConvention::OuterCorners, AzimuthalConvention::Vertices};
  for (std::size_t k = 0; k < 2; ++k) {
    auto panel = azimuthal_panel(kBoth[k], out, csv);
    if (!panel) return tl::unexpected(panel.error());
    panels[k] = std::move(*panel);
  }
  out.files.push_back({"fig2c_top.svg", plot::figure_svg(panels)});
  out.files.push_back({"fig2c_top.csv", csv});
  return {};
}

Result<void> add_loss(PaperFigures& out) {
  constexpr std::array kCounts{3,   4,   5,   7,   9,   12,  16,  20,  30,  40,  50,  70,
                               100, 130, 170, 200, 250, 320, 400, 500, 640, 800, 1000};
  constexpr int kFineFrom = 100;
  plot::Curve loss{"L of the optimal chain", {}, plot::kBlue, false, true, false, 2.0};
  std::vector<double> fine_spacing, fine_loss;
  std::string csv = "N,L_over_N,loss\n";
  for (const int units : kCounts) {
    const auto value = quarter_circle_loss(units);
    if (!value) return tl::unexpected(value.error());
    const double spacing = 1.0 / units;
    loss.points.push_back({spacing, *value});
    add_row(csv, "{},{},{}\n", units, spacing, *value);
    if (units < kFineFrom) continue;
    fine_spacing.push_back(spacing);
    fine_loss.push_back(*value);
  }
  const double slope = log_log_slope(fine_spacing, fine_loss);
  state(out, "2C bottom", "log-log slope of the loss against L/N for N >= 100; 1.00 within 0.01",
        slope, std::abs(slope - 1.0) <= 0.01);
  struct Golden {
    int units;
    double loss;
  };
  constexpr std::array kGoldens{Golden{3, 0.277447270}, Golden{5, 0.127341317},
                                Golden{9, 0.058602581}, Golden{100, 0.004679531}};
  for (const Golden& golden : kGoldens) {
    const auto value = quarter_circle_loss(golden.units);
    if (!value) return tl::unexpected(value.error());
    state(out, "2C bottom",
          fmt::format("N = {}: the loss is {:.9f} within 1e-9", golden.units, golden.loss), *value,
          std::abs(*value - golden.loss) <= 1e-9);
  }
  const double limit = std::numbers::pi * std::numbers::pi / 4 - 2;
  plot::Curve line{"slope 1: (π²/4 − 2) L/N",
                   {{1e-3, limit * 1e-3}, {1.0 / 3, limit / 3}},
                   plot::kRed,
                   true,
                   false,
                   true,
                   1.6};
  plot::Panel panel;
  panel.title = "Fig. 2C bottom: loss of a quarter circle";
  panel.x = {"L/N", 8e-4, 0.5, true};
  panel.y = {"loss", 3e-4, 0.5, true};
  panel.curves = {std::move(line), std::move(loss)};
  panel.legend_left = true;
  panel.notes = {{4e-3, 1.1e-3, fmt::format("slope {:.4f} for N ≥ 100", slope), false, false}};
  panel.remarks = {"right to left: N = 3 … 1000, L = 1"};
  out.files.push_back({"fig2c_bottom.svg", plot::figure_svg(std::span(&panel, 1))});
  out.files.push_back({"fig2c_bottom.csv", csv});
  return {};
}

}  // namespace

Result<void> add_slice_figures(PaperFigures& out) {
  if (auto done = add_azimuthal(out); !done) return done;
  return add_loss(out);
}

}  // namespace popcut::figures
