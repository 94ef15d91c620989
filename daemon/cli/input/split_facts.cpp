// SPDX-License-Identifier: MIT
#include "daemon/cli/input/split_facts.hpp"

#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut::cli {
namespace {

using nlohmann::json;

// Reads lists of a plan; the first thing that is not as it should be is kept.
class Reader {
 public:
  explicit Reader(const json& plan) : plan_(plan) {}

  const json& list(const std::string& pointer) {
    static const json kNone = json::array();
    const json* found = find(pointer);
    if (found != nullptr && found->is_array()) return *found;
    fault(pointer, "give a list");
    return kNone;
  }

  std::size_t piece(const std::string& pointer) {
    const json* found = find(pointer);
    if (found != nullptr && found->is_number_unsigned() && *found >= 1)
      return found->get<std::size_t>();
    fault(pointer, "give the number of a piece");
    return 0;
  }

  std::vector<PagePoint> points(const std::string& pointer, std::size_t least) {
    std::vector<PagePoint> out;
    for (const json& point : list(pointer)) {
      if (!point.is_array() || point.size() != 2 || !point[0].is_number() ||
          !point[1].is_number()) {
        fault(pointer, "give points as [x, y] in mm");
        return std::vector<PagePoint>(least);
      }
      out.push_back({point[0].get<double>(), point[1].get<double>()});
    }
    if (out.size() < least) {
      fault(pointer, "give more points");
      out.resize(least);
    }
    return out;
  }

  Placement placement(const std::string& pointer) {
    Placement t;
    const std::pair<const char*, double*> numbers[] = {{"/0/0", &t.xx}, {"/0/1", &t.xy},
                                                       {"/0/2", &t.x0}, {"/1/0", &t.yx},
                                                       {"/1/1", &t.yy}, {"/1/2", &t.y0}};
    for (const auto& [at, value] : numbers) {
      const json* found = find(pointer + at);
      if (found != nullptr && found->is_number())
        *value = found->get<double>();
      else
        fault(pointer + at, "give a number");
    }
    return t;
  }

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  const json* find(const std::string& pointer) const {
    const json::json_pointer at(pointer);
    return plan_.contains(at) ? &plan_.at(at) : nullptr;
  }
  void fault(const std::string& pointer, const char* right) {
    if (!error_)
      error_ = Error{ErrorKind::Malformed, pointer, fmt::format("is missing or wrong; {}", right)};
  }

  const json& plan_;
  std::optional<Error> error_;
};

}  // namespace

Result<std::vector<PlannedPiece>> read_split_facts(const json& plan, const std::string& sheet) {
  Reader reader(plan);
  std::map<std::size_t, PlannedPiece> pieces;
  const std::string all = sheet + "/pieces", seams = sheet + "/seams", tabs = sheet + "/tabs";
  for (std::size_t i = 0; i < reader.list(all).size(); ++i) {
    const std::string at = fmt::format("{}/{}", all, i);
    PlannedPiece& piece = pieces[reader.piece(at + "/piece")];
    piece.to_sheet = reader.placement(at + "/transform");
    piece.share = reader.points(at + "/share", 3);
  }
  for (std::size_t i = 0; i < reader.list(seams).size(); ++i) {
    const std::string at = fmt::format("{}/{}", seams, i);
    const std::vector<PagePoint> ends = reader.points(at + "/points", 2);
    PlannedPiece::Seam seam{{ends[0], ends[1]}, {}};
    for (std::size_t k = 0; k < reader.list(at + "/glued").size(); ++k) {
      const auto glued = reader.points(fmt::format("{}/glued/{}", at, k), 2);
      seam.glued.push_back({glued[0], glued[1]});
    }
    pieces[reader.piece(at + "/piece")].seams.push_back(std::move(seam));
  }
  for (std::size_t i = 0; i < reader.list(tabs).size(); ++i) {
    const std::string at = fmt::format("{}/{}", tabs, i);
    const std::vector<PagePoint> corners = reader.points(at + "/points", 4);
    pieces[reader.piece(at + "/piece")].tabs.push_back(
        {corners[0], corners[1], corners[2], corners[3]});
  }
  if (reader.error()) return tl::unexpected(*reader.error());
  std::vector<PlannedPiece> out;
  for (auto& [number, piece] : pieces) {
    if (piece.share.empty())
      return fail(ErrorKind::Malformed, all,
                  fmt::format("has no piece {}, which has seams or tabs on this sheet", number));
    out.push_back(std::move(piece));
  }
  return out;
}

}  // namespace popcut::cli
