// SPDX-License-Identifier: MIT
#include "tests/support/fold_draft.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/geometry/angle.hpp"

namespace popcut::testing {
namespace {

constexpr int kWallFace = -1;
constexpr int kGroundFace = -2;

std::string numbers(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values)
    text += fmt::format("{}{:.17g}", text.size() > 1 ? "," : "", value);
  return text + "]";
}

template <typename Row>
std::string rows(const std::vector<Row>& values) {
  std::string text = "[";
  for (const Row& row : values) {
    text += text.size() > 1 ? ",\n" : "\n";
    std::string inner;
    for (const auto value : row) {
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
        inner += fmt::format("{}{:.17g}", inner.empty() ? "" : ",", value);
      } else {
        inner += fmt::format("{}{}", inner.empty() ? "" : ",", value);
      }
    }
    text += "[" + inner + "]";
  }
  return text + "]";
}

/// Collects the vertices and edges of a draft while strips are laid side by side.
class Draftsman {
 public:
  Draftsman(const std::vector<DraftStrip>& strips, double wall_mm)
      : strips_(strips), wall_(wall_mm) {}

  FoldDraft draw() {
    double v = 0.0;
    std::vector<std::map<double, std::size_t>> left_rim(strips_.size());   // at the strip's small v
    std::vector<std::map<double, std::size_t>> right_rim(strips_.size());  // at its large v
    for (std::size_t s = 0; s <= strips_.size(); ++s) {
      boundary(s, v, s > 0 ? &right_rim[s - 1] : nullptr,
               s < strips_.size() ? &left_rim[s] : nullptr);
      if (s < strips_.size()) v += strips_[s].width_mm;
    }
    for (std::size_t s = 0; s < strips_.size(); ++s) strip(s, left_rim[s], right_rim[s]);
    finish();
    return std::move(draft_);
  }

 private:
  [[nodiscard]] double u(std::pair<double, double> p) const { return p.first + wall_ - p.second; }

  [[nodiscard]] std::vector<double> folds(std::size_t s) const {
    std::vector<double> at;
    for (const auto& p : strips_[s].points) at.push_back(u(p));
    return at;
  }

  [[nodiscard]] int plane_at(std::size_t s, double at) const {
    const auto all = folds(s);
    for (std::size_t k = 0; k + 1 < all.size(); ++k) {
      if (at > all[k] && at < all[k + 1]) return strips_[s].plane[k];
    }
    return -100 - static_cast<int>(s);  // outside the strip: nothing is joined
  }

  std::size_t add(std::size_t s, double at, double v) {
    const auto all = folds(s);
    std::size_t k = 0;
    while (k + 2 < all.size() && at > all[k + 1]) ++k;
    const auto& [x0, z0] = strips_[s].points[k];
    const auto& [x1, z1] = strips_[s].points[k + 1];
    // Whole ends are taken as they are, so that both sides of a fold agree to the last digit.
    double x = x0 == x1 ? x0 : x0 + (at - all[k]);
    double z = z0 == z1 ? z0 : z0 - (at - all[k]);
    if (at == all[k]) x = x0, z = z0;
    if (at == all[k + 1]) x = x1, z = z1;
    draft_.flat.push_back({at, v});
    designed_.push_back({x, v, z});
    return draft_.flat.size() - 1;
  }

  void edge(std::size_t a, std::size_t b, char letter) {
    draft_.edges.push_back({a, b});
    draft_.assignment += letter;
  }

  void chain(const std::map<double, std::size_t>& rim) {
    for (auto at = rim.begin(); std::next(at) != rim.end(); ++at) {
      const auto to = std::next(at);
      if (joined_.contains({at->second, to->second})) continue;
      edge(at->second, to->second, 'B');
    }
  }

