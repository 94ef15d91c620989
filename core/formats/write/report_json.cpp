// SPDX-License-Identifier: MIT
#include "core/formats/write/report_json.hpp"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hands/handwork_json.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

Json figures(const ErrorFigures& error) { return {{"rms", error.rms_mm}, {"max", error.max_mm}}; }

Json fit(const SliceFit& fit) {
  return {{"unreachable_share", unreachable_share(fit)},
          {"rms_mm", fit.rms_mm},
          {"max_mm", fit.max_mm}};
}

Json distances(const DistanceFigures& far) {
  return {{"mean", far.mean_mm}, {"rms", far.rms_mm}, {"p95", far.p95_mm}, {"max", far.max_mm}};
}

/// The opened structure against the target itself.
Json surface_fit(const DesignReport& report) {
  Json json{{"mode", report.fit_nearest ? "nearest" : "exact"}};
  if (!report.surface_fit) return json;
  const FitFigures& fit = *report.surface_fit;
  json["structure_to_target_mm"] = distances(fit.to_target);
  json["target_to_structure_mm"] = distances(fit.to_structure);
  json["two_sided_rms_mm"] = fit.two_sided_rms_mm();
  json["size_mm"] = fit.size_mm;
  for (std::size_t w = 0; w < FitFigures::kWithin.size(); ++w)
    json["share_within"][fmt::format("{:.0f}_percent", 100.0 * FitFigures::kWithin[w])] =
        fit.share_within[w];
  json["out_of_reach"] = {{"share", fit.out_of_reach.share()},
                          {"overhang", fit.out_of_reach.overhang},
                          {"outside_of_the_corner", fit.out_of_reach.outside_of_the_corner},
                          {"beyond_the_slices", fit.out_of_reach.beyond_the_slices}};
  json["area_mm2"] = {{"structure", fit.structure_mm2}, {"target", fit.target_mm2}};
  json["samples"] = {{"structure", fit.to_target.samples}, {"target", fit.to_structure.samples}};
  return json;
}

/// Vertices against the falling curves that the lattice was laid on.
Json inner_vertices(const DesignReport& report) {
  return {{"about",
           "distances of fold vertices from the falling curve that was fitted to their section of "
           "the target, and of that curve from the section; `fit` is what a person sees"},
          {"error_mm", figures(report.inner_error)},
          {"end_error_mm", figures(report.end_error)},
          {"gap_mm", report.gap_mm},
          {"curves", fit(report.fit)}};
}

Json slices(const DesignReport& report) {
  return json_list(report.slices, [](const SliceReport& slice) {
    Json json{{"s_mm", slice.s_mm},         {"v_mm", slice.v_mm},
              {"width_mm", slice.width_mm}, {"ends_mm", {slice.wall_mm, slice.ground_mm}},
              {"loss", slice.loss},         {"iterations", slice.iterations},
              {"minima", slice.minima},     {"spread", slice.spread},
              {"fit", fit(slice.fit)}};
    if (slice.blank) json["blank"] = true;
    return json;
  });
}

/// Of facets: strips of the same labels are one.
Json strips(const DesignReport& report) {
  return json_list(report.slices, [](const SliceReport& slice) {
    return Json{{"s_mm", slice.s_mm},
                {"v_mm", slice.v_mm},
                {"width_mm", slice.width_mm},
                {"ends_mm", {slice.wall_mm, slice.ground_mm}}};
  });
}

Json merged(const DesignReport& report) {
  return json_list(report.merged, [](const MergedPlace& place) {
    return Json{{"where", place.where},
                {"slice", place.slice},
                {"level", place.level},
                {"reason", place.reason}};
  });
}

Json curvature(const CurvatureReport& report) {
  const auto miss = [](const MissFigures& m) { return Json{{"rms", m.rms}, {"max", m.max}}; };
  Json json{{"vertices", report.vertices},
            {"loss_mm2", {{"plain", report.start_mm2}, {"augmented", report.end_mm2}}},
            {"evaluations", report.evaluations},
            {"out_of_time", report.out_of_time}};
  for (const CurvatureFigures& f : report.figures) {
    Json& to = json[f.name];
    to["unit"] = f.unit;
    const bool form = f.name == "first" || f.name == "second";
    if (!form) to["reached"] = {{"least", f.least}, {"largest", f.largest}};
    if (f.asked) to["miss"] = miss(f.miss), to["plain_miss"] = miss(f.plain_miss);
    if (f.lattice_vertices == 0) continue;
    to["lattice"] = {{"vertices", f.lattice_vertices},
                     {"least", f.lattice_least},
                     {"largest", f.lattice_largest}};
    if (f.asked) to["lattice"]["miss"] = miss(f.lattice_miss);
  }
  return json;
}

