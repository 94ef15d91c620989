// SPDX-License-Identifier: MIT
#include "daemon/planning/search/search_steps.hpp"

#include <concepts>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::planning {
namespace search_steps_parts {
namespace {

using nlohmann::json;

constexpr int kDepth = 8;

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
  } else if constexpr (std::same_as<Value, double>) {
    into = from.is_null() ? std::numeric_limits<double>::infinity() : from.get<double>();
  } else {
    from.get_to(into);
  }
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
    return out;
  });
}

std::string wanted_text(const WantedCards& wanted) {
  json candidates = json::array();
  for (const Candidate& one : wanted.candidates) candidates.push_back(json_of(one));
  return json_line(json{{"ways", json_of(wanted.ways)},
                        {"rough", wanted.rough},
                        {"doing", wanted.doing},
                        {"part", wanted.part},
                        {"candidates", candidates}});
}

Result<WantedCards> read_wanted(std::string_view text) {
  return read_with(text, [](const json& of) {
    WantedCards out;
    out.ways = ways_in(of.at("ways"));
    of.at("rough").get_to(out.rough);
    for (const json& one : of.at("candidates")) take(one, out.candidates.emplace_back());
    return out;
  });
}

std::string judged_text(const std::vector<JudgedCard>& cards) {
  json out = json::array();
  for (const JudgedCard& one : cards) out.push_back(json_of(one));
  return json_line(out);
}

}  // namespace popcut::planning
