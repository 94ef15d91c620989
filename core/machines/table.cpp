// SPDX-License-Identifier: MIT
#include "core/machines/table.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"
#include "core/text/near_names.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMaxRows = 10'000;
constexpr std::size_t kMaxTableBytes = 4u << 20;

TableRow* find_row(std::vector<TableRow>& rows, std::string_view name) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const TableRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

// Starts from the row that `row` is like, with the fields of `row` over it, also within its
// objects.
Result<TableRow> inherited(TableRow row, std::vector<TableRow>& rows) {
  const auto like = row.row.find("like");
  if (like == row.row.end()) return row;
  const std::string place = row.pointer + "/like";
  if (!like->is_string()) return fail(ErrorKind::Malformed, place, "must name another row");
  const std::string base_name = like->get<std::string>();
  const TableRow* base = find_row(rows, base_name);
  if (base == nullptr) {
    std::vector<std::string> names;
    names.reserve(rows.size());
    for (const TableRow& other : rows) names.push_back(other.name);
    return fail(
        ErrorKind::Malformed, place,
        fmt::format("no earlier row is called {}; {}", base_name, suggestion(base_name, names)));
  }
  nlohmann::json merged = base->row;
  merged.erase("source");
  for (const auto& field : row.row.items()) {
    if (field.key() == "like") continue;
    nlohmann::json& into = merged[field.key()];
    if (into.is_object() && field.value().is_object())
      into.update(field.value());  // "motion": {"spread": 0.4} keeps the rest of the motion
    else
      into = field.value();
  }
  row.row = std::move(merged);
  return row;
}

Result<void> append(std::vector<TableRow>& rows, std::string_view list, std::string_view text,
                    int table) {
  if (text.size() > kMaxTableBytes)
    return fail(ErrorKind::Malformed, "",
                fmt::format("has {} bytes; must have at most {}", text.size(), kMaxTableBytes));
  const auto json = parse_json(text, 16);
  if (!json) return tl::unexpected(json.error());
  FieldReader fields(*json, "");
  fields.integer("popcut", std::nullopt, 1, 1);
  fields.value("machines");
  fields.value("materials");
  fields.value("svg_profiles");
  fields.value("layer_words");
  fields.value("hands");
  if (auto known = fields.finish(); !known) return known;
  const auto found = json->find(std::string(list));
  if (found == json->end()) return {};
  const std::string pointer = "/" + std::string(list);
  if (!found->is_array()) return fail(ErrorKind::Malformed, pointer, "must be a list of rows");
  if (found->size() > kMaxRows)
    return fail(ErrorKind::Malformed, pointer,
                fmt::format("has {} rows; must have at most {}", found->size(), kMaxRows));
  for (std::size_t i = 0; i < found->size(); ++i) {
    TableRow row{"", fmt::format("{}/{}", pointer, i), table, (*found)[i]};
    FieldReader head(row.row, row.pointer);
    row.name = head.text("name", std::nullopt);
    if (row.name.empty())
      head.refuse("name", ErrorKind::Malformed, "is empty; give the row a name");
    for (const auto& field : row.row.items()) head.value(field.key());
    if (auto named = head.finish(); !named) return named;
    auto whole_row = inherited(std::move(row), rows);
    if (!whole_row) return tl::unexpected(whole_row.error());
    if (TableRow* old = find_row(rows, whole_row->name))
      *old = std::move(*whole_row);
    else
      rows.push_back(std::move(*whole_row));
  }
  return {};
}

}  // namespace

Error in_table(const TableRow& row, Error error) {
  return row.table < 0 ? error : within(fmt::format("table {}", row.table + 1), std::move(error));
}

Result<std::vector<TableRow>> table_rows(std::string_view list, std::string_view built_in,
                                         const std::vector<std::string>& user_tables) {
  std::vector<TableRow> rows;
  if (auto done = append(rows, list, built_in, -1); !done) return tl::unexpected(done.error());
  for (std::size_t t = 0; t < user_tables.size(); ++t)
    if (auto done = append(rows, list, user_tables[t], static_cast<int>(t)); !done)
      return tl::unexpected(within(fmt::format("table {}", t + 1), done.error()));
  return rows;
}

}  // namespace popcut
