// SPDX-License-Identifier: MIT
#include "core/model/height_grid.hpp"

#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostCells = 4'000'000;

struct HeightGrid {
  std::vector<double> x, y, z;  ///< z row by row, y.size() rows
};

tl::unexpected<Error> wrong(const std::string& name, std::size_t line, std::size_t column,
                            std::string what) {
  return fail(ErrorKind::Malformed, fmt::format("{}: line {}, column {}", name, line, column),
              std::move(what));
}

/// Reads a table of numbers line by line.
class GridReader {
 public:
  GridReader(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  Result<HeightGrid> run() {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);
    const std::string_view head = text_.substr(0, text_.find('\n'));
    for (const char c : {',', ';', '\t'})
      if (separator_ == '\0' && head.find(c) != std::string_view::npos) separator_ = c;
    if (separator_ == '\0')
      return wrong(name_, 1, 1, "has no comma, semicolon or tab; x values are needed in this row");
    while (!text_.empty()) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      const std::string_view line = text_.substr(0, end);
      text_.remove_prefix(std::min(text_.size(), end + 1));
      ++line_;
      if (trimmed(line, " \t\r").empty()) {
        if (trimmed(text_, " \r\n\t").empty()) break;
        return wrong(name_, line_, 1, "is empty; leave no gap between rows");
      }
      if (auto ok = line_ == 1 ? read_head(line) : read_row(line); !ok)
        return tl::unexpected(ok.error());
    }
    if (grid_.y.size() < 2)
      return wrong(name_, line_, 1,
                   fmt::format("is the last line, after {} rows of heights; two or more are needed",
                               grid_.y.size()));
    return std::move(grid_);
  }

 private:
  [[nodiscard]] Result<double> number(std::string_view cell, std::size_t column,
                                      const char* what) const {
    cell = trimmed(cell, " \t\r");
    if (cell.empty())
      return wrong(name_, line_, column, fmt::format("is empty; {} is needed", what));
    if (cell.front() == '+') cell.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    // Meshes hold floats.
    if (error != std::errc{} || end != cell.data() + cell.size() ||
        !std::isfinite(static_cast<float>(value)))
      return wrong(name_, line_, column,
                   fmt::format("is \"{}\"; {} is needed, with a point for decimals",
                               cell.substr(0, 24), what));
    return value;
  }

  Result<void> read_head(std::string_view line) {
    std::size_t column = 1;
    for (std::size_t at = line.find(separator_); at != std::string_view::npos;) {
      const std::size_t next = line.find(separator_, at + 1);
      ++column;
      const auto x = number(line.substr(at + 1, next - at - 1), column, "a value of x");
      if (!x) return tl::unexpected(x.error());
      if (!grid_.x.empty() && !(*x > grid_.x.back()))
        return wrong(
            name_, line_, column,
            fmt::format("x is {:g} after {:g}; values of x must grow", *x, grid_.x.back()));
      grid_.x.push_back(*x);
      if (grid_.x.size() > kMostCells) return too_large();
      at = next;
    }
    if (grid_.x.size() < 2)
      return wrong(name_, line_, column, "two or more values of x are needed in this row");
    return {};
  }

  Result<void> read_row(std::string_view line) {
    if ((grid_.y.size() + 1) * grid_.x.size() > kMostCells) return too_large();
    std::size_t column = 0;
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t next = std::min(line.find(separator_, at), line.size());
      ++column;
      if (column > grid_.x.size() + 1)
        return wrong(name_, line_, column,
                     fmt::format("is one more than the {} values of x", grid_.x.size()));
      const auto value =
          number(line.substr(at, next - at), column, column == 1 ? "a value of y" : "a height");
      if (!value) return tl::unexpected(value.error());
      if (column > 1) {
        grid_.z.push_back(*value);
      } else {
        if (!grid_.y.empty() && !(*value > grid_.y.back()))
          return wrong(
              name_, line_, column,
              fmt::format("y is {:g} after {:g}; values of y must grow", *value, grid_.y.back()));
        grid_.y.push_back(*value);
      }
      at = next + 1;
    }
    if (column != grid_.x.size() + 1)
      return wrong(name_, line_, column + 1,
                   fmt::format("is missing; {} heights are needed in a row", grid_.x.size()));
    return {};
  }

  [[nodiscard]] Result<void> too_large() const {
    return fail(ErrorKind::OutOfRange, fmt::format("{}: line {}", name_, line_),
                fmt::format("the grid has more than {} cells; make it coarser", kMostCells));
  }

  const std::string& name_;
  std::string_view text_;
  char separator_{'\0'};
  std::size_t line_{};
  HeightGrid grid_;
};

}  // namespace

Result<TriangleMesh> read_height_grid(const std::string& name, std::string_view bytes) {
  const auto read = GridReader(name, bytes).run();
  if (!read) return tl::unexpected(read.error());
  const HeightGrid& grid = *read;
  const std::size_t columns = grid.x.size(), rows = grid.y.size();
  TriangleMesh mesh;
  mesh.corners.reserve(18 * (columns - 1) * (rows - 1));
  const auto add = [&](std::size_t i, std::size_t j) {
    for (const double value : {grid.x[i], grid.y[j], grid.z[j * columns + i]})
      mesh.corners.push_back(static_cast<float>(value));
  };
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      add(i, j), add(i + 1, j), add(i + 1, j + 1);
      add(i, j), add(i + 1, j + 1), add(i, j + 1);
    }
  return mesh;
}

}  // namespace popcut
