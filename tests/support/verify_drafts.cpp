// SPDX-License-Identifier: MIT
#include "tests/support/verify_drafts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <catch2/catch.hpp>

#include "core/geometry/angle.hpp"

namespace popcut::testing {
namespace {}  // namespace

VerifyReport verified(const FoldDraft& draft, const VerifyOptions& options) {
  const auto report = verify_fold(draft.text(), options);
  if (!report) FAIL("not read: " << message(report.error()));
  return *report;
}

std::string failures(const VerifyReport& report, const std::string& name) {
  std::string lines;
  for (const VerifyCheck& check : report.checks) {
    if (check.name != name) continue;
    for (const VerifyFailure& failure : check.failures)
      lines += failure.place + ": " + failure.detail + "\n";
  }
  return lines;
}

bool passes(const VerifyReport& report, const std::string& name) {
  const auto check = std::find_if(report.checks.begin(), report.checks.end(),
                                  [&](const VerifyCheck& c) { return c.name == name; });
  REQUIRE(check != report.checks.end());
  return check->ok();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t vertex_at(const FoldDraft& draft, double u, double v) {
  for (std::size_t i = 0; i < draft.flat.size(); ++i) {
    if (std::hypot(draft.flat[i][0] - u, draft.flat[i][1] - v) < 1e-9) return i;
  }
  FAIL("no vertex at " << u << ", " << v);
  return 0;
}

std::size_t edge_between(const FoldDraft& draft, std::size_t a, std::size_t b) {
  for (std::size_t e = 0; e < draft.edges.size(); ++e) {
    if (draft.edges[e] == std::array{a, b} || draft.edges[e] == std::array{b, a}) return e;
  }
  FAIL("no edge between " << a << " and " << b);
  return 0;
}

FoldDraft folded_strip(const std::vector<double>& at, const std::vector<double>& turn_deg) {
  FoldDraft draft;
  const auto valley =
      std::find_if(turn_deg.begin(), turn_deg.end(), [](double t) { return t > 0; });
  const double driving = valley == turn_deg.end() ? turn_deg.front() : *valley;
  FoldDraft::Pose pose{kPi - std::abs(driving) * kPi / 180.0, {}, {}};
  double x = 0.0;
  double z = 0.0;
  double heading = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (k > 0) {
      x += (at[k] - at[k - 1]) * std::cos(heading);
      z += (at[k] - at[k - 1]) * std::sin(heading);
    }
    for (const double v : {0.0, 10.0}) {
      draft.flat.push_back({at[k], v});
      pose.at.push_back({x, v, z});
    }
    const bool inner = k > 0 && k + 1 < at.size();
    const double turn = inner ? turn_deg[k - 1] : 0.0;
    draft.edges.push_back({2 * k, 2 * k + 1});
    draft.assignment += !inner ? 'B' : turn > 0.0 ? 'V' : 'M';
    draft.key_angle_deg.push_back(turn);
    heading += turn * kPi / 180.0;
    if (k == 0) continue;
    for (const std::size_t rim : {0, 1}) {
      draft.edges.push_back({2 * k - 2 + rim, 2 * k + rim});
      draft.assignment += 'B';
      draft.key_angle_deg.push_back(0.0);
    }
    draft.faces.push_back({2 * k - 2, 2 * k, 2 * k + 1, 2 * k - 1});
  }
  pose.angle_deg = draft.key_angle_deg;
  draft.poses.push_back(pose);
  return draft;
}

FoldDraft splayed_card(double alpha, double psi) {
  const double w = 10.0;
  const double side = 30.0;
  const double theta = 2.0 * std::atan2(alpha * std::cos(psi / 2.0), 1.0);
  FoldDraft draft;
  FoldDraft::Pose pose{psi, {}, {}};
  const auto on_card = [&](double u, double v) {
    const double along = u - side;
    draft.flat.push_back({u, v});
    pose.at.push_back(along > 0.0 ? std::array{along, v, 0.0}
                                  : std::array{-along * std::cos(psi), v, -along * std::sin(psi)});
  };
  // 0-2 near edge, 3-5 far edge, 6 O, 7 B, 8 C, 9 the crease beyond the slit, 10 A
  for (const double v : {0.0, 40.0}) {
    for (const double u : {0.0, side, 2.0 * side}) on_card(u, v);
  }
  on_card(side, 10.0);
  on_card(side - w * alpha, 10.0 + w);
  on_card(side + w * alpha, 10.0 + w);
  on_card(side, 10.0 + w);
  draft.flat.push_back({side, 10.0 + w});
  pose.at.push_back({w * std::sin(theta) * std::cos(psi / 2.0), 10.0 + w * std::cos(theta),
                     w * std::sin(theta) * std::sin(psi / 2.0)});
  const double crease = (kPi - psi) * 180.0 / kPi;
  const double flank =
      2.0 * std::atan(std::sqrt(1.0 + alpha * alpha) / std::tan(psi / 2.0)) * 180.0 / kPi;
  const auto edge = [&](std::size_t a, std::size_t b, char letter, double angle) {
    draft.edges.push_back({a, b});
    draft.assignment += letter;
    draft.key_angle_deg.push_back(angle);
  };
  for (const auto& [a, b] : {std::pair(0, 1),
                             {1, 2},
                             {2, 5},
                             {5, 4},
                             {4, 3},
                             {3, 0},
                             {7, 9},
                             {9, 8},
                             {7, 10},
                             {10, 8}}) {
    edge(static_cast<std::size_t>(a), static_cast<std::size_t>(b), 'B', 0.0);
  }
  edge(1, 6, 'V', crease);
  edge(9, 4, 'V', crease);
  edge(6, 10, 'M', -crease);
  edge(6, 7, 'V', flank);
  edge(6, 8, 'V', flank);
  draft.faces = {{0, 1, 6, 7, 9, 4, 3}, {1, 2, 5, 4, 9, 8, 6}, {6, 10, 7}, {6, 8, 10}};
  pose.angle_deg = draft.key_angle_deg;
  draft.poses.push_back(pose);
  return draft;
}

double largest_difference(const verify::FoldModel& file, const verify::Sheet& sheet,
                          const verify::Pose& opened, const verify::Pose& known) {
  const auto panels = make_panels(file, sheet);
  std::size_t largest_panel = 0;
  for (std::size_t p = 1; p < sheet.panels; ++p) {
    const auto size = [&](std::size_t q) {
      const auto [a, b, c] = panels.anchors[q];
      return norm(file.flat[b] - file.flat[a]) + norm(file.flat[c] - file.flat[a]);
    };
    if (size(p) > size(largest_panel)) largest_panel = p;
  }
  const auto from = measure(file, sheet, panels, opened).panel[largest_panel];
  const auto to = measure(file, sheet, panels, known).panel[largest_panel];
  double largest = 0.0;
  for (std::size_t i = 0; i < opened.at.size(); ++i) {
    const Vec3 p = opened.at[i] - from.origin;
    const Vec3 moved = to.origin + dot(p, from.along_u) * to.along_u +
                       dot(p, from.along_v) * to.along_v + dot(p, from.normal) * to.normal;
    largest = std::max(largest, norm(moved - known.at[i]));
  }
  return largest;
}

}  // namespace popcut::testing
