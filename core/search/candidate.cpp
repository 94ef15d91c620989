// SPDX-License-Identifier: MIT
#include "core/search/candidate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/design/lattice_choice.hpp"
#include "core/search/draws.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

// What is drawn from, by growing value.
constexpr std::array kFills{0.7, 0.85, 1.0};
constexpr std::array kUnits{2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32};
constexpr std::array kSlices{3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48};
constexpr std::array kStrips{2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0};
constexpr std::array kPitches{1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0};
constexpr std::array kLayers{1, 2, 3, 4, 5, 6};
constexpr int kFewLayers = 3;
constexpr std::array kLineCosts{0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
constexpr std::array kHinges_mm3{0.0, 50.0, 100.0, 200.0, 400.0, 800.0, 1500.0, 3000.0};
// Where folds have a price, shorter ones are made longer: those of a medium or of an easy card.
constexpr double kMinFold_mm = 5.0, kEasyFold_mm = 8.0, kEasyHinge_mm3 = 800.0;

/// The value beside the one that is nearest to `now`, or that one itself at an end.
template <typename Values, typename Value>
Value beside(const Values& values, Value now, Draws& draws) {
  std::size_t at = 0;
  for (std::size_t k = 1; k < values.size(); ++k)
    if (std::abs(values[k] - now) < std::abs(values[at] - now)) at = k;
  if (draws.next() < 0.5) return values[at > 0 ? at - 1 : at];
  return values[std::min(at + 1, values.size() - 1)];
}

/// The first with a third, the second with a third of the rest, and so on.
std::size_t drawn_way(std::size_t ways, Draws& draws) {
  constexpr double kShare = 1.0 / 3.0;
  std::size_t way = 0;
  while (way + 1 < ways && draws.next() > kShare) ++way;
  return way;
}

/// Without what its style does not have, so that equal candidates are equal.
Candidate only_its_own(Candidate candidate) {
  const Candidate usual;
  if (candidate.style != DesignStyle::Silhouette) candidate.layers = usual.layers;
  if (candidate.style != DesignStyle::Lattice) {
    candidate.lattice = usual.lattice;
    candidate.units = usual.units, candidate.slices = usual.slices;
  }
  if (candidate.style != DesignStyle::Facets) {
    candidate.strip_mm = usual.strip_mm, candidate.pitch_mm = usual.pitch_mm;
    candidate.line_cost = usual.line_cost, candidate.hinge_mm3 = usual.hinge_mm3;
    candidate.kites = false;
  }
  return candidate;
}

/// Down to so many digits behind the point: what a short text says exactly.
double floored(double value, int digits) {
  const double unit = std::pow(10.0, std::abs(digits));
  return digits < 0 ? std::floor(value / unit) * unit : std::floor(value * unit) / unit;
}
double with_digits(double value, int digits) {
  return floored(value, digits - 1 - static_cast<int>(std::floor(std::log10(value))));
}

}  // namespace

const std::vector<StyleChoice>& style_choices() {
  static const std::vector<StyleChoice> choices = [] {
    const std::vector<LatticeMethod> all(kLatticesToTry.begin(), kLatticesToTry.end());
    std::vector<StyleChoice> out{{"any", true, all, true},
                                 {"facets", true, {}},
                                 {"silhouette", false, {}, true},
                                 {"lattice", false, all}};
    for (const LatticeMethod method : all) out.push_back({name_of(method), false, {method}});
    return out;
  }();
  return choices;
}

const StyleChoice& style_choice(std::string_view name) {
  const auto& choices = style_choices();
  return *std::find_if(choices.begin(), choices.end(),
                       [&](const StyleChoice& style) { return style.name == name; });
}

std::string_view style_name(const Candidate& candidate) {
  return candidate.style == DesignStyle::Facets       ? "facets"
         : candidate.style == DesignStyle::Silhouette ? "silhouette"
                                                      : name_of(candidate.lattice);
}

StyleChoice styles_for_cards(StyleChoice styles, int cards) {
  constexpr int kSquareCards = 4;
  if (cards != 1 && cards != kSquareCards) styles.facets = false;
  if (cards != 1) styles.silhouettes = false;
  return styles;
}