Json lattices(const DesignReport& report) {
  return json_list(report.lattices, [](const LatticeTrial& trial) {
    Json json{{"lattice", trial.lattice}};
    if (trial.laid) {
      json["to_target_mean_mm"] = trial.to_target_mean_mm;
      json["to_structure_mean_mm"] = trial.to_structure_mean_mm;
      json["two_sided_rms_mm"] = trial.two_sided_rms_mm;
    }
    if (!trial.reason.empty()) json["reason"] = trial.reason;
    return json;
  });
}

Json facets(const FacetFigures& f) {
  return {
      {"about",
       "depth: distance of the structure from the target along the direction of sight, at "
       "points where the target is seen or something stands; over_least: the distance over "
       "that of the best strips of the planes that panels may lie in, with cuts and folds free and "
       "nothing held; shifted: panels that hold others from a plane beside theirs; moves: of "
       "panels to where the target is"},
      {"depth_mm", {{"mean", f.depth_mean_mm}, {"p95", f.depth_p95_mm}}},
      {"patches", f.patches},
      {"over_least", f.over_least},
      {"planes", f.planes},
      {"loose_before_repair", f.loose_before},
      {"struts", f.struts},
      {"shifted", f.shifted},
      {"moves", f.moves},
      {"dropped", f.dropped}};
}

Json wobble(const hands::WobbleFigures& figures) {
  return {{"about",
           "how far panels move, root mean square of the farthest point, when folds lie 0.1 mm off "
           "their lines"},
          {"largest_mm", figures.largest_mm},
          {"mean_mm", figures.mean_mm},
          {"loose_panels", figures.loose},
          {"loose_share", figures.loose_share}};
}

Json report_object(const DesignReport& report) {
  Json json;
  json["name"] = report.name;
  if (report.facets) {
    json["style"] = "facets";
    json["facets"] = facets(*report.facets);
  } else {
    json["units_per_slice"] = report.units_per_slice.size() == 1
                                  ? Json(report.units_per_slice.front())
                                  : Json(report.units_per_slice);
    json["lattice"] = report.lattice;
    json["lattice_asked"] = report.lattice_asked;
  }
  if (!report.lattice_note.empty()) json["lattice_note"] = report.lattice_note;
  if (!report.lattices.empty()) json["lattices"] = lattices(report);
  if (report.design_angle_deg != 90.0) json["design_angle_deg"] = report.design_angle_deg;
  json["faces"] = report.faces;
  json["panels"] = report.panels;
  json["folds"] = report.folds;
  json["cuts"] = report.cuts;
  json["cut_length_mm"] = report.cut_length_mm;
  json["outline_length_mm"] = report.outline_length_mm;
  json["fold_length_mm"] = report.fold_length_mm;
  json["handwork"] = hands::handwork_json(report.handwork);
  if (report.wobble) json["wobble"] = wobble(*report.wobble);
  json["degrees_of_freedom"] = report.degrees_of_freedom;
  json["pieces"] = report.pieces;
  json["sheet_mm"] = {report.sheet_u_mm, report.sheet_v_mm};
  json["sticks_out_mm"] = report.sticks_out_mm;
  if (!report.facets) {
    json["inner_error_mm"] = figures(report.inner_error);
    json["end_error_mm"] = figures(report.end_error);
    json["step_over_mean"] = {{"min", report.step_over_mean_min},
                              {"max", report.step_over_mean_max}};
    json["gap_mm"] = report.gap_mm;
  }
  json["fit"] = surface_fit(report);
  if (!report.facets) json["inner_vertices"] = inner_vertices(report);
  if (report.curvature) json["curvature"] = curvature(*report.curvature);
  json["seconds"] = report.seconds;
  if (!report.facets) json["merged"] = merged(report);
  for (const BridgeReport& bridge : report.bridges)
    json["bridges"].push_back({{"slice", bridge.slice},
                               {"off_mm", bridge.off_mm},
                               {"left_planes", bridge.left_planes},
                               {"right_planes", bridge.right_planes}});
  json["notes"] = report.notes;
  json["warnings"] = messages_of(report.warnings);
  if (report.facets)
    json["strips"] = strips(report);
  else
    json["slices"] = slices(report);
  return json;
}

Json patches(const PatchAssembly& assembly) {
  return json_list(assembly.patches, [](const PatchReport& patch) {
    return Json{{"name", patch.name},
                {"part", patch.part + 1},
                {"first_slice", patch.first_slice},
                {"slices", patch.slices},
                {"v_mm", {patch.v_begin_mm, patch.v_end_mm}}};
  });
}

Json joins(const PatchAssembly& assembly) {
  return json_list(assembly.joins, [](const JoinReport& join) {
    return Json{{"patches", {join.left, join.left + 1}},
                {"join", join.is_seam ? "seam" : "sheet"},
                {"reason", join.reason},
                {"misfit_mm", join.misfit_mm},
                {"misfit_at_mm", {join.misfit_at.x, join.misfit_at.z}},
                {"v_mm", join.v_mm}};
  });
}

