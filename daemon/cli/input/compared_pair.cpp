// SPDX-License-Identifier: MIT
#include "daemon/cli/input/compared_pair.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/compare/comparison.hpp"
#include "core/design/facet_design.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/geometry/vec.hpp"
#include "core/judge/card_pose.hpp"
#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/words.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/target/target.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/input/compared_book.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace compared_pair {
namespace {

constexpr std::uintmax_t kPatternLimitBytes = 1u << 29;

bool has_ending(const std::string& file, std::string_view ending) {
  return same_word(std::filesystem::path(file).extension().string(), ending);
}

Result<std::vector<float>> mesh_triangles(const std::string& file, const std::string& bytes) {
  auto triangles =
      has_ending(file, ".csv") ? read_height_grid(file, bytes) : read_mesh(file, bytes);
  if (!triangles) return tl::unexpected(triangles.error());  // the readers name the file
  return std::move(triangles->corners);
}

bool has_size(const std::vector<float>& triangles) {
  return likeness::box_of(triangles).diagonal() > 0.0;
}

/// Settles whether the structure is a card in the corner.
Result<void> find_corner(const std::string& file, const likeness::Corner& corner,
                         ComparedStructure& out) {
  const double touch = 1e-3 * likeness::box_of(out.triangles).diagonal();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < out.triangles.size(); k += 3)
    least = std::min(least, corner.clearance(Vec3(static_cast<double>(out.triangles[k]),
                                                  static_cast<double>(out.triangles[k + 1]),
                                                  static_cast<double>(out.triangles[k + 2]))));
  if (least < -touch) {
    out.notes.emplace_back(
        "it does not stand in a corner of wall and ground, so all of it is compared, without a "
        "background");
    return {};
  }
  out.corner = corner;
  if (!likeness::without_card(out.triangles, corner, 0.1 * touch).empty()) return {};
  return fail(ErrorKind::OutOfRange, file,
              "all of its panels lie in wall and ground when it is open, so there is nothing to "
              "compare; give a card that pops up");
}

/// The triangles of a folded form that comes without its flat sheet; none of other files.
Result<std::vector<float>> folded_form(const std::string& text) {
  const auto file = read_fold(text);
  if (!file) return tl::unexpected(file.error());
  std::vector<float> out;
  for (const FoldFrame& frame : file->frames)
    if (!frame.folded_form && !frame.vertices.empty()) return out;
  for (const FoldFrame& frame : file->frames) {
    if (!frame.folded_form || frame.faces.empty()) continue;
    const double unit_mm = std::max(fold_unit_mm(frame.unit), 1e-9);
    const auto at = [&](std::uint32_t v) { return Vec3(unit_mm * vec3(frame.vertices[v])); };
    for (std::size_t f = 0; f < frame.faces.size(); ++f) {
      const auto& face = frame.faces[f];
      Vec3 normal;  // of the polygon, by Newell's sum
      for (std::size_t k = 0; k < face.size(); ++k)
        normal += cross(at(face[k]), at(face[(k + 1) % face.size()]));
      const likeness::View seen = likeness::view_from(normal);
      std::vector<Vec2> flat;
      std::vector<std::uint32_t> round;
      for (const std::uint32_t v : face) {
        round.push_back(static_cast<std::uint32_t>(flat.size()));
        flat.emplace_back(dot(seen.right, at(v)), dot(seen.up, at(v)));
      }
      std::vector<Triangle> triangles;
      if (!triangulate(flat, round, triangles))
        return fail(ErrorKind::OutOfRange, face_place(f), "is not a simple polygon");
      for (const Triangle& triangle : triangles)
        for (const std::uint32_t corner : triangle)
          for (const double value : at(face[corner])) out.push_back(static_cast<float>(value));
    }
    return out;
  }
  return out;
}

/// The surface of a spec, not yet shifted to where its slices lie on the sheet.
struct SpecSurface {
  std::vector<float> triangles;
  bool is_mesh{};
  std::optional<double>
      shift_mm;  ///< from the target to the sheet along the spine; none: not known
};

/// The strips of a pattern on its sheet, and how far they lie from their places along the target,
/// on average.
struct Strips {
  double begin_mm{}, end_mm{}, shift_mm{};
};

