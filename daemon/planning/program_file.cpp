// SPDX-License-Identifier: MIT
#include "daemon/planning/program_file.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"
#include "daemon/digest/digest.hpp"

namespace popcut::planning {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::uint64_t> ends_of(const std::vector<ByteRange>& blocks) {
  std::vector<std::uint64_t> ends;
  ends.reserve(blocks.size());
  for (const ByteRange& block : blocks) ends.push_back(block.end);
  return ends;
}

/// Reads a list of whole numbers; each is at least the one before, from `low` to `high`.
Result<std::vector<std::uint64_t>> rising(FieldReader& fields, const char* key, std::uint64_t low,
                                          std::uint64_t high) {
  const nlohmann::json* list = fields.value(key);
  const std::string place = fields.pointer(key);
  if (list == nullptr || !list->is_array())
    return fail(ErrorKind::Malformed, place, "must be a list of whole numbers");
  std::vector<std::uint64_t> values;
  values.reserve(list->size());
  for (const nlohmann::json& value : *list) {
    const std::string at = fmt::format("{}/{}", place, values.size());
    if (!value.is_number_unsigned())
      return fail(ErrorKind::Malformed, at, "must be a whole number");
    const auto number = value.get<std::uint64_t>();
    const std::uint64_t least = values.empty() ? low : values.back();
    if (number < least || number > high)
      return fail(ErrorKind::OutOfRange, at,
                  fmt::format("is {}; must be {} to {}", number, least, high));
    values.push_back(number);
  }
  return values;
}

std::vector<ByteRange> blocks_from(std::uint64_t begin, const std::vector<std::uint64_t>& ends) {
  std::vector<ByteRange> blocks;
  blocks.reserve(ends.size());
  for (const std::uint64_t end : ends) {
    blocks.push_back({begin, end});
    begin = end;
  }
  return blocks;
}

Result<void> read_blocks(FieldReader& fields, EncodedProgram& program) {
  const std::uint64_t size = program.bytes.size();
  const auto setup = rising(fields, "setup", 0, size);
  if (!setup) return tl::unexpected(setup.error());
  program.setup = blocks_from(0, *setup);
  const std::uint64_t after_setup = setup->empty() ? 0 : setup->back();
  const nlohmann::json* search = fields.value("search");
  if (search == nullptr || !search->is_number_unsigned() ||
      search->get<std::uint64_t>() < after_setup || search->get<std::uint64_t>() > size)
    return fail(ErrorKind::OutOfRange, fields.pointer("search"),
                fmt::format("must be a whole number from {} to {}", after_setup, size));
  program.search = {after_setup, search->get<std::uint64_t>()};
  const auto strokes = rising(fields, "strokes", program.search.end, size);
  if (!strokes) return tl::unexpected(strokes.error());
  program.strokes = blocks_from(program.search.end, *strokes);
  program.geometry = {program.search.end, strokes->empty() ? program.search.end : strokes->back()};
  program.trailer = {program.geometry.end, size};
  program.feed_out = {size, size};
  const nlohmann::json* trailer = fields.value("trailer");  // not where nothing is fed out
  if (trailer == nullptr) return {};
  if (!trailer->is_number_unsigned() || trailer->get<std::uint64_t>() < program.geometry.end ||
      trailer->get<std::uint64_t>() > size)
    return fail(ErrorKind::OutOfRange, fields.pointer("trailer"),
                fmt::format("must be a whole number from {} to {}", program.geometry.end, size));
  program.trailer.end = program.feed_out.begin = trailer->get<std::uint64_t>();
  return {};
}

Result<void> read_searches(FieldReader& fields, EncodedProgram& program) {
  constexpr double kMostUnits = 1e6;
  const nlohmann::json* list = fields.value("search_again");
  if (list == nullptr) return {};
  const bool is_valid = list->is_array() && list->size() <= kMostSearches &&
                        std::all_of(list->begin(), list->end(), [](const nlohmann::json& units) {
                          return units.is_number_integer() && units.get<double>() >= -kMostUnits &&
                                 units.get<double>() <= kMostUnits;
                        });
  if (!is_valid)
    return fail(ErrorKind::OutOfRange, fields.pointer("search_again"),
                fmt::format("must be a list of at most {} whole numbers", kMostSearches));
  program.search_again = list->get<std::vector<std::int64_t>>();
  return {};
}

/// Dots are the strokes without bytes, all of them.
Result<void> read_dots(FieldReader& fields, EncodedProgram& program) {
  const auto dots = rising(fields, "dots", 0, program.strokes.size());
  if (!dots) return tl::unexpected(dots.error());
  for (const std::uint64_t dot : *dots) program.dots.push_back(static_cast<std::uint32_t>(dot));
  std::size_t next = 0;
  for (std::size_t k = 0; k < program.strokes.size(); ++k) {
    const bool empty = program.strokes[k].begin == program.strokes[k].end;
    const bool listed = next < program.dots.size() && program.dots[next] == k;
    if (empty != listed)
      return fail(ErrorKind::OutOfRange, fields.pointer("dots"),
                  fmt::format("stroke {} has {} bytes; list only strokes without bytes", k,
                              program.strokes[k].end - program.strokes[k].begin));
    next += listed ? 1 : 0;
  }
  if (next != program.dots.size())
    return fail(ErrorKind::OutOfRange, fields.pointer("dots"), "names a stroke twice");
  return {};
}

}  // namespace

