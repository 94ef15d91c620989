// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/text/json_text.hpp"
#include "core/verify/verify_json.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

Json distance_json(const TargetDistance& distance) {
  return {{"vertices", distance.vertices}, {"rms", distance.rms_mm}, {"max", distance.max_mm}};
}

Json check_json(const VerifyCheck& check) {
  Json failures = json_list(check.failures, [](const VerifyFailure& failure) {
    return Json{{"place", failure.place}, {"detail", failure.detail}};
  });
  return {{"name", check.name},     {"ok", check.ok()},       {"ran", check.ran},
          {"detail", check.detail}, {"failed", check.failed}, {"failures", std::move(failures)}};
}

}  // namespace

Json checks_json(const std::vector<VerifyCheck>& checks) { return json_list(checks, check_json); }

std::string verify_text(const VerifyReport& report) {
  std::string text;
  for (const VerifyCheck& check : report.checks) {
    const char* word = !check.ok() ? "FAILED" : check.ran ? "ok" : "-";
    text += fmt::format("{:<7} {:<19} {}\n", word, check.name, check.detail);
    for (const VerifyFailure& failure : check.failures)
      text += fmt::format("          {}{}{}\n", failure.place, failure.place.empty() ? "" : ": ",
                          failure.detail);
    if (check.failed > check.failures.size())
      text += fmt::format("          ... and {} more\n", check.failed - check.failures.size());
  }
  for (const std::string& note : report.notes) text += fmt::format("note    {}\n", note);
  return text;
}

Json verify_report_json(const VerifyReport& report) {
  Json json{{"ok", report.ok()},           {"pieces", report.pieces},
            {"faces", report.faces},       {"fold_faces", report.fold_faces},
            {"vertices", report.vertices}, {"edges", report.edges},
            {"hinges", report.hinges},     {"poses", report.poses},
            {"opening", nullptr}};
  if (report.opening)
    json["opening"] = {{"driver_edge", report.opening->driver_edge},
                       {"driver_length_mm", report.opening->driver_length_mm},
                       {"reached_psi_rad", report.opening->reached_psi_rad},
                       {"steps", report.opening->steps},
                       {"iterations", report.opening->iterations},
                       {"gap_mm", report.opening->gap_mm}};
  json["sheet_mm"] = {report.sheet_u_mm, report.sheet_v_mm};
  json["area_mm2"] = report.area_mm2;
  json["slits"] = report.slits;
  json["holes"] = report.holes;
  json["isometry_mm"] = report.isometry_mm;
  json["hinge_gap_mm"] = report.hinge_gap_mm;
  json["fold_angle_deg"] = report.fold_angle_deg;
  json["degrees_of_freedom"] =
      report.degrees_of_freedom ? Json(*report.degrees_of_freedom) : Json();
  json["singular_values"] = {
      {"largest_zero", report.largest_zero},
      {"smallest_nonzero", report.smallest_nonzero},
      {"gap", report.gap},
      {"psi_rad", report.pose_psi_rad > 0.0 ? Json(report.pose_psi_rad) : Json()},
      {"smallest", report.smallest_singular_values}};
  json["crossing"] = report.crossing_method;
  json["wobble"] = nullptr;
  if (report.wobble)
    json["wobble"] = {{"largest_mm", report.wobble->largest_mm},
                      {"mean_mm", report.wobble->mean_mm},
                      {"loose_panels", report.wobble->loose.size()}};
  if (report.target_inner)
    json["target"] = {{"inner_mm", distance_json(*report.target_inner)},
                      {"all_mm", distance_json(*report.target_all)}};
  json["failed"] = report.failed();
  json["checks"] = checks_json(report.checks);
  json["notes"] = report.notes;
  return json;
}

std::string verify_json(const VerifyReport& report) {
  return json_file(verify_report_json(report));
}

}  // namespace popcut
