// SPDX-License-Identifier: MIT
#include "core/hands/hands.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut::hands {
namespace {

constexpr double kMost_s = 3600.0, kMost_mm = 1000.0;
constexpr int kMostFolds = 1'000'000;
constexpr std::size_t kMostRows = 100;

void read_fold_times(FieldReader& fields, Hands& out) {
  out.folds.clear();
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
}

void read_grades(FieldReader& fields, Hands& out) {
  out.grades.clear();
  fields.objects(
      "labels",
      [&](FieldReader& row) {
        const std::string label = row.text("label", std::nullopt);
        const int most = row.integer("most_folds", std::nullopt, 0, kMostFolds);
        out.grades.push_back({label, static_cast<std::size_t>(most),
                              row.number("shortest_mm", std::nullopt, 0.0, kMost_mm)});
      },
      kMostRows);
}

/// What the fields leave out is as in `out`; without a value there, they must have it.
void read_fields(FieldReader& fields, Hands& out, bool is_whole) {
  fields.text("source", "");
  if (is_whole || fields.has("folds")) read_fold_times(fields, out);
  if (is_whole || fields.has("labels")) read_grades(fields, out);
  const auto seconds = [&](const char* key, double& value) {
    value = fields.number(key, is_whole ? std::nullopt : std::optional(value), 0.0, kMost_s);
  };
  seconds("waste_s", out.waste_s), seconds("tab_s", out.tab_s);
}

}  // namespace

Result<Hands> read_hands(std::string_view json) {
  const auto read = parse_json(json, 16);
  if (!read) return tl::unexpected(read.error());
  FieldReader fields(*read);
  fields.integer("popcut", std::nullopt, 1, 1);
  Hands out;
  read_fields(fields, out, true);
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return out;
}

Result<Hands> hands_of(const std::vector<std::string>& user_tables) {
  Hands out = built_in_hands();
  for (std::size_t t = 0; t < user_tables.size(); ++t) {
    const auto in_table = [&](const Error& error) {
      return tl::unexpected(within(fmt::format("table {}", t + 1), error));
    };
    const auto read = parse_json(user_tables[t], 16);
    if (!read) return in_table(read.error());
    if (!read->is_object() || !read->contains("hands")) continue;
    out = built_in_hands();
    FieldReader fields((*read)["hands"], "/hands");
    read_fields(fields, out, false);
    if (auto done = fields.finish(); !done) return in_table(done.error());
  }
  return out;
}

const Hands& built_in_hands() {
  static const Hands table = read_hands(kHandsJson).value();
  return table;
}

}  // namespace popcut::hands
