// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "core/curvature/assembly_plot.hpp"
#include "core/figures/figures.hpp"

namespace popcut::figures {
namespace {

constexpr double kPhi = std::numbers::pi / 4;
constexpr double kRoot2 = std::numbers::sqrt2;
constexpr double kExact = 1e-12;  // what "zero" and "equal" mean in the statements on the loci

/// Largest |value| on a line r(lambda), lambda from 0.2 to 3.
template <typename Line, typename Value>
double largest_on(Line r_of, Value value_of) {
  constexpr int kSamples = 2801;
  double most = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double lambda = 0.2 + 2.8 * k / (kSamples - 1);
    most = std::max(most, std::abs(value_of(Assembly{r_of(lambda), lambda, kPhi})));
  }
  return most;
}

void state_loci(PaperFigures& out) {
  const auto K = [](const Assembly& a) { return curvature_of(a).K; };
  const auto H = [](const Assembly& a) { return curvature_of(a).H; };
  const auto zero = [&](const char* figure, const char* claim, double value) {
    state(out, figure, fmt::format("{}; largest value at most {:g}", claim, kExact), value,
          value <= kExact);
  };
  const auto first = [](double lambda) { return (1 + 2 * lambda) / kRoot2; };
  const auto second = [](double) { return 3 / kRoot2; };
  const auto minimal = [](double lambda) { return (2 + lambda) / kRoot2; };
  zero("1C", "K = 0 on r = (1 + 2 lambda)/sqrt 2", largest_on(first, K));
  zero("1C", "K = 0 on r = 3/sqrt 2", largest_on(second, K));
  zero("1D", "H = 0 on r = (2 + lambda)/sqrt 2", largest_on(minimal, H));
  zero("S5", "det b/det a = 0 on r = (1 + 2 lambda)/sqrt 2",
       largest_on(first, [](const Assembly& a) { return forms_of(a).gaussian(); }));
  zero("S5", "det b/det a = 0 on r = 3/sqrt 2",
       largest_on(second, [](const Assembly& a) { return forms_of(a).gaussian(); }));
  zero("S5", "tr(a^-1 b)/2 = 0 on r = (2 + lambda)/sqrt 2",
       largest_on(minimal, [](const Assembly& a) { return forms_of(a).mean(); }));
}

void state_symmetry(PaperFigures& out) {
  constexpr int kSide = 60;
  double K_off = 0, H_off = 0;
  for (int a = 0; a < kSide; ++a) {
    for (int b = 0; b < kSide; ++b) {
      const double r = 0.05 + 4.15 * a / (kSide - 1), lambda = 0.02 + 1.96 * b / (kSide - 1);
      const VertexCurvature here = curvature_of({r, lambda, kPhi});
      const VertexCurvature there = curvature_of({3 * kRoot2 - r, 2 - lambda, kPhi});
      K_off = std::max(K_off, std::abs(here.K - there.K));
      H_off = std::max(H_off, std::abs(here.H + there.H));
    }
  }
  double phi_off = 0;
  for (int a = 0; a < kSide; ++a) {
    for (int b = 0; b < kSide; ++b) {
      const double r = 0.5 + 4.5 * a / (kSide - 1), phi = kPhi * b / (kSide - 1);
      const VertexCurvature here = curvature_of({r, 1.7, phi});
      const VertexCurvature there = curvature_of({r, 1.7, 2 * kPhi - phi});
      phi_off = std::max({phi_off, std::abs(here.K - there.K), std::abs(here.H - there.H)});
    }
  }
  state(out, "S5", "K and H at phi and pi/2 - phi are equal; largest difference at most 1e-12",
        phi_off, phi_off <= kExact);
  state(out, "1C", "K(r, lambda) = K(3 sqrt 2 - r, 2 - lambda); largest difference at most 1e-12",
        K_off, K_off <= kExact);
  state(out, "1D", "H(r, lambda) = -H(3 sqrt 2 - r, 2 - lambda); largest sum at most 1e-12", H_off,
        H_off <= kExact);
}

plot::Curve locus(double from, double to, double r0, double r1) {
  plot::Curve curve;
  curve.points = {{r0, from}, {r1, to}};
  curve.colour = "#ffd92f";
  curve.dashed = true;
  curve.width = 1.6;
  return curve;
}

std::string csv_of(const AssemblyMaps& maps, const std::vector<double>& value, const char* name) {
  std::string csv = fmt::format("r,lambda,{}\n", name);
  for (std::size_t row = 0; row < maps.lambda.count; ++row)
    for (std::size_t column = 0; column < maps.r.count; ++column)
      add_row(csv, "{},{},{}\n", maps.r.at(column), maps.lambda.at(row),
              value[row * maps.r.count + column]);
  return csv;
}

struct Minimiser {
  double target{};
  AssemblySolution found;
};

Result<std::vector<Minimiser>> minimisers(PaperFigures& out) {
  std::vector<Minimiser> list;
  for (const double target : {-1.0, 0.0, 1.0}) {
    auto found = solve_assembly({target, std::nullopt, kPhi});
    if (!found) return tl::unexpected(found.error());
    constexpr double kReached = 1e-8;
    const double off = std::abs(found->reached.K - target);
    state(out, "S5",
          fmt::format("K = {:g} is reached, at r = {:.5f}, lambda = {:.5f}; |K - K~| at most 1e-8",
                      target, found->assembly.r, found->assembly.lambda),
          off, off <= kReached);
    list.push_back({target, *found});
  }
  return list;
}

/// A number for a picture: true minus, no minus zero.
std::string shown(double value, int decimals) {
  constexpr double kNothing = 1e-12;
  std::string text = fmt::format("{:.{}f}", std::abs(value) < kNothing ? 0.0 : value, decimals);
  if (text.front() == '-') text.replace(0, 1, "−");
  return text;
}

void mark(plot::Panel& panel, const std::vector<Minimiser>& list, bool gaussian) {
  for (const Minimiser& m : list) {
    const Assembly& at = m.found.assembly;
    const std::string text =
        gaussian ? fmt::format("K = {} at ({:.3f}, {:.3f})", shown(m.target, 0), at.r, at.lambda)
                 : fmt::format("H = {} (K = {})", shown(m.found.reached.H, 3), shown(m.target, 0));
    panel.notes.push_back({at.r, at.lambda, text, true, false});
  }
}

plot::IsoPanel surfaces(bool gaussian) {
  plot::IsoPanel panel;
  panel.title = gaussian ? "Fig. S5C: K(r, λ, φ)" : "Fig. S5D: H(r, λ, φ)";
  panel.remark = "cut open at φ = π/4; the other half is its mirror image";
  panel.axis = {plot::Axis{"r", 0.5, 5.0, false}, plot::Axis{"λ", 0.2, 3.0, false},
                plot::Axis{"φ/π", 0.05, 0.25, false}};
  panel.samples = 21;
  panel.value = [gaussian](double r, double lambda, double phi_over_pi) {
    const VertexCurvature c = curvature_of({r, lambda, phi_over_pi * std::numbers::pi});
    return gaussian ? c.K : c.H;
  };
  const double beside = gaussian ? 0.6 : 0.3;
  const char* const name = gaussian ? "K" : "H";
  panel.levels = {{-beside, "#3c9d57", fmt::format("{} = −{:g}", name, beside)},
                  {0.0, "#f2d024", fmt::format("{} = 0", name)},
                  {beside, "#c7322f", fmt::format("{} = {:g}", name, beside)}};
  return panel;
}

std::string box_csv() {
  std::string csv = "r,lambda,phi,K,H\n";
  constexpr std::size_t kSide = 25;
  const Samples r{0.5, 5.0, kSide}, lambda{0.2, 3.0, kSide};
  const Samples phi{0.05 * std::numbers::pi, 0.45 * std::numbers::pi, kSide};
  for (std::size_t c = 0; c < kSide; ++c)
    for (std::size_t b = 0; b < kSide; ++b)
      for (std::size_t a = 0; a < kSide; ++a) {
        const VertexCurvature at = curvature_of({r.at(a), lambda.at(b), phi.at(c)});
        add_row(csv, "{},{},{},{},{}\n", r.at(a), lambda.at(b), phi.at(c), at.K, at.H);
      }
  return csv;
}

}  // namespace

