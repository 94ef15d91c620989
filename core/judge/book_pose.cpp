// SPDX-License-Identifier: MIT
#include "core/judge/book_pose.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/compare/comparison.hpp"
#include "core/judge/card_pose.hpp"

namespace popcut::judge {
namespace {

/// A card's model placement, seen from the first card.
likeness::ModelPlacement turned_back(likeness::ModelPlacement placement, double angle_rad) {
  if (angle_rad == 0.0) return placement;
  const Eigen::Matrix3d back =
      Eigen::AngleAxisd(-angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  placement.turn = back * placement.turn;
  placement.shift_mm = Vec3(back * placement.shift_mm);
  return placement;
}

}  // namespace

void turn_about_spine(std::vector<float>& places, double angle_rad) {
  if (angle_rad == 0.0) return;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  for (std::size_t k = 0; k + 2 < places.size(); k += 3) {
    const auto x = static_cast<double>(places[k]), z = static_cast<double>(places[k + 2]);
    places[k] = static_cast<float>(c * x - s * z);
    places[k + 2] = static_cast<float>(s * x + c * z);
  }
}

Result<bool> BookPose::add(const std::string& name, std::string_view fold_text,
                           const Progress& progress) {
  auto card = open_card(fold_text, std::nullopt, progress);
  if (!card) return tl::unexpected(within(name, card.error()));
  const double touch = 1e-4 * likeness::box_of(card->triangles).diagonal();
  std::vector<float> standing = likeness::without_card(card->triangles, card->corner, touch);
  if (card->model && !model) model = turned_back(*card->model, turned_rad);
  turn_about_spine(standing, turned_rad);
  triangles.insert(triangles.end(), standing.begin(), standing.end());
  folds += card->folds;
  pieces += card->pieces;
  if (card->smallest_joint_mm > 0.0 &&
      (smallest_joint_mm == 0.0 || card->smallest_joint_mm < smallest_joint_mm))
    smallest_joint_mm = card->smallest_joint_mm;
  psi_rad = card->psi_rad;
  turned_rad += card->psi_rad;
  for (const std::string& note : card->notes) notes.push_back(fmt::format("{}: {}", name, note));
  return !standing.empty();
}

}  // namespace popcut::judge
