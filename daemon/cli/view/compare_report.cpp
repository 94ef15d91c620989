// SPDX-License-Identifier: MIT
#include "daemon/cli/view/compare_report.hpp"

#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/compare/printed_json.hpp"
#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"

namespace popcut::cli {
namespace compare_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string placed_in_words(const CompareReport& report) {
  if (report.placed_by == "file") return "as the files have it";
  const auto degrees = report.placement.degrees();
  const Vec3& shift = report.placement.shift_mm;
  const auto round = [](double value) { return std::round(value * 1e4) / 1e4 + 0.0; };
  if (report.placed_by == "spec")
    return fmt::format("as the design says, its slices {:.2f} mm along the spine", shift.y());
  std::string words = report.placed_by == "pattern"   ? "as the pattern says"
                      : report.placed_by == "options" ? "as you say"
                                                      : "where it fits best";
  words += fmt::format(": --scale {:.6g} --rotate {:g},{:g},{:g} --move {:g},{:g},{:g}",
                       report.placement.scale_mm, round(degrees[0]), round(degrees[1]),
                       round(degrees[2]), round(shift.x()), round(shift.y()), round(shift.z()));
  if (report.misfit && *report.misfit > 0.5)
    words += "\n             warning: this fits badly; give its place";
  return words;
}

std::string cost_in_words(const CutCost& cost) {
  if (!cost.ran) return "not planned: " + cost.why;
  std::string words = cost.seconds
                          ? fmt::format("{:.1f} min ({:.1f} to {:.1f})", *cost.seconds / 60.0,
                                        cost.seconds_range[0] / 60.0, cost.seconds_range[1] / 60.0)
                          : std::string("time not known");
  return words + fmt::format(
                     " on {} from {}: cuts {:.2f} m, folds {:.2f} m, travel {:.2f} m; {} "
                     "sheet{}",
                     cost.machine, cost.material, cost.cut_mm / 1e3, cost.fold_mm / 1e3,
                     cost.travel_mm / 1e3, cost.sheets, cost.sheets == 1 ? "" : "s");
}

OrderedJson volume_json(const CompareReport& report) {
  const auto error = report.volume_error();
  if (!error)
    return {{"ran", false}, {"why", report.model.ran ? report.card.why : report.model.why}};
  return {{"ran", true},
          {"error", *error},
          {"model_mm3", report.model.mm3},
          {"card_mm3", report.card.mm3}};
}

OrderedJson cost_json(const CutCost& cost) {
  if (!cost.ran) return {{"ran", false}, {"why", cost.why}};
  OrderedJson out{{"ran", true}, {"machine", cost.machine}, {"material", cost.material}};
  out["seconds"] = cost.seconds ? OrderedJson(*cost.seconds) : OrderedJson();
  out["seconds_range"] = cost.seconds ? OrderedJson(cost.seconds_range) : OrderedJson();
  out["cut_m"] = cost.cut_mm / 1e3;
  out["fold_m"] = cost.fold_mm / 1e3;
  out["travel_m"] = cost.travel_mm / 1e3;
  out["sheets"] = cost.sheets;
  return out;
}

OrderedJson view_json(const likeness::ViewFigures& view) {
  return {{"toward", {view.toward.x(), view.toward.y(), view.toward.z()}},
          {"surface_mm", view.mean_mm},
          {"surface_p95_mm", view.p95_mm},
          {"contour_mm", view.contour_mm},
          {"cover", view.cover},
          {"excess", view.excess},
          {"pixels", view.target_pixels}};
}

std::size_t parts_to_glue(const PaperFigures& paper) { return paper.pieces > 1 ? paper.pieces : 0; }

std::string line_of(const char* what, const std::string& words) {
  return fmt::format("  {:<9}  {}\n", what, words);
}

std::string printed_lines(const likeness::PrintedFigures& p) {
  return line_of("looks", fmt::format("{}, printed", likeness::name_of(likeness::looks(p)))) +
         line_of("error",
                 fmt::format("{:.4f} = colour {:.4f} + outline {:.4f} + not covered {:.4f}",
                             p.error(), p.colour, p.contour, 1.0 - p.cover));
}

}  // namespace
}  // namespace compare_report

std::optional<double> CompareReport::volume_error() const {
  if (!model.ran || !card.ran || !(model.mm3 > 0.0)) return std::nullopt;
  return std::abs(model.mm3 - card.mm3) / model.mm3;
}

std::string compare_text(const PartsReport& report) {
  using namespace compare_report;
  return fmt::format("{} against {}\n", shown_text(report.pattern), shown_text(report.target)) +
         line_of("views", fmt::format("9 {}, {} pixels wide",
                                      report.opens_flat ? "from 20 to 60 degrees above the pages"
                                                        : "about the diagonal",
                                      report.pixels)) +
         printed_lines(report.printed);
}

