// SPDX-License-Identifier: MIT
#include "core/design/slices/sliced_report.hpp"

#include <utility>

#include "core/geometry/angle.hpp"
#include "core/hands/handwork_json.hpp"
#include "core/text/json_text.hpp"
#include "core/text/warnings_json.hpp"

namespace popcut {

std::vector<std::vector<std::string>> assembly_steps(const SlicedCard& made) {
  const std::vector<std::string> names = piece_names(made);
  std::vector<std::vector<std::string>> out;
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (p == 0 || made.lattice.pieces[p].step != made.lattice.pieces[p - 1].step)
      out.emplace_back();
    out.back().push_back(names[p]);
  }
  return out;
}

std::string sliced_report_json(const SlicedCard& made, double seconds) {
  using Json = nlohmann::ordered_json;
  const Structure& card = made.card;
  const std::vector<std::string> names = piece_names(made);
  Json pieces = Json::array();
  double paper = 0.0;
  for (std::size_t p = 0; p < names.size(); ++p) {
    const SlicePiece& piece = made.lattice.pieces[p];
    const Slice& slice = made.slices[piece.slice];
    paper += area_of(piece.paper);
    pieces.push_back({{"name", names[p]},
                      {"plane", slice.family == SliceFamily::X ? "x" : "y"},
                      {"at_mm", slice.at_mm},
                      {"glued", slice.is_foot},
                      {"island", piece.is_island},
                      {"area_mm2", area_of(piece.paper)}});
  }
  return json_file(
      Json{{"name", card.name},
           {"style", "slices"},
           {"opens_deg", 180},
           {"frame_deg", degrees(made.frame_rad)},
           {"slot_mm", made.slot_mm},
           {"pieces", card.parts.size()},
           {"crossings", made.lattice.crossings.size()},
           {"folds", made.folds},
           {"tabs", made.tabs},
           {"page_mm", {card.page_mm, card.length_mm}},
           {"kept", made.lattice.paper_mm2 > 0.0 ? paper / made.lattice.paper_mm2 : 0.0},
           {"slices", std::move(pieces)},
           {"assembly", assembly_steps(made)},
           {"handwork", hands::handwork_json(made.handwork)},
           {"warnings", warnings_json(made.warnings)},
           {"seconds", seconds}});
}

}  // namespace popcut
