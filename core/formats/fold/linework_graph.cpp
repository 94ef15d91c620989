// SPDX-License-Identifier: MIT
#include "core/formats/fold/linework_graph.hpp"

#include <iterator>

#include <fmt/format.h>

namespace popcut {
namespace {

const char* letter_of(Operation operation) {
  switch (operation) {
    case Operation::FoldMountain:
      return "\"M\"";
    case Operation::FoldValley:
      return "\"V\"";
    case Operation::Score:
      return "\"U\"";
    case Operation::Draw:
      return nullptr;
    case Operation::Cut:
    case Operation::Outline:
      break;
  }
  return "\"C\"";
}

}  // namespace

std::string fold_from_linework(const LineWork& work) {
  fmt::memory_buffer vertices, edges, letters;
  std::size_t count = 0;
  for (const DrawnLine& line : work.lines) {
    const char* const letter = letter_of(line.operation);
    if (letter == nullptr) continue;
    const auto points = work.points_of(line);
    for (std::size_t i = 0; i < points.size(); ++i) {
      fmt::format_to(std::back_inserter(vertices), "{}[{},{}]", count == 0 ? "" : ",", points[i].y,
                     points[i].x);
      if (i > 0 && points[i] != points[i - 1]) {
        const char* const comma = letters.size() == 0 ? "" : ",";
        fmt::format_to(std::back_inserter(edges), "{}[{},{}]", comma, count - 1, count);
        fmt::format_to(std::back_inserter(letters), "{}{}", comma, letter);
      }
      ++count;
    }
  }
  return fmt::format(
      "{{\"file_spec\":1.2,\"frame_classes\":[\"creasePattern\"],\"frame_unit\":\"mm\","
      "\"vertices_coords\":[{}],\"edges_vertices\":[{}],\"edges_assignment\":[{}]}}",
      fmt::to_string(vertices), fmt::to_string(edges), fmt::to_string(letters));
}

}  // namespace popcut
