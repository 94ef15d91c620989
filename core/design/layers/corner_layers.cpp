// SPDX-License-Identifier: MIT
#include "core/design/layers/corner_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace popcut {
namespace {

std::size_t cells_of(const LayerGrid& grid, double mm) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(mm / grid.cell_mm)));
}

double right_of_middle(const LayerGrid& grid, std::size_t column) {
  return (static_cast<double>(column) - 0.5 * static_cast<double>(grid.columns)) * grid.cell_mm;
}

/// What moves layers and struts: the layers' places first, then the struts'.
PartPoses corner_pose(const std::vector<CornerLayer>& layers, double middle_mm,
                      const std::vector<std::size_t>& faces, const SeatFrame& frame) {
  const Vec3 ground = frame.out(1.0), wall = frame.out(-1.0), along{0.0, 1.0, 0.0};
  PartPoses out;
  for (std::size_t j = 0; j < layers.size(); ++j) {
    const Vec3 foot = layers[j].out_mm * ground + middle_mm * along;
    out.emplace_back(faces[j], laid({Vec2{0.0, 0.0}, Vec2{1.0, 0.0}, Vec2{0.0, 1.0}},
                                    {foot, foot + along, foot + wall}));
  }
  for (std::size_t j = 0; j < layers.size(); ++j) {
    const double behind = j + 1 < layers.size() ? layers[j + 1].out_mm : 0.0;
    const Vec3 rear = behind * ground + layers[j].strut.height_mm * wall + middle_mm * along;
    out.push_back({laid({Vec2{0.0, 0.0}, Vec2{0.0, 1.0}, Vec2{1.0, 0.0}},
                        {rear, rear + along, rear + ground})});
  }
  return out;
}

}  // namespace

std::optional<LayerStrut> strut_behind(const LayerGrid& grid, const LayerMask& mask,
                                       double least_mm, double most_mm, double deep_mm,
                                       double margin_mm) {
  // How far a layer leans falls with the height of its strut; wider ones hold it a little better.
  constexpr double kHighest = 0.65, kWide_mm = 12.0;
  const std::size_t above = cells_of(grid, margin_mm), deep = cells_of(grid, deep_mm + margin_mm);
  std::size_t high = 0;
  for (std::size_t k = 0; k < mask.size(); ++k)
    if (mask[k] != 0) high = std::max(high, k / grid.columns + 1);
  std::vector<std::size_t> below(grid.columns, 0);  // paper without a gap, down from the row
  std::optional<LayerStrut> best;
  double most = 0.0;
  for (std::size_t top = 0; top < high; ++top) {
    for (std::size_t c = 0; c < grid.columns; ++c)
      below[c] = mask[grid.at(c, top)] != 0 ? below[c] + 1 : 0;
    if (top + 1 < above + deep) continue;
    const double height = static_cast<double>(top + 1 - above) * grid.cell_mm;
    const double share = height / (static_cast<double>(high) * grid.cell_mm);
    for (std::size_t c = 0; c < grid.columns;) {
      const std::size_t begin = c;
      while (c < grid.columns && below[c] >= above + deep) ++c;
      const double from = right_of_middle(grid, begin) + margin_mm,
                   to = right_of_middle(grid, c) - margin_mm;
      if (c == begin) ++c;
      const double wide = std::min(to - from, most_mm);
      if (wide < least_mm) continue;
      const double worth = std::min(share, kHighest) * wide / (wide + kWide_mm);
      if (worth <= most) continue;
      // The part that is nearest to the middle.
      const double start = std::clamp(-0.5 * wide, from, to - wide);
      most = worth, best = LayerStrut{start, start + wide, height};
    }
  }
  return best;
}

void add_strut_paper(const LayerGrid& grid, const LayerStrut& strut, double deep_mm,
                     double margin_mm, LayerMask& mask) {
  const auto column = [&](double mm) {
    return static_cast<std::size_t>(
        std::clamp(mm / grid.cell_mm + 0.5 * static_cast<double>(grid.columns), 0.0,
                   static_cast<double>(grid.columns)));
  };
  const auto row = [&](double mm) {
    return static_cast<std::size_t>(
        std::clamp(mm / grid.cell_mm, 0.0, static_cast<double>(grid.rows)));
  };
  for (std::size_t r = row(strut.height_mm - deep_mm - margin_mm);
       r < row(strut.height_mm + margin_mm); ++r)
    for (std::size_t c = column(strut.from_mm - margin_mm); c < column(strut.to_mm + margin_mm);
         ++c)
      mask[grid.at(c, r)] = 1;
  while (fill_corners(grid.columns, mask)) {
  }
}

void add_corner_layers(Structure& card, const std::vector<CornerLayer>& layers) {
  const Seat seat = spine_of(card);
  const std::size_t first = card.parts.size(), count = layers.size();
  const double middle = 0.5 * card.length_mm;
  for (const CornerLayer& layer : layers) {
    SheetPart part;
    part.name = layer.name;
    for (const std::vector<Vec2>& face : layer.outlines) part.add_face(face);
    for (const Vec2& at : std::vector<Vec2>(part.vertices)) part.add_corner(at);
    card.parts.push_back(std::move(part));
  }
  for (std::size_t j = 0; j < count; ++j) {
    const LayerStrut& strut = layers[j].strut;
    const double behind = j + 1 < count ? layers[j + 1].out_mm : 0.0,
                 deep = layers[j].out_mm - behind;
    SheetPart part;
    part.name = fmt::format("{}-strut", layers[j].name);
    part.add_face(std::array{Vec2{0.0, strut.from_mm}, Vec2{deep, strut.from_mm},
                             Vec2{deep, strut.to_mm}, Vec2{0.0, strut.to_mm}});
    card.parts.push_back(std::move(part));
  }
  std::vector<std::size_t> faces;
  for (std::size_t j = 0; j < count; ++j) faces.push_back(card.parts[first + j].faces.size());
  for (std::size_t j = 0; j < count; ++j) {
    const CornerLayer& layer = layers[j];
    const LayerStrut& strut = layer.strut;
    const double behind = j + 1 < count ? layers[j + 1].out_mm : 0.0;
    add_tab(card, first + j, {Vec2{layer.foot_from_mm, 0.0}, Vec2{layer.foot_to_mm, 0.0}},
            seat.right.part, seat.right.face,
            {seat.right.at(layer.out_mm, middle + layer.foot_from_mm),
             seat.right.at(layer.out_mm, middle + layer.foot_to_mm)},
            true);
    const std::size_t own = first + count + j;
    const auto across = [&](double u) {
      return FlatLine{Vec2{u, strut.from_mm}, Vec2{u, strut.to_mm}};
    };
    const FlatLine on_layer{Vec2{strut.from_mm, strut.height_mm},
                            Vec2{strut.to_mm, strut.height_mm}};
    // Both tabs point down, so that the layer hides them.
    if (j + 1 < count)
      add_tab(card, own, across(0.0), first + j + 1, 0, on_layer, false);
    else
      add_tab(card, own, across(0.0), seat.left.part, seat.left.face,
              {seat.left.at(strut.height_mm, middle + strut.from_mm),
               seat.left.at(strut.height_mm, middle + strut.to_mm)},
              false);
    add_tab(card, own, across(layer.out_mm - behind), first + j, 0, on_layer, false);
  }
  // A strut's sheet has the middle of the spine at 0.
  const auto pose = [layers, middle, faces](const SeatFrame& frame) {
    return corner_pose(layers, middle, faces, frame);
  };
  card.elements.push_back({seat, first, 2 * count, pose});
}

}  // namespace popcut
