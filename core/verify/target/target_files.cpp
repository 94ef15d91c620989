// SPDX-License-Identifier: MIT
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "core/text/file_kind.hpp"
#include "core/text/words.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {
namespace {

constexpr std::size_t kMostTriangles = 10'000'000;

tl::unexpected<Error> wrong(const std::string& name, std::size_t line, std::string detail) {
  return fail(ErrorKind::Malformed, line > 0 ? fmt::format("{}: line {}", name, line) : name,
              std::move(detail));
}

Result<void> room(const std::string& name, std::size_t triangles) {
  if (triangles <= kMostTriangles) return {};
  return fail(ErrorKind::OutOfRange, name,
              fmt::format("there are more than {} triangles; make it coarser", kMostTriangles));
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), end + 1));
  return line;
}

std::string_view next_word(std::string_view& line, std::string_view blanks = " \t\r") {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(blanks)));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

bool three_numbers(std::string_view line, std::array<float, 3>& out) {
  for (float& value : out) {
    const auto read = number(next_word(line));
    if (!read || !(std::abs(*read) < 1e30)) return false;
    value = static_cast<float>(*read);
  }
  return true;
}

Result<TargetTriangles> read_binary_stl(const std::string& name, const std::string& bytes) {
  const std::size_t count = (bytes.size() - 84) / 50;
  if (auto fits = room(name, count); !fits) return tl::unexpected(fits.error());
  TargetTriangles out;
  out.corners.resize(9 * count);
  for (std::size_t t = 0; t < count;
       ++t)  // after 84 bytes of header, and 12 of normal per triangle
    std::memcpy(out.corners.data() + 9 * t, bytes.data() + 84 + 50 * t + 12, 36);
  for (const float value : out.corners)
    if (!std::isfinite(value))
      return fail(ErrorKind::OutOfRange, name, "a coordinate is not a finite number");
  return out;
}

Result<TargetTriangles> read_text_stl(const std::string& name, std::string_view text) {
  TargetTriangles out;
  for (std::size_t line = 1; !text.empty(); ++line) {
    std::string_view rest = next_line(text);
    if (next_word(rest) != "vertex") continue;
    std::array<float, 3> p{};
    if (!three_numbers(rest, p)) return wrong(name, line, "give three numbers after vertex");
    out.corners.insert(out.corners.end(), p.begin(), p.end());
    if (auto fits = room(name, out.size()); !fits) return tl::unexpected(fits.error());
  }
  if (out.corners.size() % 9 != 0) return wrong(name, 0, "the last facet is incomplete");
  return out;
}

Result<TargetTriangles> read_obj(const std::string& name, std::string_view text) {
  std::vector<std::array<float, 3>> points;
  TargetTriangles out;
  for (std::size_t line = 1; !text.empty(); ++line) {
    std::string_view rest = next_line(text);
    const std::string_view word = next_word(rest);
    if (word == "v") {
      points.emplace_back();
      if (!three_numbers(rest, points.back()))
        return wrong(name, line, "give three numbers after v");
    }
    if (word != "f") continue;
    std::vector<std::size_t> face;
    for (std::string_view at = next_word(rest); !at.empty(); at = next_word(rest)) {
      const auto index = number(at.substr(0, at.find('/')));
      const double count = static_cast<double>(points.size());
      const double k = index ? (*index < 0.0 ? count + *index : *index - 1.0) : -1.0;
      if (!(k >= 0.0) || k >= count)
        return wrong(name, line, "a face uses a point that does not exist");
      face.push_back(static_cast<std::size_t>(k));
    }
    for (std::size_t k = 2; k < face.size(); ++k)
      for (const std::size_t at : {face[0], face[k - 1], face[k]})
        out.corners.insert(out.corners.end(), points[at].begin(), points[at].end());
    if (auto fits = room(name, out.size()); !fits) return tl::unexpected(fits.error());
  }
  return out;
}

bool ends_with(const std::string& name, std::string_view ending) {
  return name.size() >= ending.size() &&
         same_word(std::string_view(name).substr(name.size() - ending.size()), ending);
}

bool is_gltf(const std::string& name, const std::string& bytes) {
  return bytes.starts_with("glTF") || ends_with(name, ".gltf") || ends_with(name, ".glb");
}

bool is_binary_stl(const std::string& bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return bytes.size() == 84 + 50 * static_cast<std::size_t>(count);
}

/// The rows of a table of numbers; the first cell may hold anything.
struct Table {
  std::vector<double> x, y, z;
};

Result<Table> read_table(const std::string& name, std::string_view text) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  const std::string_view head = text.substr(0, text.find('\n'));
  const char separator = head.find(',') != std::string_view::npos   ? ','
                         : head.find(';') != std::string_view::npos ? ';'
                                                                    : '\t';
  Table table;
  for (std::size_t line = 1; !text.empty(); ++line) {
    std::string_view rest = next_line(text);
    if (rest.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    std::size_t column = 0;
    for (bool more = true; more; ++column) {
      const std::size_t end = std::min(rest.find(separator), rest.size());
      more = end < rest.size();
      std::string_view cell = rest.substr(0, end);
      rest.remove_prefix(std::min(rest.size(), end + 1));
      if (line == 1 && column == 0) continue;
      const auto value = number(next_word(cell));
      if (!value || !next_word(cell).empty())
        return wrong(name, line, fmt::format("column {} is not a number", column + 1));
      auto& list = line == 1 ? table.x : column == 0 ? table.y : table.z;
      if (&list != &table.z && !list.empty() && !(*value > list.back()))
        return wrong(name, line, fmt::format("column {} does not increase", column + 1));
      list.push_back(*value);
    }
    if (line > 1 && column != table.x.size() + 1)
      return wrong(name, line, fmt::format("{} cells for {} values of x", column, table.x.size()));
    if (auto fits = room(name, 2 * table.z.size()); !fits) return tl::unexpected(fits.error());
  }
  if (table.x.size() < 2 || table.y.size() < 2)
    return wrong(name, 0, "the grid needs at least two values of x and of y");
  return table;
}

}  // namespace

Result<TargetTriangles> read_target_mesh(const std::string& name, const std::string& bytes) {
  if (const auto foreign = foreign_kind(bytes); !foreign.empty() && !is_binary_stl(bytes))
    return wrong(name, 0,
                 fmt::format("is {}; give a 3D model as an STL, OBJ or GLB file", foreign));
  auto read = is_gltf(name, bytes)      ? read_target_gltf(name, bytes)
              : ends_with(name, ".obj") ? read_obj(name, bytes)
              : is_binary_stl(bytes)    ? read_binary_stl(name, bytes)
                                        : read_text_stl(name, bytes);
  if (read && read->size() == 0)
    return wrong(name, 0, "has no triangles; give an STL, OBJ or GLB file");
  return read;
}

Result<TargetTriangles> read_target_grid(const std::string& name, const std::string& bytes) {
  const auto table = read_table(name, bytes);
  if (!table) return tl::unexpected(table.error());
  const std::size_t columns = table->x.size(), rows = table->y.size();
  TargetTriangles out;
  out.corners.reserve(18 * (columns - 1) * (rows - 1));
  const auto add = [&](std::size_t i, std::size_t j) {
    for (const double value : {table->x[i], table->y[j], table->z[j * columns + i]})
      out.corners.push_back(static_cast<float>(value));
  };
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      add(i, j), add(i + 1, j), add(i + 1, j + 1);
      add(i, j), add(i + 1, j + 1), add(i, j + 1);
    }
  return out;
}

}  // namespace popcut::verify