  /// The line between strip s - 1 (its `left` rim) and strip s (its `right` rim).
  void boundary(std::size_t s, double v, std::map<double, std::size_t>* left,
                std::map<double, std::size_t>* right) {
    if (left == nullptr || right == nullptr) {
      auto* rim = left == nullptr ? right : left;
      const std::size_t only = left == nullptr ? s : s - 1;
      for (const double at : folds(only)) (*rim)[at] = add(only, at, v);
      chain(*rim);
      return;
    }
    const auto left_folds = folds(s - 1);
    const auto right_folds = folds(s);
    std::set<double> all(left_folds.begin(), left_folds.end());
    all.insert(right_folds.begin(), right_folds.end());
    const std::vector<double> at(all.begin(), all.end());
    std::vector<bool> joined;  // one a stretch
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      const double middle = 0.5 * (at[k] + at[k + 1]);
      joined.push_back(plane_at(s - 1, middle) == plane_at(s, middle));
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
      const bool shared = (k > 0 && joined[k - 1]) || (k < joined.size() && joined[k]);
      if (shared) {
        (*left)[at[k]] = (*right)[at[k]] = add(s - 1, at[k], v);
        continue;
      }
      if (std::count(left_folds.begin(), left_folds.end(), at[k]) > 0)
        (*left)[at[k]] = add(s - 1, at[k], v);
      if (std::count(right_folds.begin(), right_folds.end(), at[k]) > 0)
        (*right)[at[k]] = add(s, at[k], v);
    }
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      if (!joined[k]) continue;
      const std::size_t a = left->at(at[k]);
      const std::size_t b = left->at(at[k + 1]);
      joined_.insert({a, b});
      edge(a, b, 'F');
    }
    chain(*left);
    chain(*right);
  }

  void strip(std::size_t s, const std::map<double, std::size_t>& small_v,
             const std::map<double, std::size_t>& large_v) {
    const auto at = folds(s);
    const auto& points = strips_[s].points;
    for (std::size_t k = 0; k < at.size(); ++k) {
      char letter = 'B';
      if (k > 0 && k + 1 < at.size()) letter = points[k - 1].first == points[k].first ? 'V' : 'M';
      edge(small_v.at(at[k]), large_v.at(at[k]), letter);
    }
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      std::vector<std::size_t> face;
      for (auto i = small_v.find(at[k]); i != std::next(small_v.find(at[k + 1])); ++i)
        face.push_back(i->second);
      std::vector<std::size_t> back;
      for (auto i = large_v.find(at[k]); i != std::next(large_v.find(at[k + 1])); ++i)
        back.push_back(i->second);
      face.insert(face.end(), back.rbegin(), back.rend());
      draft_.faces.push_back(std::move(face));
    }
  }

  void finish() {
    for (const double psi : {kPi, kPi / 2.0, 1.1}) {
      FoldDraft::Pose pose{psi, {}, {}};
      for (const auto& [x, v, z] : designed_) {
        pose.at.push_back({x + z * std::cos(psi), v, z * std::sin(psi)});
      }
      for (const char letter : draft_.assignment) {
        const double bend = (kPi - psi) * 180.0 / kPi;
        pose.angle_deg.push_back(letter == 'V' ? bend : letter == 'M' ? -bend : 0.0);
      }
      draft_.poses.push_back(std::move(pose));
    }
    draft_.key_angle_deg = draft_.poses[1].angle_deg;
  }

  const std::vector<DraftStrip>& strips_;
  double wall_;
  FoldDraft draft_;
  std::vector<std::array<double, 3>> designed_;
  std::set<std::pair<std::size_t, std::size_t>> joined_;
};

}  // namespace

std::string FoldDraft::text() const {
  std::string letters;
  for (const char letter : assignment)
    letters += fmt::format("{}\"{}\"", letters.empty() ? "" : ",", letter);
  std::string frames;
  for (const Pose& pose : poses) {
    frames += fmt::format(
        "{}{{\"frame_classes\":[\"foldedForm\"],\"frame_parent\":0,\"frame_inherit\":true,"
        "\"frame_popcut:psi_rad\":{:.17g},\n\"vertices_coords\":{},\n\"edges_foldAngle\":{}}}",
        frames.empty() ? "" : ",\n", pose.psi_rad, rows(pose.at), numbers(pose.angle_deg));
  }
  return fmt::format(
      "{{\"file_spec\":1.2,\"frame_classes\":[\"creasePattern\"],\"frame_unit\":\"mm\",\n"
      "\"vertices_coords\":{},\n\"edges_vertices\":{},\n\"edges_assignment\":[{}],\n"
      "{}{}\"file_frames\":[{}]}}\n",
      rows(flat), rows(edges), letters,
      key_angle_deg.empty() ? "" : "\"edges_foldAngle\":" + numbers(key_angle_deg) + ",\n",
      faces.empty() ? "" : "\"faces_vertices\":" + rows(faces) + ",\n", frames);
}