std::optional<Strips> strips_of(const std::string& fold_text, const verify::Target& target) {
  const auto model = verify::read_fold_model(fold_text);
  if (!model) return std::nullopt;
  const auto pose = std::find_if(model->poses.begin(), model->poses.end(),
                                 [](const verify::Pose& p) { return p.psi_rad.has_value(); });
  if (pose == model->poses.end()) return std::nullopt;
  const auto stations = verify::find_stations(*model, *pose, target);
  if (!stations || stations->empty() || stations->front().slices.empty()) return std::nullopt;
  const std::vector<verify::TargetStation>& slices = stations->front().slices;
  Strips out{slices.front().begin_mm, slices.back().end_mm, 0.0};
  for (const verify::TargetStation& at : slices)
    out.shift_mm +=
        (0.5 * (at.begin_mm + at.end_mm) - at.s_mm) / static_cast<double>(slices.size());
  return out;
}

Result<SpecSurface> read_spec(const std::string& file, const std::string& text,
                              const ComparedStructure& structure) {
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(within(file, spec.error()));
  // Facets have no slices to check, so that verify does not read them.
  if (is_of_facets(spec->style)) {
    const auto assets = load_assets(*spec, file);
    if (!assets) return tl::unexpected(within(file, assets.error()));
    auto target = facet_target(*spec, *assets);
    if (!target) return tl::unexpected(within(file, target.error()));
    SpecSurface out;
    out.triangles.assign(target->soup.corners.begin(), target->soup.corners.end());
    out.shift_mm = spec->card->margin_mm - target->from_mm;
    return out;
  }
  verify::TargetFiles files;
  for (const std::string& name : target_files_of(text)) {
    auto bytes = read_model_file(std::filesystem::path(file).parent_path() / name);
    if (!bytes) return tl::unexpected(within(file, bytes.error()));
    files.emplace(name, std::move(*bytes));
  }
  auto target = verify::read_target(*spec, files);
  if (!target) return tl::unexpected(within(file, target.error()));
  const likeness::Box box = likeness::box_of(structure.triangles);
  verify::TargetReach reach{box.low.y(), box.high.y(), 1.05 * box.high.x(), 1.05 * box.high.z()};
  SpecSurface out;
  if (const auto strips = strips_of(structure.fold_text, *target)) {
    out.shift_mm = strips->shift_mm;
    reach.begin_mm = strips->begin_mm - strips->shift_mm;
    reach.end_mm = strips->end_mm - strips->shift_mm;
  } else if (!target->slices.empty()) {
    reach.begin_mm = -0.5 * target->slices.front().width_mm;
    reach.end_mm = target->slices.back().s_mm + 0.5 * target->slices.back().width_mm;
  }
  TriangleMesh triangles;
  target->surface->add_triangles(reach, triangles);
  out.triangles = std::move(triangles.corners);
  out.is_mesh = spec->surface && std::holds_alternative<MeshSpec>(*spec->surface);
  return out;
}

Result<ComparedTarget> placed_spec(const std::string& file, const std::string& text,
                                   const ComparedStructure& structure) {
  auto surface = read_spec(file, text, structure);
  if (!surface) return tl::unexpected(std::move(surface.error()));
  if (!has_size(surface->triangles))
    return fail(ErrorKind::OutOfRange, file,
                "the surface has no part along the slices; give the design of this pattern");
  ComparedTarget out;
  out.is_solid = surface->is_mesh;
  out.placed_by = "spec";
  if (surface->shift_mm) {
    out.placement.shift_mm.y() = *surface->shift_mm;
  } else {
    const auto found = likeness::find_shift_along_spine(surface->triangles, {}, structure.triangles,
                                                        structure.corner);
    out.placement = found.placement, out.misfit = found.misfit;
  }
  out.triangles = likeness::placed(surface->triangles, out.placement);
  return out;
}

}  // namespace
}  // namespace compared_pair

std::optional<double> shift_along_spine(const std::string& fold_text,
                                        const verify::Target& target) {
  const auto strips = compared_pair::strips_of(fold_text, target);
  return strips ? std::optional(strips->shift_mm) : std::nullopt;
}

