// SPDX-License-Identifier: MIT
#include "core/hands/hands.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut::hands {
namespace {

constexpr double kMost_s = 3600.0, kMost_mm = 1000.0;
constexpr int kMostFolds = 1'000'000;
constexpr std::size_t kMostRows = 100;

}  // namespace

Result<Hands> read_hands(std::string_view json) {
  const auto read = parse_json(json, 16);
  if (!read) return tl::unexpected(read.error());
  FieldReader fields(*read);
  fields.integer("popcut", std::nullopt, 1, 1);
  fields.text("source", "");
  Hands out;
  double before_mm = std::numeric_limits<double>::infinity();
  fields.objects(
      "folds",
      [&](FieldReader& row) {
        const double from_mm = row.number("from_mm", std::nullopt, 0.0, kMost_mm);
        if (!(from_mm < before_mm))
          row.refuse("from_mm", ErrorKind::OutOfRange, "must be less than that of the row before");
        before_mm = from_mm;
        out.folds.push_back({from_mm, row.number("fold_s", std::nullopt, 0.0, kMost_s)});
      },
      kMostRows);
  if (out.folds.empty() || out.folds.back().from_mm > 0.0)
    fields.refuse("folds", ErrorKind::OutOfRange, "must end with a row whose from_mm is 0");
  out.waste_s = fields.number("waste_s", std::nullopt, 0.0, kMost_s);
  out.tab_s = fields.number("tab_s", std::nullopt, 0.0, kMost_s);
  fields.objects(
      "labels",
      [&](FieldReader& row) {
        const std::string label = row.text("label", std::nullopt);
        const int most = row.integer("most_folds", std::nullopt, 0, kMostFolds);
        out.grades.push_back({label, static_cast<std::size_t>(most),
                              row.number("shortest_mm", std::nullopt, 0.0, kMost_mm)});
      },
      kMostRows);
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return out;
}

const Hands& built_in_hands() {
  static const Hands table = read_hands(kHandsJson).value();
  return table;
}

}  // namespace popcut::hands
