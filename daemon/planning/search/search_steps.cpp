// SPDX-License-Identifier: MIT
#include "daemon/planning/search/search_steps.hpp"

#include <concepts>
#include <limits>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "daemon/model/warnings.hpp"

namespace popcut::planning {
namespace search_steps_parts {
namespace {

using nlohmann::json;

constexpr int kDepth = 9;

template <typename Of, typename Struct>
concept Is = std::same_as<std::remove_const_t<Of>, Struct>;

/// All members of a struct, in order. One that is added later does not compile before it stands
/// here: a search in steps would not know again what it has judged, and never end.
template <Is<Candidate> Of>
auto members(Of& of) {
  auto& [style, lattice, way, fill, cards, units, slices, strip_mm, pitch_mm, line_cost, hinge_mm3,
         layers, kites, usual] = of;
  return std::tie(style, lattice, way, fill, cards, units, slices, strip_mm, pitch_mm, line_cost,
                  hinge_mm3, layers, kites, usual);
}
template <Is<Judged> Of>
auto members(Of& of) {
  auto& [error, cost, made, stays] = of;
  return std::tie(error, cost, made, stays);
}
template <Is<hands::Handwork> Of>
auto members(Of& of) {
  auto& [folds, shortest_mm, waste, tabs, time_s, label] = of;
  return std::tie(folds, shortest_mm, waste, tabs, time_s, label);
}
template <Is<CuttingCost> Of>
auto members(Of& of) {
  auto& [seconds, seconds_range, cut_mm, fold_mm, hands, wobble_mm] = of;
  return std::tie(seconds, seconds_range, cut_mm, fold_mm, hands, wobble_mm);
}
template <Is<JudgedCard> Of>
auto members(Of& of) {
  auto& [rough, candidate, shrunk, judged, why, spec, cost] = of;
  return std::tie(rough, candidate, shrunk, judged, why, spec, cost);
}

template <Is<likeness::PrintedFigures> Of>
auto members(Of& of) {
  auto& [colour, contour, cover] = of;
  return std::tie(colour, contour, cover);
}
/// The figures of all views together; no caller needs those of one view.
template <Is<likeness::Figures> Of>
auto members(Of& of) {
  auto& [diagonal_mm, mean_mm, p95_mm, contour_mm, cover, excess, views] = of;
  return std::tie(diagonal_mm, mean_mm, p95_mm, contour_mm, cover, excess);
}
template <Is<CardFacts> Of>
auto members(Of& of) {
  auto& [sheet_mm, page_mm, warnings] = of;
  return std::tie(sheet_mm, page_mm, warnings);
}
/// The members that one step sends to the next. The design stays in the step that made it.
template <Is<FoundCard> Of>
auto members(Of& of) {
  auto& [candidate, spec, made, cost, figures, printed, placement, structure, shown, picture,
         facts] = of;
  return std::tie(candidate, spec, cost, figures, printed, facts);
}
template <Is<FinishedCard> Of>
auto members(Of& of) {
  auto& [candidate, cost, card, why] = of;
  return std::tie(candidate, cost, card, why);
}

template <typename Value>
concept Optional = std::same_as<Value, std::optional<typename Value::value_type>>;

/// A struct as the list of its members. Numbers keep all their digits; only an infinite one has
/// none.
template <typename Value>
json json_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return static_cast<int>(value);
  } else if constexpr (requires { members(value); }) {
    json list = json::array();
    std::apply([&](const auto&... member) { (list.push_back(json_of(member)), ...); },
               members(value));
    return list;
  } else if constexpr (Optional<Value>) {
    return value ? json_of(*value) : json();
  } else if constexpr (std::same_as<Value, std::vector<Warning>>) {
    return daemon::warnings_json(value);
  } else {
    return value;
  }
}

template <typename Value>
void take(const json& from, Value& into) {
  if constexpr (std::is_enum_v<Value>) {
    into = static_cast<Value>(from.get<int>());
  } else if constexpr (requires { members(into); }) {
    std::size_t k = 0;
    std::apply([&](auto&... member) { (take(from.at(k++), member), ...); }, members(into));
  } else if constexpr (Optional<Value>) {
    if (!from.is_null()) take(from, into.emplace());
  } else if constexpr (std::same_as<Value, std::vector<Warning>>) {
    into = daemon::warnings_from_json(from.get<std::string>());
  } else if constexpr (std::same_as<Value, double>) {
    into = from.is_null() ? std::numeric_limits<double>::infinity() : from.get<double>();
  } else {
    from.get_to(into);
  }
}

template <typename Of>
json list_of(const std::vector<Of>& all) {
  json out = json::array();
  for (const Of& one : all) out.push_back(json_of(one));
  return out;
}

json json_of(const FoundWays& of) {
  json ways = json::array();
  for (const Way& way : of.ways) ways.push_back({way.rotate_deg, way.misfit});
  return {{"ways", ways}, {"drawn", of.drawn}, {"tried", of.tried}, {"front", of.better_front}};
}

FoundWays ways_in(const json& of) {
  FoundWays out;
  for (const json& one : of.at("ways")) {
    Way way;
    one.at(0).get_to(way.rotate_deg);
    take(one.at(1), way.misfit);
    out.ways.push_back(way);
  }
  of.at("drawn").get_to(out.drawn), of.at("tried").get_to(out.tried);
  of.at("front").get_to(out.better_front);
  return out;
}

/// What `read` makes of a document; its members and their types are checked as they are taken.
template <typename Read>
auto read_with(std::string_view text, const Read& read) -> Result<decltype(read(json()))> {
  const auto document = parse_json(text, kDepth);
  if (!document) return tl::unexpected(document.error());
  try {
    return read(*document);
  } catch (const json::exception& fault) {
    return fail(ErrorKind::Malformed, "steps", fault.what());
  }
}

}  // namespace
}  // namespace search_steps_parts

using namespace search_steps_parts;

Result<SearchMemory> read_memory(std::string_view text) {
  return read_with(text, [](const json& of) {
    SearchMemory out;
    if (!of.at("ways").is_null()) out.ways = ways_in(of.at("ways"));
    for (const json& card : of.at("cards")) take(card, out.cards.emplace_back());
    for (const json& card : of.at("finished")) take(card, out.finished.emplace_back());
    for (const json& card : of.at("drawn")) take(card, out.drawn.emplace_back());
    return out;
  });
}

std::string wanted_text(const WantedCards& wanted) {
  return json_line(json{{"ways", json_of(wanted.ways)},
                        {"rough", wanted.rough},
                        {"doing", wanted.doing},
                        {"part", wanted.part},
                        {"candidates", list_of(wanted.candidates)},
                        {"finals", list_of(wanted.finals)},
                        {"drawn", wanted.drawn}});
}

Result<WantedCards> read_wanted(std::string_view text) {
  return read_with(text, [](const json& of) {
    WantedCards out;
    out.ways = ways_in(of.at("ways"));
    of.at("rough").get_to(out.rough);
    of.at("doing").get_to(out.doing);
    for (const json& one : of.at("candidates")) take(one, out.candidates.emplace_back());
    for (const json& one : of.at("finals")) take(one, out.finals.emplace_back());
    of.at("drawn").get_to(out.drawn);
    return out;
  });
}

std::string judged_text(const std::vector<JudgedCard>& cards) { return json_line(list_of(cards)); }

std::string finished_text(const std::vector<FinishedCard>& cards) {
  return json_line(list_of(cards));
}

}  // namespace popcut::planning
