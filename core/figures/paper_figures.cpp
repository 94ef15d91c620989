// SPDX-License-Identifier: MIT
#include "core/figures/paper_figures.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/figures/figures.hpp"

namespace popcut {

bool PaperFigures::all_hold() const {
  return std::all_of(statements.begin(), statements.end(),
                     [](const CheckedStatement& s) { return s.holds; });
}

Result<PaperFigures> paper_figures() {
  PaperFigures out;
  for (const auto add :
       {figures::add_assembly_figures, figures::add_slice_figures, figures::add_splay_figures}) {
    if (auto done = add(out); !done) return tl::unexpected(done.error());
  }
  return out;
}

std::string figures_json(const PaperFigures& figures) {
  nlohmann::ordered_json json;
  json["all_hold"] = figures.all_hold();
  json["statements"] = nlohmann::ordered_json::array();
  for (const CheckedStatement& s : figures.statements)
    json["statements"].push_back(
        {{"figure", s.figure}, {"claim", s.claim}, {"value", s.value}, {"holds", s.holds}});
  json["files"] = nlohmann::ordered_json::array();
  for (const FigureFile& file : figures.files) json["files"].push_back(file.name);
  return json.dump(2) + "\n";
}

}  // namespace popcut
