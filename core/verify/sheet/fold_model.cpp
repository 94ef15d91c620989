// SPDX-License-Identifier: MIT
#include "core/verify/sheet/fold_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "core/text/fold_text.hpp"

namespace popcut::verify {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

bool has_class(const FrameText& frame, const char* name) {
  return std::find(frame.classes.begin(), frame.classes.end(), name) != frame.classes.end();
}

/// The frame from which each frame inherits; `kNone` if it does not inherit.
Result<std::vector<std::size_t>> parents(const std::vector<FrameText>& frames) {
  std::vector<std::size_t> parent(frames.size(), kNone);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (!frames[k].inherit) continue;
    const double index = frames[k].parent.value_or(0.0);
    if (!(index >= 0.0) || index >= static_cast<double>(frames.size()) ||
        index != std::floor(index)) {
      return fail(
          ErrorKind::OutOfRange, frames[k].place + "/frame_parent",
          fmt::format("there is no frame {}; frames are 0 to {}", index, frames.size() - 1));
    }
    parent[k] = static_cast<std::size_t>(index);
  }
  std::vector<std::uint8_t> sound(frames.size(), 0);
  std::vector<std::size_t> chain;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    chain.clear();
    for (std::size_t at = k; at != kNone && sound[at] == 0; at = parent[at]) {
      if (chain.size() > frames.size())
        return fail(ErrorKind::OutOfRange, frames[k].place + "/frame_parent",
                    "the frame inherits from itself");
      chain.push_back(at);
    }
    for (const std::size_t at : chain) sound[at] = 1;
  }
  return parent;
}

/// The frame that defines `member` for frame `k`: itself or an ancestor; `kNone` if there is none.
std::size_t owner(const std::vector<FrameText>& frames, const std::vector<std::size_t>& parent,
                  std::size_t k, FoldColumn FrameText::*member) {
  while (k != kNone && !(frames[k].*member).present) k = parent[k];
  return k;
}

Result<double> millimetres(const FrameText& frame) {
  const double mm = fold_unit_mm(frame.unit);
  if (mm > 0.0) return mm;
  return fail(ErrorKind::OutOfRange, frame.place + "/frame_unit",
              fmt::format("unknown unit \"{}\"; write mm, cm, m, um, nm, in, pt or unit",
                          frame.unit.substr(0, 20)));
}

Result<std::vector<Vec3>> coordinates(const FrameText& frame, double scale) {
  const FoldColumn& column = frame.vertices_coords;
  std::vector<Vec3> points(column.rows());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t begin = column.row_begin(i);
    const std::size_t count = column.row_end(i) - begin;
    if (count != 2 && count != 3) {
      return fail(ErrorKind::OutOfRange, fmt::format("{}/vertices_coords/{}", frame.place, i),
                  fmt::format("a vertex has {} coordinates; give 2 or 3", count));
    }
    std::array<double, 3> xyz{};
    for (std::size_t k = 0; k < count; ++k) {
      xyz[k] = scale * column.number[begin + k];
      if (!(std::abs(xyz[k]) <= kMaxCoordinate_mm))
        return fail(ErrorKind::OutOfRange,
                    fmt::format("{}/vertices_coords/{}/{}", frame.place, i, k),
                    fmt::format("{} mm is not within {} mm", xyz[k], kMaxCoordinate_mm));
    }
    points[i] = {xyz[0], xyz[1], xyz[2]};
  }
  return points;
}

Result<std::uint32_t> vertex_index(double number, std::size_t vertices, const std::string& place,
                                   std::size_t row, std::size_t k) {
  if (number >= 0.0 && number < static_cast<double>(vertices) && number == std::floor(number))
    return static_cast<std::uint32_t>(number);
  return fail(ErrorKind::OutOfRange, fmt::format("{}/{}/{}", place, row, k),
              fmt::format("there is no vertex {}; vertices are 0 to {}", number,
                          static_cast<std::int64_t>(vertices) - 1));
}

Result<void> read_edges(const FrameText& frame, FoldModel& file) {
  const FoldColumn& column = frame.edges_vertices;
  const std::string place = frame.place + "/edges_vertices";
  file.edges.reserve(column.rows());
  for (std::size_t e = 0; e < column.rows(); ++e) {
    const std::size_t begin = column.row_begin(e);
    if (column.row_end(e) - begin != 2)
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", place, e),
                  "an edge must join two vertices");
    std::array<std::uint32_t, 2> ends{};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto index = vertex_index(column.number[begin + k], file.flat.size(), place, e, k);
      if (!index) return tl::unexpected(index.error());
      ends[k] = *index;
    }
    if (ends[0] == ends[1])
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", place, e),
                  fmt::format("the edge joins vertex {} to itself", ends[0]));
    file.edges.push_back(ends);
  }
  return {};
}

