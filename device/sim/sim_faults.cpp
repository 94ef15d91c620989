// SPDX-License-Identifier: MIT
#include "device/sim/sim_faults.hpp"

#include <array>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Kind = SimFault::Kind;

constexpr std::array<std::string_view, 11> kKinds{"unplug",  "short write", "nak",     "silence",
                                                  "garbage", "pause",       "cancel",  "media out",
                                                  "stall",   "wrong name",  "no marks"};
constexpr std::size_t kMostFaults = 1000;
constexpr double kFarthest = 1e9;  // bytes or paths
constexpr double kLongestS = 1e6;
constexpr std::size_t kLongestText = 4096;

bool has_text(Kind kind) { return kind == Kind::Garbage || kind == Kind::WrongName; }

Result<SimFault> fault_from(const nlohmann::json& json, const std::string& pointer) {
  if (!json.is_object())
    return fail(ErrorKind::OutOfRange, pointer,
                "must be an object such as {\"at_byte\": 800, \"kind\": \"stall\"}");
  FieldReader fields(json, pointer);
  SimFault fault;
  if (!fields.has("kind"))
    fields.refuse("kind", ErrorKind::OutOfRange,
                  fmt::format("is missing; must be one of {}", fmt::join(kKinds, ", ")));
  const std::vector<std::string> kinds(kKinds.begin(), kKinds.end());
  fault.kind = static_cast<Kind>(fields.word("kind", 0, kinds));
  const bool path = fields.has("at_path");
  if (path && fields.has("at_byte"))
    fields.refuse("at_path", ErrorKind::OutOfRange, "contradicts at_byte; give one of them");
  if (path)
    fault.at_path = static_cast<std::uint64_t>(fields.number("at_path", 1, 1, kFarthest));
  else
    fault.at_byte = static_cast<std::uint64_t>(fields.number("at_byte", 0, 0, kFarthest));
  fault.seconds = fields.number("seconds", 0, 0, kLongestS);
  if (has_text(fault.kind)) {
    fault.text = fields.text("text", std::nullopt);
    if (fault.text.size() > kLongestText)
      fields.refuse(
          "text", ErrorKind::OutOfRange,
          fmt::format("has {} bytes; must have at most {}", fault.text.size(), kLongestText));
  }
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return fault;
}

Result<std::vector<SimFault>> by_chance(const nlohmann::json& json) {
  if (!json.is_object())
    return fail(ErrorKind::OutOfRange, "/random",
                "must be an object such as {\"seed\": 7, \"count\": 2, \"bytes\": 9000}");
  FieldReader fields(json, "/random");
  const int seed = fields.integer("seed", std::nullopt, 0, 2147483647);
  const int count = fields.integer("count", 1, 1, static_cast<int>(kMostFaults));
  const double bytes = fields.number("bytes", std::nullopt, 1, kFarthest);
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return random_faults(static_cast<std::uint32_t>(seed), static_cast<std::size_t>(count),
                       static_cast<std::uint64_t>(bytes));
}

}  // namespace

std::string_view name_of(SimFault::Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

Result<std::vector<SimFault>> parse_faults(std::string_view text) {
  const auto json = parse_json(text);
  if (!json) return tl::unexpected(json.error());
  if (!json->is_object())
    return fail(ErrorKind::OutOfRange, "",
                "must be an object such as {\"popcut\": 1, \"faults\": []}");
  FieldReader fields(*json, "");
  fields.integer("popcut", std::nullopt, 1, 1);
  const nlohmann::json* const list = fields.value("faults");
  const nlohmann::json* const random = fields.value("random");
  if (list != nullptr && (!list->is_array() || list->size() > kMostFaults))
    fields.refuse("faults", ErrorKind::OutOfRange,
                  fmt::format("must be a list of at most {} faults", kMostFaults));
  if (list == nullptr && random == nullptr)
    fields.refuse({ErrorKind::OutOfRange, "", "has neither \"faults\" nor \"random\"; give one"});
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  std::vector<SimFault> faults;
  if (list != nullptr) {
    for (std::size_t k = 0; k < list->size(); ++k) {
      auto fault = fault_from((*list)[k], fmt::format("/faults/{}", k));
      if (!fault) return tl::unexpected(fault.error());
      faults.push_back(std::move(*fault));
    }
  }
  if (random != nullptr) {
    const auto drawn = by_chance(*random);
    if (!drawn) return drawn;
    faults.insert(faults.end(), drawn->begin(), drawn->end());
  }
  return faults;
}

std::vector<SimFault> random_faults(std::uint32_t seed, std::size_t count, std::uint64_t bytes) {
  // By remainder, not by a distribution: those differ from library to library.
  std::mt19937 random(seed);
  constexpr std::array kDrawn{Kind::Unplug,  Kind::ShortWrite, Kind::Nak,
                              Kind::Silence, Kind::Garbage,    Kind::Pause,
                              Kind::Cancel,  Kind::MediaOut,   Kind::Stall};
  constexpr std::array kWaits{0.05, 0.7, 3.0, 30.0};
  const std::array<std::string, 6> texts{"0\x03", "1\x03",   "x", std::string(300, ' '),
                                         "4",     "\x03\x03"};
  std::vector<SimFault> faults(count);
  for (SimFault& fault : faults) {
    fault.kind = kDrawn[random() % kDrawn.size()];
    fault.at_byte = random() % (bytes + 1);
    fault.seconds = kWaits[random() % kWaits.size()];
    if (fault.kind == Kind::Garbage) fault.text = texts[random() % texts.size()];
    if (random() % 4 == 0) fault.at_path = 1 + random() % (bytes / 40 + 1);
  }
  return faults;
}

}  // namespace popcut