std::vector<Candidate> usual_candidates(const StyleChoice& styles, int cards) {
  std::vector<Candidate> out;
  Candidate usual;
  usual.usual = true;
  if (styles.facets) out.push_back(usual);
  usual.style = DesignStyle::Silhouette;
  if (styles.silhouettes) out.push_back(usual);
  usual.style = DesignStyle::Lattice;
  for (const LatticeMethod method : styles.lattices) {
    usual.lattice = method;
    out.push_back(usual);
  }
  usual.lattice = LatticeMethod::Auto;
  if (styles.lattices.size() > 1) out.push_back(usual);
  for (Candidate& candidate : out) candidate.cards = cards;
  return out;
}

std::vector<Candidate> broad_candidates(const StyleChoice& styles, int cards, std::size_t ways) {
  std::vector<Candidate> out;
  if (!styles.facets) return out;
  for (std::size_t way = 0; way < ways; ++way)
    for (const auto& [strip_mm, pitch_mm, hinge_mm3] :
         {std::array{5.0, 8.0, 800.0}, std::array{3.0, 8.0, 800.0}, std::array{8.0, 10.0, 3000.0},
          std::array{3.0, 8.0, 200.0}}) {
      Candidate broad;
      broad.cards = cards, broad.way = way;
      broad.strip_mm = strip_mm, broad.pitch_mm = pitch_mm, broad.hinge_mm3 = hinge_mm3;
      out.push_back(broad);
    }
  return out;
}

std::vector<Candidate> kite_candidates(const StyleChoice& styles, int cards,
                                       std::span<const Way> ways) {
  std::vector<Candidate> out;
  if (!styles.facets || cards != 1) return out;
  for (std::size_t way = 0; way < ways.size(); ++way)
    for (const auto& [strip_mm, pitch_mm, line_cost, hinge_mm3] :
         {std::array{8.0, 10.0, 4.0, 0.0}, std::array{4.0, 8.0, 1.0, 800.0},
          std::array{3.0, 8.0, 1.0, 200.0}, std::array{2.0, 10.0, 4.0, 0.0}}) {
      if (!ways[way].roof_off) continue;
      Candidate one;
      one.kites = true, one.way = way;
      one.strip_mm = strip_mm, one.pitch_mm = pitch_mm;
      one.line_cost = line_cost, one.hinge_mm3 = hinge_mm3;
      out.push_back(one);
    }
  return out;
}

std::vector<Candidate> silhouette_candidates(const StyleChoice& styles, std::size_t ways) {
  std::vector<Candidate> out;
  if (!styles.silhouettes) return out;
  for (std::size_t way = 0; way < ways; ++way)
    for (int layers = 1; layers <= kFewLayers; ++layers) {
      Candidate one;
      one.style = DesignStyle::Silhouette, one.way = way, one.layers = layers;
      out.push_back(one);
    }
  return out;
}

Candidate drawn_candidate(const StyleChoice& styles, int cards, std::size_t ways,
                          std::uint64_t seed, std::uint64_t index) {
  constexpr double kFacetShare = 0.6, kSilhouetteShare = 0.75;
  Draws draws(seed, index);
  Candidate out;
  const double style = draws.next();
  if (styles.facets && (style < kFacetShare || (styles.lattices.empty() && !styles.silhouettes)))
    out.style = DesignStyle::Facets;
  else if (styles.silhouettes && (style < kSilhouetteShare || styles.lattices.empty()))
    out.style = DesignStyle::Silhouette;
  else
    out.style = DesignStyle::Lattice;
  out.cards = cards;
  out.way = drawn_way(ways, draws);
  out.fill = draws.next_of(kFills);
  if (out.style == DesignStyle::Silhouette) {
    out.layers = draws.next_of(kLayers);
  } else if (out.style == DesignStyle::Facets) {
    out.strip_mm = draws.next_of(kStrips), out.pitch_mm = draws.next_of(kPitches);
    out.line_cost = draws.next_of(kLineCosts), out.hinge_mm3 = draws.next_of(kHinges_mm3);
  } else {
    out.lattice = draws.next_of(styles.lattices);
    out.units = draws.next_of(kUnits), out.slices = draws.next_of(kSlices);
  }
  return out;
}