Result<void> read_assignments(const FrameText& frame, FoldModel& file) {
  static constexpr std::string_view kLetters = "BMVFUCJ";
  const FoldColumn& column = frame.edges_assignment;
  const std::string place = frame.place + "/edges_assignment";
  file.assignment.assign(file.edges.size(), Assignment::Unassigned);
  if (!column.present) {
    file.notes.emplace_back(
        "the file assigns no folds: every edge between two faces counts as a fold");
    return {};
  }
  file.assigned = true;
  if (column.number.size() != file.edges.size())
    return fail(
        ErrorKind::OutOfRange, place,
        fmt::format("{} assignments for {} edges", column.number.size(), file.edges.size()));
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    char letter = static_cast<char>(static_cast<int>(column.number[e]));
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    const std::size_t which = kLetters.find(letter);
    if (which == std::string_view::npos) {
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", place, e),
                  "unknown assignment; use B, M, V, F, U, C or J");
    }
    file.assignment[e] = static_cast<Assignment>(which);
  }
  return {};
}

Result<std::vector<double>> fold_angles(const FrameText& frame, std::size_t edges) {
  const std::vector<double>& angle = frame.edges_fold_angle.number;
  const std::string place = frame.place + "/edges_foldAngle";
  if (angle.size() != edges)
    return fail(ErrorKind::OutOfRange, place,
                fmt::format("{} fold angles for {} edges", angle.size(), edges));
  for (std::size_t e = 0; e < edges; ++e) {
    if (std::abs(angle[e]) > 180.0) {
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", place, e),
                  fmt::format("a fold angle of {} degrees; use -180 to 180", angle[e]));
    }
  }
  return angle;
}

Result<void> read_faces(const FrameText& frame, FoldModel& file) {
  const FoldColumn& column = frame.faces_vertices;
  const std::string place = frame.place + "/faces_vertices";
  file.face_first.assign(1, 0);
  file.face_vertices.reserve(column.number.size());
  for (std::size_t f = 0; f < column.rows(); ++f) {
    const std::size_t begin = column.row_begin(f);
    const std::size_t count = column.row_end(f) - begin;
    if (count < 3) {
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", place, f),
                  fmt::format("a face has {} vertices; it needs at least 3", count));
    }
    for (std::size_t k = 0; k < count; ++k) {
      const auto index = vertex_index(column.number[begin + k], file.flat.size(), place, f, k);
      if (!index) return tl::unexpected(index.error());
      if (column.number[begin + k] == column.number[begin + (k + 1) % count])
        return fail(ErrorKind::OutOfRange, fmt::format("{}/{}/{}", place, f, k),
                    fmt::format("the face has vertex {} twice in a row", *index));
      file.face_vertices.push_back(*index);
    }
    file.face_first.push_back(static_cast<std::uint32_t>(file.face_vertices.size()));
  }
  return {};
}

/// Largest distance of a point from the first one, in mm.
double reach(const std::vector<Vec3>& points) {
  double size = 0.0;
  for (const Vec3& p : points)
    size = std::max({size, std::abs(p.x()), std::abs(p.y()), std::abs(p.z())});
  return size;
}

bool is_flat(const std::vector<Vec3>& points) {
  const double slack = 1e-9 * reach(points);
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& p) { return std::abs(p.z() - points.front().z()) <= slack; });
}

/// All data about a file's frames except geometry.
struct Frames {
  std::vector<FrameText> text;
  std::vector<std::size_t> parent;
};

/// Whether frame `k` uses the key frame's edges and faces (or has none of its own).
bool same_sheet(const Frames& frames, std::size_t k, std::size_t vertices) {
  if (frames.text[k].vertices_coords.rows() != vertices) return false;
  for (const auto member : {&FrameText::edges_vertices, &FrameText::faces_vertices}) {
    const std::size_t from = owner(frames.text, frames.parent, k, member);
    if (from == 0 || from == kNone) continue;
    if ((frames.text[from].*member).number != (frames.text[0].*member).number ||
        (frames.text[from].*member).row_first != (frames.text[0].*member).row_first) {
      return false;
    }
  }
  return true;
}