Result<ComparedStructure> read_structure(const std::string& file, std::optional<double> psi_rad,
                                         const Progress& progress) {
  using namespace compared_pair;
  tell(progress, "reading the pattern", kUnknownPart);
  auto text = is_model_file(file) ? read_model_file(file) : read_file(file, kPatternLimitBytes);
  if (!text) return tl::unexpected(std::move(text.error()));
  ComparedStructure out;
  if (is_model_file(file)) {
    auto triangles = mesh_triangles(file, *text);
    if (!triangles) return tl::unexpected(std::move(triangles.error()));
    out.triangles = std::move(*triangles);
    out.is_mesh = true;
    out.psi_rad = psi_rad;
    if (!has_size(out.triangles))
      return fail(ErrorKind::OutOfRange, file, "the mesh has no size; give another one");
    const likeness::Corner corner{psi_rad.value_or(likeness::Corner{}.opening_rad)};
    if (auto done = find_corner(file, corner, out); !done) return tl::unexpected(done.error());
    return out;
  }
  if (is_drawing(*text, file)) {
    text = fold_of_drawing(*text, file, "auto", out.notes);
    if (!text) return tl::unexpected(std::move(text.error()));
  }
  if (const auto foreign = foreign_kind(*text); !foreign.empty())
    return fail(
        ErrorKind::Malformed, file,
        fmt::format("is {}; give a pattern (.fold, .svg, .dxf) or a 3D model (.stl, .obj, .glb)",
                    foreign));
  auto card = judge::open_card(*text, psi_rad, progress);
  if (!card && is_design_spec(*text)) return tl::unexpected(not_yet_designed(file, "compare"));
  if (!card && !psi_rad)
    if (auto folded = folded_form(*text); folded && has_size(*folded)) {
      out.triangles = std::move(*folded);
      out.is_mesh = true;
      out.notes.emplace_back(
          "the file has no flat sheet: its folded form is compared as it stands");
      if (auto done = find_corner(file, {}, out); !done) return tl::unexpected(done.error());
      return out;
    }
  if (!card) return tl::unexpected(within(file, card.error()));
  out.triangles = std::move(card->triangles);
  out.psi_rad = card->psi_rad;
  out.model = card->model;
  out.folds = card->folds, out.smallest_joint_mm = card->smallest_joint_mm;
  out.pieces = card->pieces;
  out.notes.insert(out.notes.end(), card->notes.begin(), card->notes.end());
  out.fold_text = std::move(*text);
  if (auto done = find_corner(file, card->corner, out); !done) return tl::unexpected(done.error());
  return out;
}

Result<ComparedTarget> read_compared_target(const std::string& file,
                                            const ComparedStructure& structure,
                                            const GivenPlacement& given, const Progress& progress) {
  using namespace compared_pair;
  tell(progress, "reading the model", kUnknownPart);
  auto bytes = read_model_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  if (!is_model_file(file) && is_pattern(*bytes))
    return fail(
        ErrorKind::OutOfRange, file,
        "is a pattern; give the model after the pattern: a mesh (STL, OBJ, GLB) or a design");
  if (!is_model_file(file) && is_design_spec(*bytes) && structure.is_book) {
    if (given.is_given() || given.fit)
      return fail(ErrorKind::Usage, "command line",
                  "a design says where its surface stands; leave out --scale, --rotate, --move and "
                  "--fit");
    return read_book_target(file, *bytes, structure);
  }
  if (!is_model_file(file) && is_design_spec(*bytes)) {
    if (given.is_given() || given.fit)
      return fail(ErrorKind::Usage, "command line",
                  "a design says where its surface stands; leave out --scale, --rotate, --move and "
                  "--fit");
    return placed_spec(file, *bytes, structure);
  }
  auto model = mesh_triangles(file, *bytes);
  if (!model) return tl::unexpected(std::move(model.error()));
  *bytes = {};  // large
  if (!has_size(*model))
    return fail(ErrorKind::OutOfRange, file, "the mesh has no size; give another one");
  ComparedTarget out;
  out.is_solid = !has_ending(file, ".csv");
  if (given.is_given()) {
    out.placed_by = "options";
    out.placement.scale_mm = given.scale_mm.value_or(1.0);
    out.placement.turn =
        likeness::ModelPlacement::turn_of(given.rotate_deg.value_or(std::array<double, 3>{}));
    const auto move = given.move_mm.value_or(std::array<double, 3>{});
    out.placement.shift_mm = Vec3(move[0], move[1], move[2]);
  } else if (structure.model && !given.fit) {
    out.placed_by = "pattern";
    out.placement = *structure.model;
  } else if (structure.is_mesh && !given.fit) {
    out.placed_by = "file";
  } else {
    tell(progress, "searching where the model fits best", kUnknownPart);
    const auto found = likeness::find_placement(*model, structure.triangles, structure.corner);
    out.placed_by = "fit";
    out.placement = found.placement, out.misfit = found.misfit;
  }
  out.triangles = likeness::placed(*model, out.placement);
  return out;
}

}  // namespace popcut::cli
