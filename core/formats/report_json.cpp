// SPDX-License-Identifier: MIT
#include "core/formats/report_json.hpp"

#include <nlohmann/json.hpp>

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

Json figures(const ErrorFigures& error) { return {{"rms", error.rms_mm}, {"max", error.max_mm}}; }

Json fit(const SliceFit& fit) {
  return {{"unreachable_share", unreachable_share(fit)},
          {"rms_mm", fit.rms_mm},
          {"max_mm", fit.max_mm}};
}

Json slices(const DesignReport& report) {
  Json list = Json::array();
  for (const SliceReport& slice : report.slices) {
    list.push_back({{"s_mm", slice.s_mm},
                    {"v_mm", slice.v_mm},
                    {"width_mm", slice.width_mm},
                    {"loss", slice.loss},
                    {"iterations", slice.iterations},
                    {"minima", slice.minima},
                    {"spread", slice.spread},
                    {"fit", fit(slice.fit)}});
  }
  return list;
}

Json merged(const DesignReport& report) {
  Json list = Json::array();
  for (const MergedPlace& place : report.merged) {
    list.push_back({{"where", place.where},
                    {"slice", place.slice},
                    {"level", place.level},
                    {"reason", place.reason}});
  }
  return list;
}

}  // namespace

std::string report_json(const DesignReport& report) {
  Json json;
  json["name"] = report.name;
  json["units_per_slice"] = report.units_per_slice.size() == 1
                                ? Json(report.units_per_slice.front())
                                : Json(report.units_per_slice);
  json["lattice"] = report.lattice;
  json["lattice_asked"] = report.lattice_asked;
  if (!report.lattice_note.empty()) json["lattice_note"] = report.lattice_note;
  json["faces"] = report.faces;
  json["panels"] = report.panels;
  json["folds"] = report.folds;
  json["cuts"] = report.cuts;
  json["cut_length_mm"] = report.cut_length_mm;
  json["outline_length_mm"] = report.outline_length_mm;
  json["fold_length_mm"] = report.fold_length_mm;
  json["degrees_of_freedom"] = report.degrees_of_freedom;
  json["pieces"] = report.pieces;
  json["sheet_mm"] = {report.sheet_u_mm, report.sheet_v_mm};
  json["inner_error_mm"] = figures(report.inner_error);
  json["end_error_mm"] = figures(report.end_error);
  json["step_over_mean"] = {{"min", report.step_over_mean_min}, {"max", report.step_over_mean_max}};
  json["gap_mm"] = report.gap_mm;
  json["fit"] = fit(report.fit);
  json["fit"]["mode"] = report.fit_nearest ? "nearest" : "exact";
  json["seconds"] = report.seconds;
  json["merged"] = merged(report);
  for (const BridgeReport& bridge : report.bridges)
    json["bridges"].push_back({{"slice", bridge.slice},
                               {"off_mm", bridge.off_mm},
                               {"left_planes", bridge.left_planes},
                               {"right_planes", bridge.right_planes}});
  json["notes"] = report.notes;
  json["slices"] = slices(report);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace popcut
