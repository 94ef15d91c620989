// SPDX-License-Identifier: MIT
#include "core/formats/fold/fold_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/planar_graph.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

/// What a role is called in a file, by its number: the assignment in split form and with single
/// cuts, and popcut's own word.
struct RoleNames {
  std::string_view split;
  char single;
  std::string_view word;
};
constexpr std::array<RoleNames, 4> kRoles{{{"\"M\"", 'M', "\"mountain\""},
                                           {"\"V\"", 'V', "\"valley\""},
                                           {"\"B\"", 'C', "\"slit\""},
                                           {"\"B\"", 'B', "\"outline\""}}};

const RoleNames& names_of(EdgeRole role) { return kRoles.at(static_cast<std::size_t>(role)); }

/// Writes `"key": [item, item, ...]` with several items per line.
template <typename PutItem>
void put_list(TextSink& text, std::string_view key, std::size_t count, PutItem put_item) {
  constexpr std::size_t kItemsALine = 16;
  text(",\n\"", key, "\": [");
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text.put(i % kItemsALine == 0 ? ",\n" : ",");
    put_item(i);
  }
  text.put("]");
}

/// Writes `[1,2]` without the numbers below zero, which stand for nothing.
void put_numbers(TextSink& text, const auto& numbers) {
  text.put("[");
  std::string_view before;
  for (const std::int64_t number : numbers) {
    if (number < 0) continue;
    text(before, number);
    before = ",";
  }
  text.put("]");
}

void put_fold_angles(TextSink& text, const Pattern& pattern, double psi_rad) {
  const std::vector<double> angles = fold_angles_deg(pattern, psi_rad);
  put_list(text, "edges_foldAngle", angles.size(), [&](std::size_t e) { text.put(angles[e]); });
}

void put_edges(TextSink& text, const Pattern& pattern) {
  const std::size_t count = pattern.edges.size();
  put_list(text, "edges_vertices", count,
           [&](std::size_t e) { text("[", pattern.edges[e].from, ",", pattern.edges[e].to, "]"); });
  put_list(text, "edges_faces", count, [&](std::size_t e) {
    put_numbers(text, std::array{pattern.edges[e].left, pattern.edges[e].right});
  });
  put_list(text, "edges_assignment", count,
           [&](std::size_t e) { text.put(names_of(pattern.edges[e].role).split); });
  put_list(text, "edges_popcut:role", count,
           [&](std::size_t e) { text.put(names_of(pattern.edges[e].role).word); });
}

void put_faces(TextSink& text, const Pattern& pattern) {
  put_list(text, "faces_vertices", pattern.faces(),
           [&](std::size_t f) { put_numbers(text, pattern.face(f)); });
}

void put_deployed_frame(TextSink& text, const Pattern& pattern, double psi_rad) {
  text("{\"frame_title\": \"deployed to psi = ", psi_rad, " rad\"",
       ",\n\"frame_classes\": [\"foldedForm\"]",
       ",\n\"frame_attributes\": [\"3D\",\"manifold\",\"orientable\"]",
       ",\n\"frame_unit\": \"mm\",\n\"frame_parent\": 0,\n\"frame_inherit\": true",
       ",\n\"frame_popcut:psi_rad\": ", psi_rad);
  const std::vector<std::array<double, 3>> places = posed_vertices(pattern, psi_rad);
  put_list(text, "vertices_coords", places.size(), [&](std::size_t i) {
    const auto [x, v, z] = places[i];
    text("[", x, ",", v, ",", z, "]");
  });
  put_fold_angles(text, pattern, psi_rad);
  text.put("}");
}

/// Popcut's own keys: seams to other patterns, and this pattern's place in the whole.
void put_seams(TextSink& text, const Pattern& pattern) {
  if (pattern.seams.empty()) return;
  text(",\n\"popcut:place_mm\": [", pattern.place.u_mm, ",", pattern.place.v_mm, "]");
  put_list(text, "popcut:seams", pattern.seams.size(), [&](std::size_t k) {
    const Seam& seam = pattern.seams[k];
    text("{\"id\": ", seam.id, ", \"part\": ", seam.other + 1, ", \"v_mm\": ", seam.v_mm,
         ", \"u_mm\": [", seam.u0_mm, ",", seam.u1_mm, "]}");
  });
}