Result<Pose> read_pose(const Frames& frames, std::size_t k, double key_scale, std::size_t edges) {
  const FrameText& text = frames.text[k];
  const auto own_scale = text.unit.empty() ? Result<double>(key_scale) : millimetres(text);
  if (!own_scale) return tl::unexpected(own_scale.error());
  auto at = coordinates(text, *own_scale);
  if (!at) return tl::unexpected(at.error());
  Pose pose{
      .place = text.place, .at = std::move(*at), .fold_angle_deg = {}, .psi_rad = text.psi_rad};
  if (text.edges_fold_angle.present) {
    auto angles = fold_angles(text, edges);
    if (!angles) return tl::unexpected(angles.error());
    pose.fold_angle_deg = std::move(*angles);
  }
  return pose;
}

/// All frames that show the key frame's sheet in space, the key frame first.
Result<std::vector<Pose>> read_poses(const Frames& frames, double scale, FoldModel& file) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < frames.text.size(); ++k) {
    const FrameText& text = frames.text[k];
    if (k > 0 && !text.vertices_coords.present) continue;
    if (k > 0 && !same_sheet(frames, k, file.flat.size())) {
      if (text.inherit && text.vertices_coords.rows() != file.flat.size())
        return fail(ErrorKind::OutOfRange, text.place + "/vertices_coords",
                    fmt::format("{} vertices, but the key frame that it inherits has {}",
                                text.vertices_coords.rows(), file.flat.size()));
      file.notes.push_back(text.place + " has its own vertices or faces and is ignored");
      continue;
    }
    auto pose = read_pose(frames, k, scale, file.edges.size());
    if (!pose) return tl::unexpected(pose.error());
    file.from_popcut = file.from_popcut || text.psi_rad.has_value();
    poses.push_back(std::move(*pose));
  }
  return poses;
}

Result<void> read_model_placement(const FrameText& key, FoldModel& file) {
  const FoldColumn& column = key.model_placement;
  if (!column.present) return {};
  std::array<double, 7> numbers{};
  if (column.number.size() != numbers.size())
    return fail(ErrorKind::OutOfRange, "/popcut:model_placement",
                fmt::format("has {} numbers; give 7: the scale, three turns in degrees and the "
                            "shift in mm",
                            column.number.size()));
  std::copy(column.number.begin(), column.number.end(), numbers.begin());
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (!(std::abs(numbers[k]) <= kMaxCoordinate_mm) || (k == 0 && !(numbers[0] > 0.0)))
      return fail(ErrorKind::OutOfRange, fmt::format("/popcut:model_placement/{}", k),
                  fmt::format("{} is not {}", numbers[k],
                              k == 0 ? "a scale above 0" : "a turn or a shift up to 1e7"));
  file.model_placement = numbers;
  return {};
}

/// Moves the pose that is the flat sheet from `poses` to `file.flat`.
Result<void> choose_flat(const Frames& frames, std::vector<Pose> poses, FoldModel& file) {
  std::size_t chosen = kNone;
  for (std::size_t i = 0; i < poses.size() && chosen == kNone; ++i) {
    const auto text = std::find_if(frames.text.begin(), frames.text.end(),
                                   [&](const FrameText& t) { return t.place == poses[i].place; });
    const bool wanted =
        i == 0 ? !has_class(*text, "foldedForm") : has_class(*text, "creasePattern");
    if (wanted && is_flat(poses[i].at)) chosen = i;
  }
  if (chosen == kNone) {
    return fail(ErrorKind::OutOfRange, "/vertices_coords",
                "the key frame is a folded form and no other frame is a flat creasePattern; "
                "verify needs the flat sheet");
  }
  if (chosen != 0) {
    file.notes.push_back("the key frame is a folded form; the flat sheet is " +
                         poses[chosen].place);
  }
  for (std::size_t i = 0; i < file.flat.size(); ++i)
    file.flat[i] = {poses[chosen].at[i].x(), poses[chosen].at[i].y()};
  poses[0].fold_angle_deg.clear();  // these belong to the pattern, not to this pose
  poses.erase(poses.begin() + static_cast<std::ptrdiff_t>(chosen));
  file.poses = std::move(poses);
  return {};
}

