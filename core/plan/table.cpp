// SPDX-License-Identifier: MIT
#include "core/plan/table.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/formats/json_text.hpp"
#include "core/plan/json_fields.hpp"
#include "core/plan/near_names.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMaxRows = 10'000;

TableRow* find_row(std::vector<TableRow>& rows, std::string_view name) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const TableRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

// Starts from the row that `row` is like, with the fields of `row` over it.
Result<TableRow> inherited(TableRow row, std::vector<TableRow>& rows) {
  const auto like = row.row.find("like");
  if (like == row.row.end()) return row;
  const std::string place = json_pointer(row.pointer, "like");
  if (!like->is_string())
    return fail(ErrorKind::Malformed, place, "the name of another row is due");
  const std::string base_name = like->get<std::string>();
  const TableRow* base = find_row(rows, base_name);
  if (base == nullptr) {
    std::vector<std::string> names;
    for (const TableRow& other : rows) names.push_back(other.name);
    return fail(ErrorKind::Malformed, place,
                fmt::format("no row {} stands before this one; {}", base_name,
                            suggestion(base_name, names)));
  }
  nlohmann::json merged = base->row;
  merged.erase("source");
  for (const auto& field : row.row.items())
    if (field.key() != "like") merged[field.key()] = field.value();
  row.row = std::move(merged);
  return row;
}

Result<void> append(std::vector<TableRow>& rows, std::string_view list, std::string_view text,
                    int table) {
  auto json = parse_json(text, {.bytes = 4u << 20, .values = 200'000, .depth = 16});
  if (!json) return tl::unexpected(json.error());
  std::optional<Error> fault;
  JsonFields fields(*json, "", fault);
  long version = 1;
  fields.whole("popcut", version, 1, 1);
  fields.also("machines");
  fields.also("materials");
  fields.nothing_else();
  if (fault) return tl::unexpected(*fault);
  const auto found = json->find(std::string(list));
  if (found == json->end()) return {};
  const std::string pointer = json_pointer("", list);
  if (!found->is_array()) return fail(ErrorKind::Malformed, pointer, "an array of rows is due");
  if (found->size() > kMaxRows)
    return fail(ErrorKind::Malformed, pointer,
                fmt::format("{} rows; at most {}", found->size(), kMaxRows));
  for (std::size_t i = 0; i < found->size(); ++i) {
    TableRow row{"", fmt::format("{}/{}", pointer, i), table, (*found)[i]};
    std::string& name = row.name;
    JsonFields(row.row, row.pointer, fault).text("name", name);
    if (fault) return tl::unexpected(*fault);
    if (name.empty())
      return fail(ErrorKind::Malformed, json_pointer(row.pointer, "name"),
                  "is empty; a word is due");
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