Result<void> check(const Pattern& pattern, const std::vector<double>& psi_rad) {
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i) {
    const PatternVertex& p = pattern.vertices[i];
    if (!std::isfinite(p.x + p.z + p.v + pattern.wall_mm)) {
      return fail(ErrorKind::Internal, fmt::format("vertices/{}", i), "is not finite");
    }
  }
  for (std::size_t i = 0; i < psi_rad.size(); ++i) {
    if (!(psi_rad[i] >= 0.0 && psi_rad[i] <= std::numbers::pi)) {
      return fail(
          ErrorKind::OutOfRange, fmt::format("fold frame {}", i),
          fmt::format("{} rad is not an opening angle; give 0 (shut) to pi (flat)", psi_rad[i]));
    }
  }
  return {};
}

/// Which faces are paper: crossing one more B edge from outside goes in, the next one out again.
std::vector<bool> paper_faces(const PlanarGraph& graph) {
  enum : std::int8_t { Unknown, Paper, Hole };
  std::vector<std::int8_t> kind(graph.faces.size(), Unknown);
  std::vector<std::vector<std::pair<std::int32_t, bool>>> beside(graph.faces.size());
  std::vector<std::int32_t> reached;
  const auto reach = [&](std::int32_t face, std::int8_t what) {
    std::int8_t& known = kind[static_cast<std::size_t>(face)];
    if (known != Unknown) return;
    known = what;
    reached.push_back(face);
  };
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto [left, right] = graph.edge_faces[e];
    const bool border = graph.assignments[e] == 'B';
    if (left >= 0 && right >= 0) {
      beside[static_cast<std::size_t>(left)].emplace_back(right, border);
      beside[static_cast<std::size_t>(right)].emplace_back(left, border);
    } else if (border && (left >= 0 || right >= 0)) {
      reach(std::max(left, right), Paper);
    }
  }
  while (!reached.empty()) {
    const auto face = static_cast<std::size_t>(reached.back());
    reached.pop_back();
    for (const auto& [other, border] : beside[face])
      reach(other, border == (kind[face] == Paper) ? Hole : Paper);
  }
  std::vector<bool> paper(kind.size());
  for (std::size_t i = 0; i < kind.size(); ++i) paper[i] = kind[i] != Hole;
  return paper;
}

/// The pattern's edges as a planar graph in (u, v): both sides of a slit become one edge.
Result<PlanarGraph> flat_graph(const Pattern& pattern) {
  constexpr double kSame = 1e-6;  // mm
  std::vector<CreaseLine> lines;
  lines.reserve(pattern.edges.size());
  for (const PatternEdge& edge : pattern.edges) {
    const PatternVertex &a = pattern.vertices[edge.from], &b = pattern.vertices[edge.to];
    lines.push_back({{{pattern.u(a), a.v}, {pattern.u(b), b.v}}, names_of(edge.role).single});
  }
  return planar_graph(lines, kSame);
}

Result<void> put_single_cuts(TextSink& text, const Pattern& pattern) {
  const auto graph = flat_graph(pattern);
  if (!graph) return tl::unexpected(graph.error());
  const std::vector<double> angles = fold_angles_deg(pattern, std::numbers::pi / 2);
  const std::vector<bool> paper = paper_faces(*graph);
  std::vector<std::int32_t> number(paper.size(), -1);
  std::vector<std::size_t> faces;
  for (std::size_t f = 0; f < paper.size(); ++f) {
    if (!paper[f]) continue;
    number[f] = static_cast<std::int32_t>(faces.size());
    faces.push_back(f);
  }
  const std::size_t count = graph->edges.size();
  put_list(text, "vertices_coords", graph->vertices.size(),
           [&](std::size_t i) { text("[", graph->vertices[i].x, ",", graph->vertices[i].y, "]"); });
  put_list(text, "edges_vertices", count,
           [&](std::size_t e) { text("[", graph->edges[e][0], ",", graph->edges[e][1], "]"); });
  put_list(text, "edges_faces", count, [&](std::size_t e) {
    std::array<std::int32_t, 2> faces_of = graph->edge_faces[e];
    for (std::int32_t& face : faces_of)
      if (face >= 0) face = number[static_cast<std::size_t>(face)];
    put_numbers(text, faces_of);
  });
  put_list(text, "edges_assignment", count,
           [&](std::size_t e) { text("\"", std::string_view(&graph->assignments[e], 1), "\""); });
  put_list(text, "edges_popcut:role", count,
           [&](std::size_t e) { text.put(names_of(pattern.edges[graph->lines[e]].role).word); });
  put_list(text, "edges_foldAngle", count,
           [&](std::size_t e) { text.put(angles[graph->lines[e]]); });
  put_list(text, "faces_vertices", faces.size(),
           [&](std::size_t f) { put_numbers(text, graph->faces[faces[f]]); });
  return {};
}

}  // namespace

