// SPDX-License-Identifier: MIT
#include "daemon/planning/make/drawing_question.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/text_sink.hpp"

namespace popcut::planning {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPathPoints = 4000;  // of one look

/// Lines that are asked about together.
struct AskedLines {
  std::string name, option, colour;
  double length_mm{};
  std::size_t points{};
  std::string path;

  void add(std::span<const PagePoint> line, const Box& box) {
    length_mm += length(line);
    if ((points += line.size()) > kMostPathPoints) return;
    for (std::size_t i = 0; i < line.size(); ++i) {
      path += i == 0 ? 'M' : 'L';
      append_rounded(path, line[i].x - box.x0);
      path += ' ';
      append_rounded(path, line[i].y - box.y0);
    }
  }
};

/// Which of `asked` the lines of a look belong to; none: nobody is asked about them.
AskedLines* asked_of(const DrawnLook& look, bool of_layers, std::vector<AskedLines>& asked) {
  const std::string& name = of_layers ? look.layer : look.colour;
  if (name.empty()) return nullptr;
  const auto found = std::find_if(asked.begin(), asked.end(),
                                  [&](const AskedLines& one) { return one.name == name; });
  if (found != asked.end()) return &*found;
  return &asked.emplace_back(
      AskedLines{name, of_layers ? "layers" : "colors", look.colour, 0.0, 0, {}});
}

Json listed(const std::vector<AskedLines>& lines) {
  Json list = Json::array();
  for (const AskedLines& one : lines)
    list.push_back({{"name", one.name},
                    {"option", one.option},
                    {"colour", one.colour},
                    {"length_mm", one.length_mm},
                    {"path", one.path}});
  return list;
}

}  // namespace

Result<std::string> drawing_question(std::string text, InputKind kind, SvgReadOptions how) {
  how.looks = true;
  const auto drawn = drawing_from_text(std::move(text), kind, how, 1, {});
  if (!drawn) return tl::unexpected(drawn.error());
  const LineWork& work = drawn->drawing;
  const Box box = bounds(work);
  const bool of_layers = work.asks == "layers";
  std::vector<AskedLines> asked;
  asked.reserve(kMostPens);
  std::vector<AskedLines> folds;
  folds.reserve(kMostPens);
  AskedLines others;
  for (const DrawnLine& line : work.lines) {
    const std::size_t look = line.operation.pen;
    const bool is_known = look == 0 || look > work.unsaid.size();
    const bool has_no_side = is_fold(line.operation) || line.operation == Operation::Score;
    AskedLines* const of = is_known      ? nullptr
                           : has_no_side ? asked_of(work.unsaid[look - 1], true, folds)
                                         : asked_of(work.unsaid[look - 1], of_layers, asked);
    (of != nullptr ? *of : others).add(work.points_of(line), box);
  }
  const bool no_unit = kind != InputKind::Svg &&
                       std::any_of(work.warnings.begin(), work.warnings.end(),
                                   [](const Warning& one) { return one.code == "no_unit"; });
  Json json{{"kind", name_of(kind)},
            {"size_mm", {box.empty() ? 0 : box.width(), box.empty() ? 0 : box.height()}},
            {"unit", no_unit ? "guessed" : "said"},
            {"asks", work.asks.empty() ? Json() : Json(work.asks)},
            {"looks", listed(asked)},
            {"folds", listed(folds)},
            {"path", others.path}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace popcut::planning
