// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/curvature/samples.hpp"
#include "core/figures/figures.hpp"
#include "core/figures/splay_patch.hpp"
#include "core/geometry/angle.hpp"
#include "core/plot/plot.hpp"

namespace popcut::figures {
namespace {

void add_angles(PaperFigures& out) {
  const Samples psi{0.0, 1.0, 141}, alpha{0.0, 4.0, 141};  // psi over pi
  plot::Map map;
  map.columns = psi.count;
  map.rows = alpha.count;
  std::string csv = "psi,alpha,theta\n";
  for (std::size_t row = 0; row < alpha.count; ++row) {
    for (std::size_t column = 0; column < psi.count; ++column) {
      const double angle = psi.at(column) * kPi;
      const double theta = splay_angle_rad(alpha.at(row), angle);
      map.value.push_back(theta / kPi);
      add_row(csv, "{},{},{}\n", angle, alpha.at(row), theta);
    }
  }
  double off = 0;
  for (std::size_t k = 0; k + 1 < psi.count; ++k) {
    const double angle = psi.at(k) * kPi;
    off = std::max(off, std::abs(splay_angle_rad(1 / std::cos(angle / 2), angle) - kPi / 2));
  }
  state(out, "3C", "theta = pi/2 where alpha cos(psi/2) = 1; largest difference at most 1e-12", off,
        off <= 1e-12);
  map.label = "θ/π";
  map.least = 0.0;
  map.largest = 0.9;
  map.diverging = false;
  map.contours = {0.5};
  map.thin_contours = {0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8};
  plot::Panel panel;
  panel.title = "Fig. 3C: θ(Ψ, α) of a splayed unit";
  panel.x = {"Ψ/π", 0.0, 1.0, false};
  panel.y = {"α", 0.0, 4.0, false};
  panel.map = std::move(map);
  panel.notes = {{0.56, 1.35, "θ = π/2", false, false}};
  panel.remarks = {"Ψ = π is the flat sheet; black: the tip at its highest"};
  out.files.push_back({"fig3c.svg", plot::figure_svg(std::span(&panel, 1))});
  out.files.push_back({"fig3c.csv", csv});
}

struct Case {
  const char* name;
  const char* words;
  const char* colour;
  SplayPatch patch;
};

constexpr std::array kPsi{0.16 * kPi, 0.28 * kPi, 0.47 * kPi};  // dome, developable, saddle

/// Finds the units across. On a sheet the panels must be long enough for the widest V-fold, a
/// = 1.15 w alpha, so that the pitch across depends on what is sought: repeated until it stays.
Result<double> solve_across(SplayPatch& patch) {
  constexpr double kRoom = 1.15;
  constexpr int kRounds = 200;
  double across = 2.0;
  for (int k = 0; k < kRounds; ++k) {
    if (patch.on_lattice) patch.pitch_across = kRoom * patch.w * across;
    const auto next = alpha_across_for_zero(patch, kPsi[1]);
    if (!next) return tl::unexpected(next.error());
    const bool settled = !patch.on_lattice || std::abs(*next - across) < 1e-15;
    across = *next;
    if (settled) break;
  }
  patch.alpha_across = across;
  return across;
}

void state_signs(PaperFigures& out, const Case& c) {
  const std::string of = fmt::format("alphas {:g}, {:g}, {:.12g} ({})", c.patch.alpha,
                                     c.patch.alpha_along, c.patch.alpha_across, c.words);
  const auto K = [&](double psi) { return curvature_of(c.patch, psi).K; };
  state(out, "3D", of + ": K > 0 at 0.16 pi", K(kPsi[0]), K(kPsi[0]) > 0);
  state(out, "3D", of + ": K = 0 at 0.28 pi; |K| below 1e-9", K(kPsi[1]),
        std::abs(K(kPsi[1])) < 1e-9);
  state(out, "3D", of + ": K < 0 at 0.47 pi", K(kPsi[2]), K(kPsi[2]) < 0);
}

void draw(const Case& c, plot::Panel& panel, std::string& csv) {
  plot::Curve curve{c.words, {}, c.colour, true, false, false, 2.0};
  plot::Curve marks{"", {}, c.colour, false, true, false, 2.0};
  constexpr int kSamples = 161;
  for (int k = 0; k < kSamples; ++k) {
    const double over_pi = 0.02 + 0.6 * k / (kSamples - 1);
    const double K = curvature_of(c.patch, over_pi * kPi).K;
    curve.points.push_back({over_pi, K});
    panel.y.from = std::min(panel.y.from, K);
    panel.y.to = std::max(panel.y.to, K);
    add_row(csv, "{},{},{},{},{},{}\n", c.name, c.patch.alpha, c.patch.alpha_along,
            c.patch.alpha_across, over_pi * kPi, K);
  }
  for (const double psi : kPsi) marks.points.push_back({psi / kPi, curvature_of(c.patch, psi).K});
  panel.curves.push_back(std::move(curve));
  panel.curves.push_back(std::move(marks));
}

Result<void> add_patches(PaperFigures& out) {
  SplayPatch formula;
  formula.alpha = 0.8;
  formula.alpha_along = 0.3;
  SplayPatch sheet;
  sheet.pitch_along = 2.2;
  sheet.on_lattice = true;
  sheet.alpha = 0.7;
  std::array cases{Case{"pitch_w", "pitch w both ways", plot::kBlue, formula},
                   Case{"sheet", "as it fits a sheet", plot::kRed, sheet}};
  std::string csv = "patch,alpha,alpha_along,alpha_across,psi,K\n";
  plot::Panel panel;
  panel.title = "Fig. 3D: K of a splayed patch as it opens";
  panel.x = {"Ψ/π", 0.0, 0.64, false};
  panel.y = {"K", 0.0, 0.0, false};
  for (Case& c : cases) {
    if (const auto across = solve_across(c.patch); !across) return tl::unexpected(across.error());
    state_signs(out, c);
    draw(c, panel, csv);
  }
  const double room = 0.06 * (panel.y.to - panel.y.from);
  panel.y.from -= room;
  panel.y.to += room;
  panel.curves.push_back({"", {{0.0, 0.0}, {0.64, 0.0}}, plot::kGrey, true, false, true, 1.0});
  panel.legend_left = true;
  panel.legend_bottom = true;
  panel.remarks = {"dots: Ψ = 0.16 π, 0.28 π and 0.47 π"};
  out.files.push_back({"fig3d.svg", plot::figure_svg(std::span(&panel, 1))});
  out.files.push_back({"fig3d.csv", csv});
  return {};
}

}  // namespace

Result<void> add_splay_figures(PaperFigures& out) {
  add_angles(out);
  return add_patches(out);
}

}  // namespace popcut::figures