std::string compare_json(const PartsReport& report) {
  return json_file(nlohmann::ordered_json{{"pattern", report.pattern},
                                          {"target", report.target},
                                          {"pixels", report.pixels},
                                          {"opens_flat", report.opens_flat},
                                          {"printed", likeness::printed_json(report.printed)},
                                          {"error", report.printed.error()}});
}

std::string compare_text(const CompareReport& report) {
  using namespace compare_report;
  const likeness::Figures& f = report.figures;
  std::string out =
      fmt::format("{} against {}\n", shown_text(report.pattern), shown_text(report.target));
  const auto line = [&](const char* what, const std::string& words) {
    out += line_of(what, words);
  };
  line("model", placed_in_words(report));
  line("views",
       report.around
           ? fmt::format("{} around the spine, {} pixels wide", f.views.size(), report.pixels)
           : fmt::format("{} about the diagonal, {} pixels wide", f.views.size(), report.pixels));
  line("surface", fmt::format("{:.2f} mm off on average (95 %: {:.2f} mm) where both are seen; the "
                              "model's diagonal is {:.1f} mm",
                              f.mean_mm, f.p95_mm, f.diagonal_mm));
  line("contour", fmt::format("{:.2f} mm off on average", f.contour_mm));
  line("cover", fmt::format("{:.1f} % of the model is within {:.1f} mm (2 %); {:.1f} % more is "
                            "card where no model is",
                            100.0 * f.cover, likeness::kWithin * f.diagonal_mm, 100.0 * f.excess));
  if (const auto error = report.volume_error())
    line("volume", fmt::format("{:.1f} % off: the model has {:.1f} cm3, the card {:.1f} cm3",
                               100.0 * *error, report.model.mm3 / 1e3, report.card.mm3 / 1e3));
  else
    line("volume", "not measured: " + (report.model.ran ? report.card.why : report.model.why));
  line("cost", cost_in_words(report.cost));
  if (report.paper) {
    const std::size_t parts = parts_to_glue(*report.paper);
    line("paper", fmt::format("{} fold{}, the smallest joint {:.2f} mm; {}", report.paper->folds,
                              report.paper->folds == 1 ? "" : "s", report.paper->smallest_joint_mm,
                              parts == 0 ? std::string("nothing to glue")
                                         : fmt::format("{} parts to glue", parts)));
  }
  for (const std::string& note : report.notes) line("note", shown_text(note));
  if (report.printed) {
    return out + printed_lines(*report.printed);
  }
  line("error", fmt::format("{:.4f} = surface {:.4f} + contour {:.4f} + not covered {:.4f}",
                            f.error(), f.surface(), f.contour(), 1.0 - f.cover));
  return out;
}

std::string compare_json(const CompareReport& report) {
  using namespace compare_report;
  const likeness::Figures& f = report.figures;
  OrderedJson out{{"pattern", report.pattern}, {"target", report.target}};
  out["psi_rad"] = report.psi_rad ? OrderedJson(*report.psi_rad) : OrderedJson();
  const Vec3& shift = report.placement.shift_mm;
  out["placement"] = {{"from", report.placed_by},
                      {"scale_mm", report.placement.scale_mm},
                      {"rotate_deg", report.placement.degrees()},
                      {"translate_mm", {shift.x(), shift.y(), shift.z()}}};
  if (report.misfit) out["placement"]["misfit"] = *report.misfit;
  out["around"] = report.around;
  out["pixels"] = report.pixels;
  out["diagonal_mm"] = f.diagonal_mm;
  out["surface"] = {
      {"mean", f.surface()}, {"p95", f.surface95()}, {"mean_mm", f.mean_mm}, {"p95_mm", f.p95_mm}};
  out["contour"] = {{"mean", f.contour()}, {"mean_mm", f.contour_mm}};
  out["cover"] = f.cover;
  out["excess"] = f.excess;
  out["within_mm"] = likeness::kWithin * f.diagonal_mm;
  out["volume"] = volume_json(report);
  out["cost"] = cost_json(report.cost);
  if (report.paper) {
    out["folds"] = report.paper->folds;
    out["smallest_joint_mm"] = report.paper->smallest_joint_mm;
    out["parts_to_glue"] = parts_to_glue(*report.paper);
  }
  out["notes"] = report.notes;
  out["views"] = json_list(f.views, view_json);
  if (report.printed) out["printed"] = likeness::printed_json(*report.printed);
  out["error"] = report.error();
  return json_file(out);
}

}  // namespace popcut::cli