std::string sha256_of(const std::vector<EncodedProgram>& programs) {
  daemon::Sha256 digest;
  for (const EncodedProgram& program : programs) digest.add(program.bytes);
  return digest.hex();
}

std::string program_index(const EncodedProgram& program) {
  Json index{{"popcut", 1},
             {"dialect", program.dialect == Dialect::Hpgl ? "hpgl" : "gpgl"},
             {"bytes", program.bytes.size()},
             {"sha256", daemon::sha256_hex(program.bytes)},
             {"setup", ends_of(program.setup)},
             {"search", program.geometry.begin},
             {"strokes", ends_of(program.strokes)},
             {"dots", program.dots},
             {"ask_blade", program.ask_blade}};
  // Only where it is needed: an older popcut does not know it.
  if (program.feed_out.begin < program.feed_out.end) index["trailer"] = program.trailer.end;
  if (!program.search_again.empty()) index["search_again"] = program.search_again;
  return index.dump() + "\n";
}

Result<EncodedProgram> read_program(std::string_view index, std::string bytes) {
  const auto parsed = parse_json(index, 4);
  if (!parsed) return tl::unexpected(parsed.error());
  EncodedProgram program;
  program.bytes = std::move(bytes);
  FieldReader fields(*parsed, "");
  fields.integer("popcut", std::nullopt, 1, 1);
  program.dialect = static_cast<Dialect>(fields.word("dialect", {}, {"gpgl", "hpgl"}));
  const nlohmann::json* size = fields.value("bytes");
  const std::string sha256 = fields.text("sha256", std::nullopt);
  const bool ask_blade = fields.boolean("ask_blade", false);  // not in those of popcut 1.0
  for (const char* list : {"setup", "search", "strokes", "dots", "trailer", "search_again"})
    fields.value(list);
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  const bool same = size != nullptr && size->is_number_unsigned() &&
                    size->get<std::uint64_t>() == program.bytes.size() &&
                    sha256 == daemon::sha256_hex(program.bytes);
  if (!same)
    return fail(ErrorKind::CheckFailed, "/sha256",
                fmt::format("the program's {} bytes differ from the plan; plan again",
                            program.bytes.size()));
  program.ask_blade = ask_blade;
  const auto read = read_blocks(fields, program)
                        .and_then([&] { return read_searches(fields, program); })
                        .and_then([&] { return read_dots(fields, program); });
  if (!read) return tl::unexpected(read.error());
  return program;
}

}  // namespace popcut::planning
