// SPDX-License-Identifier: MIT
#include "daemon/planning/search/search_steps.hpp"

#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::planning {
namespace search_steps_parts {
namespace {

using nlohmann::json;

constexpr int kDepth = 8;

/// Numbers keep all their digits; only an infinite one has none.
double number_in(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

json json_of(const Candidate& of) {
  return {static_cast<int>(of.style),
          static_cast<int>(of.lattice),
          of.way,
          of.fill,
          of.cards,
          of.units,
          of.slices,
          of.strip_mm,
          of.pitch_mm,
          of.line_cost,
          of.layers,
          of.kites,
          of.usual};
}

Candidate candidate_in(const json& list) {
  Candidate out;
  out.style = static_cast<DesignStyle>(list.at(0).get<int>());
  out.lattice = static_cast<LatticeMethod>(list.at(1).get<int>());
  list.at(2).get_to(out.way), list.at(3).get_to(out.fill), list.at(4).get_to(out.cards);
  list.at(5).get_to(out.units), list.at(6).get_to(out.slices), list.at(7).get_to(out.strip_mm);
  list.at(8).get_to(out.pitch_mm), list.at(9).get_to(out.line_cost);
  list.at(10).get_to(out.layers), list.at(11).get_to(out.kites), list.at(12).get_to(out.usual);
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
    way.misfit = number_in(one.at(1));
    out.ways.push_back(way);
  }
  of.at("drawn").get_to(out.drawn), of.at("tried").get_to(out.tried);
  of.at("front").get_to(out.better_front);
  return out;
}

json json_of(const JudgedCard& of) {
  const CuttingCost& cost = of.cost;
  const hands::Handwork& hands = cost.hands;
  return {{"rough", of.rough},
          {"candidate", json_of(of.candidate)},
          {"shrunk", of.shrunk},
          {"judged", {of.judged.error, of.judged.cost, of.judged.made, of.judged.stays}},
          {"why", of.why},
          {"spec", of.spec},
          {"cost", {cost.seconds, cost.seconds_range, cost.cut_mm, cost.fold_mm, cost.wobble_mm}},
          {"hands",
           {hands.folds, hands.shortest_mm, hands.waste, hands.tabs, hands.time_s, hands.label}}};
}

JudgedCard judged_in(const json& of) {
  JudgedCard out;
  of.at("rough").get_to(out.rough);
  out.candidate = candidate_in(of.at("candidate"));
  of.at("shrunk").get_to(out.shrunk);
  const json& judged = of.at("judged");
  out.judged.error = number_in(judged.at(0)), out.judged.cost = number_in(judged.at(1));
  judged.at(2).get_to(out.judged.made), judged.at(3).get_to(out.judged.stays);
  of.at("why").get_to(out.why), of.at("spec").get_to(out.spec);
  const json& cost = of.at("cost");
  out.cost.seconds = number_in(cost.at(0));
  cost.at(1).get_to(out.cost.seconds_range), cost.at(2).get_to(out.cost.cut_mm);
  cost.at(3).get_to(out.cost.fold_mm);
  out.cost.wobble_mm = number_in(cost.at(4));
  const json& hands = of.at("hands");
  hands.at(0).get_to(out.cost.hands.folds), hands.at(1).get_to(out.cost.hands.shortest_mm);
  hands.at(2).get_to(out.cost.hands.waste), hands.at(3).get_to(out.cost.hands.tabs);
  hands.at(4).get_to(out.cost.hands.time_s), hands.at(5).get_to(out.cost.hands.label);
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
    for (const json& card : of.at("cards")) out.cards.push_back(judged_in(card));
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
    for (const json& one : of.at("candidates")) out.candidates.push_back(candidate_in(one));
    return out;
  });
}

std::string judged_text(const std::vector<JudgedCard>& cards) {
  json out = json::array();
  for (const JudgedCard& one : cards) out.push_back(json_of(one));
  return json_line(out);
}

}  // namespace popcut::planning