/// Each seam, with its line on both of its parts.
Json seams(const PatchAssembly& assembly) {
  Json list = Json::array();
  for (std::size_t p = 0; p < assembly.parts.size(); ++p)
    for (const Seam& seam : assembly.parts[p].pattern.seams) {
      if (static_cast<std::size_t>(seam.other) < p) continue;
      const auto line = [](std::size_t part, const Seam& s) {
        return Json{{"part", part + 1}, {"v_mm", s.v_mm}, {"u_mm", {s.u0_mm, s.u1_mm}}};
      };
      const auto other = static_cast<std::size_t>(seam.other);
      Json lines = Json::array({line(p, seam)});
      for (const Seam& twin : assembly.parts[other].pattern.seams)
        if (twin.id == seam.id) lines.push_back(line(other, twin));
      list.push_back({{"id", seam.id}, {"length_mm", seam.u1_mm - seam.u0_mm}, {"lines", lines}});
    }
  return list;
}

Json parts(const PatchAssembly& assembly) {
  Json list = Json::array();
  for (std::size_t p = 0; p < assembly.parts.size(); ++p) {
    const Pattern& pattern = assembly.parts[p].pattern;
    Json part{{"folder", part_folder(assembly, p)},
              {"place_mm", {pattern.place.u_mm, pattern.place.v_mm}}};
    part.update(report_object(assembly.parts[p].report));
    list.push_back(std::move(part));
  }
  return list;
}

Json book_fit(const BookFit& fit) {
  Json json{{"size_mm", fit.size_mm}};
  for (std::size_t w = 0; w < BookFit::kWithin.size(); ++w)
    json["share_within"][fmt::format("{:g}_percent", 100.0 * BookFit::kWithin[w])] =
        fit.share_within[w];
  json["target_to_structure_mm"] = distances(fit.to_structure);
  json["target_to_structure_mean_share"] = fit.to_structure.mean_mm / fit.size_mm;
  json["structure_to_target_mm"] = distances(fit.to_target);
  json["area_mm2"] = {{"structure", fit.structure_mm2}, {"target", fit.target_mm2}};
  json["samples"] = {{"structure", fit.to_target.samples}, {"target", fit.to_structure.samples}};
  return json;
}

Json book(const PatchAssembly& assembly) {
  const BookReport& report = *assembly.book;
  Json json{{"popcut_book", 1},
            {"name", assembly.name},
            {"cards", assembly.parts.size()},
            {"angle_deg", report.angle_deg},
            {"page_mm", {report.page_mm, report.width_mm}},
            {"shift_mm", report.shift_mm},
            {"closed_mm", report.closed_mm}};
  std::vector<int> freedoms;
  double cut = 0.0, fold = 0.0;
  for (const Design& card : assembly.parts) {
    freedoms.push_back(card.report.degrees_of_freedom);
    cut += card.report.cut_length_mm, fold += card.report.fold_length_mm;
  }
  json["degrees_of_freedom"] = freedoms;
  json["cut_length_mm"] = cut;
  json["fold_length_mm"] = fold;
  if (report.fit) json["fit"] = book_fit(*report.fit);
  json["glued"] = json_list(report.seams, [](const BookSeam& seam) {
    return Json{{"wall_of", seam.wall_of + 1}, {"ground_of", seam.ground_of + 1}};
  });
  json["covers"] = {{"ground_of", 1}, {"wall_of", assembly.parts.size()}};
  json["seconds"] = assembly.parts.front().report.seconds;
  json["card"] = Json::array();
  for (std::size_t p = 0; p < assembly.parts.size(); ++p) {
    Json card{{"folder", part_folder(assembly, p)}, {"plain", bool{report.is_plain[p]}}};
    card.update(report_object(assembly.parts[p].report));
    json["card"].push_back(std::move(card));
  }
  return json;
}

}  // namespace

std::string part_folder(const PatchAssembly& assembly, std::size_t part) {
  return fmt::format("{}-{:02}", assembly.book ? "card" : "part", part + 1);
}

std::string report_json(const DesignReport& report) { return json_file(report_object(report)); }

std::string report_json(const PatchAssembly& assembly) {
  if (assembly.book) return json_file(book(assembly));
  const DesignReport& first = assembly.parts.front().report;
  if (assembly.patches.empty()) return report_json(first);
  Json json;
  if (assembly.parts.size() == 1) {
    json = report_object(first);
  } else {
    json["name"] = assembly.name;
    json["sheet_mm"] = {assembly.u_mm, assembly.v_mm};
    json["parts"] = parts(assembly);
  }
  json["patches"] = patches(assembly);
  json["joins"] = joins(assembly);
  json["seams"] = seams(assembly);
  return json_file(json);
}

}  // namespace popcut