FoldDraft draft_of(const std::vector<DraftStrip>& strips, double wall_mm) {
  return Draftsman(strips, wall_mm).draw();
}

std::vector<DraftStrip> strips_of(const CylinderCard& c) {
  // Level i has the plane X_i (even ids) and the plane Z_i (odd ids); X_0 is the wall, Z_N the
  // ground.
  const int n = c.levels;
  std::vector<double> x;
  std::vector<double> z;
  for (int i = 0; i <= n; ++i) {
    const double angle = 0.5 * kPi * i / n;
    x.push_back(i == 0 ? 0.0 : c.radius_mm * std::sin(angle));
    z.push_back(i == n ? 0.0 : c.radius_mm * std::cos(angle));
  }
  const double high = c.radius_mm + c.margin_mm;
  const auto staircase = [&](double width, auto has_x, auto has_z) {
    std::vector<int> planes;
    if (c.card) planes.push_back(kWallFace);
    for (int i = 0; i <= n; ++i) {
      if (has_x(i) && !(c.card && i == 0)) planes.push_back(2 * i);
      if (has_z(i) && !(c.card && i == n)) planes.push_back(2 * i + 1);
    }
    if (c.card) planes.push_back(kGroundFace);
    const auto is_x = [](int plane) {
      return plane == kWallFace || (plane >= 0 && plane % 2 == 0);
    };
    const auto place = [&](int plane) {
      if (plane == kWallFace || plane == kGroundFace) return 0.0;
      const auto level = static_cast<std::size_t>(plane / 2);
      return plane % 2 == 0 ? x[level] : z[level];
    };
    DraftStrip strip{width, {}, planes};
    strip.points.emplace_back(0.0, c.card ? high : z[0]);
    for (std::size_t k = 0; k + 1 < planes.size(); ++k) {
      const bool first_is_x = is_x(planes[k]);
      strip.points.emplace_back(place(first_is_x ? planes[k] : planes[k + 1]),
                                place(first_is_x ? planes[k + 1] : planes[k]));
    }
    strip.points.emplace_back(c.card ? high : x.back(), 0.0);
    return strip;
  };

  std::vector<DraftStrip> strips;
  const DraftStrip margin{
      c.margin_mm, {{0.0, high}, {0.0, 0.0}, {high, 0.0}}, {kWallFace, kGroundFace}};
  if (c.card) strips.push_back(margin);
  for (int j = 0; j < c.slices; ++j) {
    const int p = j % 2;
    strips.push_back(staircase(
        0.5 * c.width_mm, [&](int i) { return i % 2 != p; }, [&](int i) { return i % 2 == p; }));
    if (j + 1 == c.slices) break;
    strips.push_back(staircase(
        0.5 * c.width_mm, [&](int i) { return i > 0; }, [&](int i) { return i < n; }));
  }
  if (c.card) strips.push_back(margin);
  return strips;
}

FoldDraft draft_of(const CylinderCard& c) {
  return draft_of(strips_of(c), c.card ? c.radius_mm + c.margin_mm : c.radius_mm);
}

FoldDraft box_card() {
  const DraftStrip margin{10.0, {{0.0, 40.0}, {0.0, 0.0}, {40.0, 0.0}}, {kWallFace, kGroundFace}};
  const DraftStrip box{30.0,
                       {{0.0, 40.0}, {0.0, 20.0}, {25.0, 20.0}, {25.0, 0.0}, {40.0, 0.0}},
                       {kWallFace, 1, 2, kGroundFace}};
  return draft_of({margin, box, margin}, 40.0);
}

}  // namespace popcut::testing