Result<void> add_assembly_figures(PaperFigures& out) {
  state_loci(out);
  state_symmetry(out);
  const auto list = minimisers(out);
  if (!list) return tl::unexpected(list.error());
  const Samples r{0.5, 5.0, 181}, lambda{0.2, 3.0, 141};
  const AssemblyMaps maps = assembly_maps(kPhi, r, lambda);
  const auto r_first = [](double at) { return (1 + 2 * at) / kRoot2; };
  const auto r_minimal = [](double at) { return (2 + at) / kRoot2; };

  plot::Panel K = assembly_panel(maps, true, "Fig. 1C: K(r, λ) at φ = π/4");
  plot::Panel K_marked = assembly_panel(maps, true, "Fig. S5A: K and its minimisers");
  K.curves.push_back(locus(0.2, 3.0, r_first(0.2), r_first(3.0)));
  K.curves.push_back(locus(0.2, 3.0, 3 / kRoot2, 3 / kRoot2));
  K.notes = {{3.9, 0.9, "K > 0", false, false},
             {2.9, 2.75, "K < 0", false, false},
             {2.2, 0.35, "r = 3/√2", false, false},
             {3.55, 1.85, "r = (1 + 2λ)/√2", false, false}};
  K.remarks = {"black: K = 0 of the map; yellow: the published lines"};
  plot::Panel H = assembly_panel(maps, false, "Fig. 1D: H(r, λ) at φ = π/4");
  plot::Panel H_marked = assembly_panel(maps, false, "Fig. S5B: H at the minimisers");
  H.curves.push_back(locus(0.2, 3.0, r_minimal(0.2), r_minimal(3.0)));
  H.notes = {{3.9, 0.9, "H > 0", false, false},
             {0.8, 1.5, "H < 0", false, false},
             {3.35, 2.55, "r = (2 + λ)/√2", false, false}};
  H.remarks = {"black: H = 0 of the map; yellow: the published line"};
  mark(K_marked, *list, true);
  mark(H_marked, *list, false);
  K_marked.remarks = {"dots: nearest to (3/√2, 1) with the given K, as (r, λ)"};
  H_marked.remarks = {"dots: the same assemblies"};

  out.files.push_back({"fig1c.svg", plot::figure_svg(std::span(&K, 1))});
  out.files.push_back({"fig1c.csv", csv_of(maps, maps.K, "K")});
  out.files.push_back({"fig1d.svg", plot::figure_svg(std::span(&H, 1))});
  out.files.push_back({"fig1d.csv", csv_of(maps, maps.H, "H")});
  const std::array<plot::Panel, 2> marked{K_marked, H_marked};
  const std::array<plot::IsoPanel, 2> boxes{surfaces(true), surfaces(false)};
  out.files.push_back({"figS5.svg", plot::figure_svg(marked, boxes)});
  out.files.push_back({"figS5.csv", box_csv()});
  std::string points = "K_target,r,lambda,K,H\n";
  for (const Minimiser& m : *list)
    add_row(points, "{},{},{},{},{}\n", m.target, m.found.assembly.r, m.found.assembly.lambda,
            m.found.reached.K, m.found.reached.H);
  out.files.push_back({"figS5_points.csv", points});
  return {};
}

}  // namespace popcut::figures