Result<FoldModel> read_sheet(const FrameText& frame) {
  const auto needs = [&](const FoldColumn& column, const char* member, const char* what) {
    return column.present && !column.number.empty()
               ? Result<void>()
               : fail(ErrorKind::Malformed, frame.place + "/" + member,
                      fmt::format("is missing; a part needs {}", what));
  };
  if (auto had = needs(frame.edges_vertices, "edges_vertices", "edges"); !had)
    return tl::unexpected(had.error());
  if (auto had = needs(frame.edges_assignment, "edges_assignment", "folds and borders"); !had)
    return tl::unexpected(had.error());
  if (auto had = needs(frame.edges_fold_angle, "edges_foldAngle", "the angles of an opened pose");
      !had)
    return tl::unexpected(had.error());
  if (auto had = needs(frame.faces_vertices, "faces_vertices", "faces"); !had)
    return tl::unexpected(had.error());
  const auto scale = millimetres(frame);
  if (!scale) return tl::unexpected(scale.error());
  const auto points = coordinates(frame, *scale);
  if (!points) return tl::unexpected(points.error());
  if (!is_flat(*points))
    return fail(ErrorKind::OutOfRange, frame.place + "/vertices_coords",
                "are not flat; give the part as it is cut");
  FoldModel file;
  for (const Vec3& p : *points) file.flat.push_back({p.x(), p.y()});
  if (auto read = read_edges(frame, file); !read) return tl::unexpected(read.error());
  if (auto read = read_assignments(frame, file); !read) return tl::unexpected(read.error());
  auto angles = fold_angles(frame, file.edges.size());
  if (!angles) return tl::unexpected(angles.error());
  file.fold_angle_deg = std::move(*angles);
  if (auto read = read_faces(frame, file); !read) return tl::unexpected(read.error());
  return file;
}

}  // namespace

Result<std::vector<FoldPart>> read_fold_parts(std::string_view text) {
  const auto frames = read_fold_text(text);
  if (!frames) return tl::unexpected(frames.error());
  std::vector<FoldPart> parts;
  for (const FrameText& frame : *frames) {
    if (!frame.vertices_coords.present) continue;
    auto sheet = read_sheet(frame);
    if (!sheet) return tl::unexpected(sheet.error());
    parts.push_back({frame.title, frame.place, std::move(*sheet)});
  }
  if (parts.empty())
    return fail(ErrorKind::Malformed, "/file_frames", "no frame has vertices; each part is one");
  return parts;
}

Result<FoldModel> read_fold_model(std::string_view text) {
  auto frame_texts = read_fold_text(text);
  if (!frame_texts) return tl::unexpected(frame_texts.error());
  auto parent = parents(*frame_texts);
  if (!parent) return tl::unexpected(parent.error());
  const Frames frames{std::move(*frame_texts), std::move(*parent)};
  const FrameText& key = frames.text.front();
  if (!key.vertices_coords.present || key.vertices_coords.rows() == 0) {
    if (lists_joints(text))
      return fail(ErrorKind::Malformed, "/popcut:joints",
                  "is a card of several parts; 'popcut verify', 'popcut plan' and 'popcut "
                  "fold-guide' read those");
    return fail(ErrorKind::Malformed, "/vertices_coords", "missing; a pattern needs vertices");
  }
  if (!key.edges_vertices.present || key.edges_vertices.rows() == 0) {
    return fail(ErrorKind::Malformed, "/edges_vertices", "missing; a pattern needs edges");
  }
  const auto scale = millimetres(key);
  if (!scale) return tl::unexpected(scale.error());

  FoldModel file;
  file.flat.resize(key.vertices_coords.rows());
  file.faces_given = key.faces_vertices.present;
  if (key.unit.empty() || key.unit == "unit")
    file.notes.emplace_back("the file gives no unit; lengths are read as mm");
  if (auto read = read_edges(key, file); !read) return tl::unexpected(read.error());
  if (auto read = read_assignments(key, file); !read) return tl::unexpected(read.error());
  if (key.edges_fold_angle.present) {
    auto angles = fold_angles(key, file.edges.size());
    if (!angles) return tl::unexpected(angles.error());
    file.fold_angle_deg = std::move(*angles);
  }
  if (file.faces_given) {
    if (auto read = read_faces(key, file); !read) return tl::unexpected(read.error());
  }
  file.design_psi_rad = key.design_psi_rad;
  if (auto read = read_model_placement(key, file); !read) return tl::unexpected(read.error());
  auto poses = read_poses(frames, *scale, file);
  if (!poses) return tl::unexpected(poses.error());
  if (auto chosen = choose_flat(frames, std::move(*poses), file); !chosen)
    return tl::unexpected(chosen.error());
  return file;
}

}  // namespace popcut::verify
