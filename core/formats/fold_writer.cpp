// SPDX-License-Identifier: MIT
#include "core/formats/fold_writer.hpp"

#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/formats/text_sink.hpp"

namespace popcut {
namespace {

std::string_view assignment(EdgeRole role) {
  if (role == EdgeRole::Mountain) return "\"M\"";
  return role == EdgeRole::Valley ? "\"V\"" : "\"B\"";
}

std::string_view role_name(EdgeRole role) {
  switch (role) {
    case EdgeRole::Mountain:
      return "\"mountain\"";
    case EdgeRole::Valley:
      return "\"valley\"";
    case EdgeRole::Slit:
      return "\"slit\"";
    case EdgeRole::Outline:
      return "\"outline\"";
  }
  return "null";
}

/// `"key": [item, item, ...]`, several items a line.
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

void put_fold_angles(TextSink& text, const Pattern& pattern, double psi_rad) {
  const std::vector<double> angles = fold_angles_deg(pattern, psi_rad);
  put_list(text, "edges_foldAngle", angles.size(), [&](std::size_t e) { text.put(angles[e]); });
}

void put_edges(TextSink& text, const Pattern& pattern) {
  const std::size_t count = pattern.edges.size();
  put_list(text, "edges_vertices", count,
           [&](std::size_t e) { text("[", pattern.edges[e].from, ",", pattern.edges[e].to, "]"); });
  put_list(text, "edges_faces", count, [&](std::size_t e) {
    const auto [left, right] = std::pair(pattern.edges[e].left, pattern.edges[e].right);
    if (left >= 0 && right >= 0) return text("[", left, ",", right, "]");
    if (left < 0 && right < 0) return text("[]");
    text("[", left < 0 ? right : left, "]");
  });
  put_list(text, "edges_assignment", count,
           [&](std::size_t e) { text.put(assignment(pattern.edges[e].role)); });
  put_list(text, "edges_popcut:role", count,
           [&](std::size_t e) { text.put(role_name(pattern.edges[e].role)); });
}

void put_faces(TextSink& text, const Pattern& pattern) {
  put_list(text, "faces_vertices", pattern.faces(), [&](std::size_t f) {
    std::string_view before = "[";
    for (const std::uint32_t vertex : pattern.face(f)) {
      text(before, vertex);
      before = ",";
    }
    text.put(before == "[" ? "[]" : "]");
  });
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

/// What is glued to other patterns, and where this one lies in the whole: keys of popcut's own.
void put_seams(TextSink& text, const Pattern& pattern) {
  if (pattern.seams.empty()) return;
  text(",\n\"popcut:place_mm\": [", pattern.place.u_mm, ",", pattern.place.v_mm, "]");
  put_list(text, "popcut:seams", pattern.seams.size(), [&](std::size_t k) {
    const Seam& seam = pattern.seams[k];
    text("{\"id\": ", seam.id, ", \"part\": ", seam.other + 1, ", \"v_mm\": ", seam.v_mm,
         ", \"u_mm\": [", seam.u0_mm, ",", seam.u1_mm, "]}");
  });
}

Result<void> check(const Pattern& pattern, const FoldOptions& options) {
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i) {
    const PatternVertex& p = pattern.vertices[i];
    if (!std::isfinite(p.x + p.z + p.v + pattern.wall_mm)) {
      return fail(ErrorKind::Internal, fmt::format("vertices/{}", i), "is not finite");
    }
  }
  for (std::size_t i = 0; i < options.psi_rad.size(); ++i) {
    if (!(options.psi_rad[i] >= 0.0 && options.psi_rad[i] <= std::numbers::pi)) {
      return fail(ErrorKind::OutOfRange, fmt::format("fold frame {}", i),
                  fmt::format("{} rad is no opening angle; give one of 0 (shut) to pi (flat)",
                              options.psi_rad[i]));
    }
  }
  return {};
}

}  // namespace

Result<void> write_fold(const Pattern& pattern, const FoldOptions& options, std::ostream& out) {
  if (auto sound = check(pattern, options); !sound) return sound;
  TextSink text(out);
  text("{\"file_spec\": 1.2,\n\"file_creator\": ", json_quoted(options.creator),
       ",\n\"file_title\": ", json_quoted(pattern.name),
       ",\n\"file_classes\": [\"singleModel\",\"animation\"]",
       ",\n\"frame_title\": \"flat sheet, fold angles of psi = pi/2\"",
       ",\n\"frame_classes\": [\"creasePattern\"]",
       ",\n\"frame_attributes\": [\"2D\",\"manifold\",\"orientable\"]",
       ",\n\"frame_unit\": \"mm\"");
  put_seams(text, pattern);
  put_list(text, "vertices_coords", pattern.vertices.size(), [&](std::size_t i) {
    text("[", pattern.u(pattern.vertices[i]), ",", pattern.vertices[i].v, "]");
  });
  put_edges(text, pattern);
  put_fold_angles(text, pattern, std::numbers::pi / 2);
  put_faces(text, pattern);
  text.put(",\n\"file_frames\": [");
  for (std::size_t i = 0; i < options.psi_rad.size(); ++i) {
    if (i > 0) text.put(",\n");
    put_deployed_frame(text, pattern, options.psi_rad[i]);
  }
  text.put("]}\n");
  return {};
}

}  // namespace popcut