Candidate changed_candidate(const Candidate& from, std::size_t ways, std::uint64_t seed,
                            std::uint64_t index) {
  Draws draws(seed, index);
  Candidate out = from;
  out.usual = false;
  const std::size_t changes = 1 + draws.next_below(2);
  for (std::size_t k = 0; k < changes; ++k) {
    const bool facets = out.style == DesignStyle::Facets;
    const double what = draws.next();
    if (what < 0.1)
      out.way = drawn_way(ways, draws);
    else if (what < 0.3)
      out.fill = beside(kFills, out.fill, draws);
    else if (out.style == DesignStyle::Silhouette)
      out.layers = beside(kLayers, out.layers, draws);
    else if (facets && what < 0.5)
      out.strip_mm = beside(kStrips, out.strip_mm, draws);
    else if (facets && what < 0.7)
      out.pitch_mm = beside(kPitches, out.pitch_mm, draws);
    else if (facets && what < 0.9)
      out.hinge_mm3 = beside(kHinges_mm3, out.hinge_mm3, draws);
    else if (facets)
      out.line_cost = beside(kLineCosts, out.line_cost, draws);
    else if (what < 0.65)
      out.units = beside(kUnits, out.units, draws);
    else
      out.slices = beside(kSlices, out.slices, draws);
  }
  return only_its_own(out);
}

double largest_scale_mm(const Way& way, const std::array<double, 2>& sheet_mm) {
  const auto fits = [&](double across, double along) {
    return std::min((across - 2.0 * kCandidateMargin_mm) / (2.0 * way.shut_reach),
                    (along - 2.0 * kCandidateMargin_mm) / way.length());
  };
  return std::max(fits(sheet_mm[0], sheet_mm[1]), fits(sheet_mm[1], sheet_mm[0]));
}

std::string spec_text(const Candidate& candidate, const Way& way, double scale_mm,
                      const CandidateModel& model) {
  scale_mm = with_digits(scale_mm, 6);
  const double length_mm = scale_mm * way.length();
  nlohmann::ordered_json spec{{"popcut", 1}, {"name", model.name}, {"material", model.material}};
  const bool facets = is_of_facets(candidate.style);
  if (facets) spec["style"] = std::string(style_name(candidate));
  spec["surface"] = {{"type", "mesh"}, {"file", model.file}};
  spec["scale_mm"] = scale_mm;
  spec["rotate_deg"] = way.rotate_deg;
  const double width_mm = floored(length_mm / candidate.slices, 4);
  if (candidate.cards > 1) {
    spec["book"] = {{"cards", candidate.cards}};  // it puts the model's middle onto the spine
  } else {
    std::array<double, 3> shift{};
    for (std::size_t i = 0; i < 3; ++i) shift[i] = -scale_mm * way.box.low[i];
    if (!facets) shift[1] -= 0.5 * (length_mm - (candidate.slices - 1) * width_mm);
    for (double& by : shift) by = std::round(by * 1e6) / 1e6 + 0.0;
    spec["translate_mm"] = shift;
  }
  if (candidate.style == DesignStyle::Silhouette) {
    spec["silhouette"] = {{"layers", candidate.layers}};
  } else if (facets) {
    const FacetSpec usual;
    spec["facets"] = {{"strip_mm", candidate.strip_mm},
                      {"pitch_mm", candidate.pitch_mm},
                      {"fold_cost_mm2", usual.fold_cost_mm2 * candidate.line_cost},
                      {"jump_cost_mm2", usual.jump_cost_mm2 * candidate.line_cost},
                      {"cut_cost_mm2", usual.cut_cost_mm2 * candidate.line_cost}};
    if (candidate.hinge_mm3 > 0.0) {
      const double size = scale_mm / way.to_target();
      spec["facets"]["hinge_cost_mm3"] = with_digits(candidate.hinge_mm3 * size * size * size, 3);
      spec["facets"]["min_fold_mm"] =
          candidate.hinge_mm3 < kEasyHinge_mm3 ? kMinFold_mm : kEasyFold_mm;
    }
    if (candidate.kites) spec["facets"]["sloped"] = "kites";
  } else {
    spec["fit"] = "nearest";
    spec["lattice"] = std::string(style_name(candidate));
    spec["units_per_slice"] = candidate.units;
    spec["slices"] = candidate.slices;
    spec["widths_mm"] = width_mm;
  }
  return json_file(spec);
}

}  // namespace popcut