Result<void> write_fold(const Pattern& pattern, const FoldOptions& options, std::ostream& out) {
  const std::vector<double> psi_rad =
      options.psi_rad.value_or(std::vector{std::numbers::pi, pattern.design_psi_rad, 1.1});
  if (auto sound = check(pattern, psi_rad); !sound) return sound;
  TextSink text(out);
  text("{\"file_spec\": 1.2,\n\"file_creator\": ", json_quoted(options.creator),
       ",\n\"file_title\": ", json_quoted(pattern.name),
       options.split_cuts ? ",\n\"file_classes\": [\"singleModel\",\"animation\"]"
                          : ",\n\"file_classes\": [\"singleModel\"]",
       ",\n\"frame_title\": \"flat sheet, fold angles of psi = pi/2\"",
       ",\n\"frame_classes\": [\"creasePattern\"]",
       options.split_cuts
           ? ",\n\"frame_attributes\": [\"2D\",\"manifold\",\"orientable\"]"
           : ",\n\"frame_attributes\": [\"2D\",\"manifold\",\"orientable\",\"cuts\"]",
       ",\n\"frame_unit\": \"mm\"");
  if (pattern.design_psi_rad != std::numbers::pi / 2)
    text(",\n\"popcut:design_psi_rad\": ", pattern.design_psi_rad);
  if (pattern.model_placement) {
    text.put(",\n\"popcut:model_placement\": [");
    for (std::size_t k = 0; k < pattern.model_placement->size(); ++k)
      text(k > 0 ? "," : "", (*pattern.model_placement)[k]);
    text.put("]");
  }
  put_seams(text, pattern);
  if (!options.split_cuts) {
    if (auto done = put_single_cuts(text, pattern); !done) return done;
    text.put("}\n");
    return {};
  }
  put_list(text, "vertices_coords", pattern.vertices.size(), [&](std::size_t i) {
    text("[", pattern.u(pattern.vertices[i]), ",", pattern.vertices[i].v, "]");
  });
  put_edges(text, pattern);
  put_fold_angles(text, pattern, std::numbers::pi / 2);
  put_faces(text, pattern);
  text.put(",\n\"file_frames\": [");
  for (std::size_t i = 0; i < psi_rad.size(); ++i) {
    if (i > 0) text.put(",\n");
    put_deployed_frame(text, pattern, psi_rad[i]);
  }
  text.put("]}\n");
  return {};
}

std::string fold_from_linework(const LineWork& work) {
  constexpr std::string_view kLetters = "-UMVCC";  // by operation
  fmt::memory_buffer vertices, edges, letters;
  std::size_t count = 0;
  for (const DrawnLine& line : work.lines) {
    if (line.operation == Operation::Draw) continue;
    const char letter = kLetters.at(static_cast<std::size_t>(line.operation.operation));
    const auto points = work.points_of(line);
    for (std::size_t i = 0; i < points.size(); ++i) {
      fmt::format_to(std::back_inserter(vertices), "{}[{},{}]", count == 0 ? "" : ",", points[i].y,
                     points[i].x);
      if (i > 0 && points[i] != points[i - 1]) {
        const char* const comma = letters.size() == 0 ? "" : ",";
        fmt::format_to(std::back_inserter(edges), "{}[{},{}]", comma, count - 1, count);
        fmt::format_to(std::back_inserter(letters), "{}\"{}\"", comma, letter);
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
