// SPDX-License-Identifier: MIT
#include "core/design/slices/sliced_card.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/design/slices/thin_walls.hpp"
#include "core/design/target/surface.hpp"
#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr double kMargin_mm = 8.0;  ///< of the pages, around all that is shut
constexpr double kTab_mm = 7.0;
constexpr double kLeastSize_mm = 15.0;
constexpr double kLift_mm = 0.3;    ///< of slices that are not glued, over the pages
constexpr double kBeside_mm = 4.0;  ///< between the target and the slices x = 0 and y = 0
constexpr double kEnd_mm = 3.0, kFootEnd_mm = 8.0;  ///< of a strip beyond its last crossing
constexpr double kLeastFoot_mm = 30.0;
constexpr double kSmooth_mm = 0.02;  ///< by which outlines stray from the section
constexpr double kLeast_mm2 = 15.0;
constexpr double kContact_mm = 2.0;       ///< of a slice with the ground, that it stands there
constexpr double kMostOpen = 0.1;         ///< of a mesh's sections: gaps around lids, open seams
constexpr std::size_t kMostPieces = 390;  ///< parts of a card that verify reads
constexpr std::size_t kMostCrossings = 3990;                ///< joints that it reads
constexpr std::size_t kMostBlanks = 3000;                   ///< islands and grounds before slots
constexpr std::size_t kMostCorners = 300'000;               ///< of all outlines
constexpr double kThinWall_mm = 1.5, kThinLength_mm = 5.0;  ///< beside slots

struct Box {
  Vec3 low, high;
};

Box box_of_soup(const TriangleSoup& soup) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box out{Vec3::Constant(kFar), Vec3::Constant(-kFar)};
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      out.low = out.low.cwiseMin(soup.corner(t, k)),
      out.high = out.high.cwiseMax(soup.corner(t, k));
  return out;
}

template <typename Map>
void move_corners(TriangleSoup& soup, const Map& map) {
  for (std::size_t k = 0; k + 2 < soup.corners.size(); k += 3) {
    const Vec3 to = map(Vec3(soup.corners.data() + k));
    std::copy(to.data(), to.data() + 3, soup.corners.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

/// How far slices reach beyond x = 0 and y = 0, so that their slots there have two walls.
double lip_mm(const SlicesSpec& asked, double f) {
  return std::min(3.0, 0.2 * asked.base_mm / std::tan(f));
}
/// How far the target's foot is below the top of the strips.
double sunk_mm(const SlicesSpec& asked) { return std::min(6.0, 0.5 * asked.base_mm); }

/// The surface in the frame: all of x and y above 0, its foot a little below the strips' top.
Result<TriangleSoup> frame_target(const DesignSpec& spec, const SurfaceAssets& assets) {
  TargetPlacement placement = spec.placement;
  placement.translate_mm = {1e4, 0.0, 1e4};  // away from wall and ground, which take triangles
  const auto surface = Surface::make(*spec.surface, placement, FitMode::Nearest, assets);
  if (!surface) return tl::unexpected(surface.error());
  TriangleSoup soup = surface->triangles({});
  if (soup.size() == 0) return fail(ErrorKind::Infeasible, "/surface", "has no surface");
  const SlicesSpec& asked = spec.sliced;
  const double f = radians(asked.frame_deg), half = 0.25 * std::numbers::pi;
  // The bisector of the target's x and y runs along the spine.
  const double along = std::cos(half) / (2.0 * std::cos(f)),
               across = std::sin(half) / (2.0 * std::sin(f));
  move_corners(soup, [&](const Vec3& p) {
    const double sum = along * (p.x() + p.y()), off = across * (p.x() - p.y());
    return Vec3{sum + off, sum - off, p.z()};
  });
  const Box box = box_of_soup(soup);
  const Vec3 size = box.high - box.low;
  if (size.minCoeff() < kLeastSize_mm)
    return fail(ErrorKind::Infeasible, "/scale_mm",
                fmt::format("makes the shape {:.3g} x {:.3g} mm wide and {:.3g} mm high; slices "
                            "need at least {:g} mm: give a larger one",
                            size.x(), size.y(), size.z(), kLeastSize_mm));
  const Vec3 to{kBeside_mm, kBeside_mm, asked.base_mm - sunk_mm(asked)};
  move_corners(soup, [&](const Vec3& p) { return Vec3(p - box.low + to); });
  return soup;
}

FlatRings turned(FlatRings rings) {
  for (std::vector<Vec2>& ring : rings)
    for (Vec2& p : ring) std::swap(p.x(), p.y());
  return rings;
}

double paper_length(const FlatRings& shape, double u_mm) {
  double sum = 0.0;
  for (const PaperSpan& span : paper_at(shape, u_mm)) sum += span.length();
  return sum;
}

/// Planes at equal distances across the target, moved so that as many as can be meet its foot.
std::vector<double> plane_places(double from, double to, int count, const FlatRings& foot) {
  constexpr int kPhases = 14;
  constexpr double kMostPhase = 0.35;
  const double step = (to - from) / count;
  std::vector<double> best;
  std::ptrdiff_t most = -1;
  for (int n = 0; n <= 2 * kPhases; ++n) {
    const double phase = (n % 2 == 0 ? 1.0 : -1.0) * kMostPhase * ((n + 1) / 2) / kPhases;
    std::vector<double> at;
    for (int k = 0; k < count; ++k) at.push_back(from + (k + 0.5 + phase) * step);
    const std::ptrdiff_t meet = std::count_if(
        at.begin(), at.end(), [&](double u) { return paper_length(foot, u) >= kContact_mm; });
    if (meet > most) most = meet, best = std::move(at);
  }
  return best;
}

/// The strip below a slice from x = 0 or y = 0 on, with its lip beyond it.
FlatRings strip(const SlicesSpec& asked, double f, double lift, double end) {
  const double lip = lip_mm(asked, f);
  return {{{0.0, lift},
           {end, lift},
           {end, asked.base_mm},
           {-lip, asked.base_mm},
           {-lip, lift + 2.0 * std::tan(f) * lip}}};
}

/// One family of slices: its sections, and which of them stand on the ground.
struct Family {
  std::vector<double> at_mm;
  std::vector<FlatRings> sections;
  std::vector<bool> is_ground;
  std::size_t gaps{};
  double gaps_mm{};

  /// The last slice that stands on the ground; 0 if none does.
  [[nodiscard]] double last_ground() const {
    double last = 0.0;
    for (std::size_t k = 0; k < at_mm.size(); ++k)
      if (is_ground[k]) last = at_mm[k];
    return last;
  }
};

Result<Family> family_of(const TriangleSoup& mesh, int axis, int count, const FlatRings& foot) {
  const Box box = box_of_soup(mesh);
  Family out;
  out.at_mm = plane_places(box.low[axis], box.high[axis], count, foot);
  auto sections = plane_sections(mesh, axis, out.at_mm, kMostOpen);
  if (!sections) return tl::unexpected(sections.error());
  out.gaps = sections->gaps, out.gaps_mm = sections->gaps_mm;
  for (std::size_t k = 0; k < out.at_mm.size(); ++k) {
    out.sections.push_back(with_fewer_points(inside_of(sections->planes[k]), kSmooth_mm));
    out.is_ground.push_back(paper_length(foot, out.at_mm[k]) >= kContact_mm);
  }
  if (out.last_ground() == 0.0)
    return fail(ErrorKind::Infeasible, axis == 0 ? "/sliceform/x_slices" : "/sliceform/y_slices",
                fmt::format("is {}; none of these slices meets the shape's foot, so nothing would "
                            "hold them: give more",
                            count));
  return out;
}

void add_slices(const SlicesSpec& asked, double f, SliceFamily which, const Family& own,
                double last_other, std::vector<Slice>& out) {
  const double end = last_other + kEnd_mm;
  out.push_back({which,
                 0.0,
                 true,
                 strip(asked, f, 0.0, std::max(last_other + kFootEnd_mm, kLeastFoot_mm)),
                 {}});
  for (std::size_t k = 0; k < own.at_mm.size(); ++k) {
    Slice slice{which, own.at_mm[k], false, {}, {}};
    if (own.is_ground[k]) {
      const FlatRings whole = joined(own.sections[k], strip(asked, f, kLift_mm, end));
      for (FlatRings& piece : pieces_of(whole)) {
        FlatRings& to = paper_at(piece, 0.0).empty() ? slice.islands : slice.ground;
        to.insert(to.end(), piece.begin(), piece.end());
      }
    } else {
      slice.islands = own.sections[k];
    }
    out.push_back(std::move(slice));
  }
}

/// What a place in the frame needs of a shut card: from the spine outward, and along it.
Vec2 shut_place(const Vec3& p, double f) {
  return {(p.x() + p.y()) * std::sin(f) + p.z() * std::cos(f),
          (p.x() + p.y()) * std::cos(f) - p.z() * std::sin(f)};
}

Vec3 in_frame(const Slice& slice, Vec2 at) {
  return slice.family == SliceFamily::X ? Vec3{slice.at_mm, at.x(), at.y()}
                                        : Vec3{at.x(), slice.at_mm, at.y()};
}

/// The lengths that a card of the spec has, or those that are needed.
Result<void> set_pages(const SlicesSpec& asked, SlicedCard& out) {
  Eigen::AlignedBox2d shut;
  for (const SlicePiece& piece : out.lattice.pieces)
    for (const Vec2& at : piece.paper.front())
      shut.extend(shut_place(in_frame(out.slices[piece.slice], at), out.frame_rad));
  double page = shut.max().x() + kMargin_mm, spine = shut.sizes().y() + 2.0 * kMargin_mm;
  out.origin_mm = kMargin_mm - shut.min().y();
  const auto check = [](const std::optional<double>& given, double& needed, const char* field,
                        const char* what) -> Result<void> {
    if (!given) return {};
    if (*given < needed)
      return fail(ErrorKind::Infeasible, fmt::format("/sliceform/{}", field),
                  fmt::format("is {:g}; the slices need {} of at least {:.4g} mm, or a smaller "
                              "scale_mm",
                              *given, what, needed));
    needed = *given;
    return {};
  };
  const double needed = spine;
  if (auto done = check(asked.page_mm, page, "page_mm", "pages"); !done) return done;
  if (auto done = check(asked.spine_mm, spine, "spine_mm", "a spine"); !done) return done;
  out.origin_mm += 0.5 * (spine - needed);
  const std::string name = std::move(out.card.name);
  out.card = plain_card(page, spine);
  out.card.name = name;
  out.card.tab_mm = kTab_mm;
  out.card.thickness_mm = asked.paper_mm;
  return {};
}

/// Where a slice of a family lies in a seat's axes.
Eigen::Isometry3d slice_pose(SliceFamily family, double at_mm, double f, const SeatFrame& seat) {
  const Vec3 along{0.0, 1.0, 0.0};
  const Vec3 x = std::cos(f) * along + std::sin(f) * seat.out(1.0),
             y = std::cos(f) * along + std::sin(f) * seat.out(-1.0);
  const Vec3 z = unit(cross(x, y));
  const bool is_x = family == SliceFamily::X;
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const Vec3 u = is_x ? y : x;
  out.linear().col(0) = u, out.linear().col(1) = z, out.linear().col(2) = cross(u, z);
  out.translation() = at_mm * (is_x ? x : y);
  return out;
}

void add_parts(SlicedCard& out) {
  const std::vector<std::string> names = piece_names(out);
  struct Place {
    SliceFamily family{};
    double at_mm{};
    std::size_t faces{};
  };
  std::vector<Place> places;
  for (std::size_t p = 0; p < out.lattice.pieces.size(); ++p) {
    const SlicePiece& piece = out.lattice.pieces[p];
    SheetPart part;
    part.name = names[p];
    for (const std::vector<Vec2>& face : faces_of_piece(piece.paper)) part.add_face(face);
    if (part.faces.size() > 1)
      for (const Vec2& at : std::vector<Vec2>(part.vertices)) part.add_corner(at);
    const Slice& slice = out.slices[piece.slice];
    places.push_back({slice.family, slice.at_mm, part.faces.size()});
    out.card.parts.push_back(std::move(part));
  }
  for (const SliceCrossing& one : out.lattice.crossings) {
    const double x = out.slices[out.lattice.pieces[one.x_piece].slice].at_mm,
                 y = out.slices[out.lattice.pieces[one.y_piece].slice].at_mm;
    out.card.joints.push_back({PartJointKind::Cross,
                               {1 + one.x_piece, 0, {Vec2{y, one.from_mm}, Vec2{y, one.to_mm}}},
                               {1 + one.y_piece, 0, {Vec2{x, one.from_mm}, Vec2{x, one.to_mm}}}});
  }
  Element element;
  element.seat = spine_of(out.card);
  element.seat.left.origin = element.seat.right.origin = Vec2{0.0, out.origin_mm};
  element.first_part = 1, element.parts = places.size();
  element.pose = [places, f = out.frame_rad](const SeatFrame& seat) {
    PartPoses poses;
    for (const Place& one : places)
      poses.emplace_back(one.faces, slice_pose(one.family, one.at_mm, f, seat));
    return poses;
  };
  out.card.elements.push_back(std::move(element));
}

/// Glues the slices x = 0 and y = 0 to the pages, with tabs between them and the spine: there they
/// lie flat beside the slices when the card is shut. Adds the lengths of their folds.
void glue_feet(SlicedCard& out, std::vector<double>& folds) {
  const double f = out.frame_rad;
  for (const std::size_t side : {0u, 1u}) {
    const std::size_t number = 1 + out.lattice.feet[side];
    SheetPart& part = out.card.parts[number];
    double end = 0.0;
    for (const Vec2& p : part.vertices)
      if (p.y() == 0.0) end = std::max(end, p.x());
    // Corners that are cut away at 45 degrees keep the tab on its page.
    const double from = std::max(1.0, kTab_mm / std::tan(f) - kTab_mm + 1.0), to = end - 1.0;
    for (const Vec2& at : {Vec2{from, 0.0}, Vec2{to, 0.0}}) part.add_corner(at);
    const std::uint32_t tab =
        part.add_face(std::array{Vec2{from, 0.0}, Vec2{from + kTab_mm, -kTab_mm},
                                 Vec2{to - kTab_mm, -kTab_mm}, Vec2{to, 0.0}});
    part.tabs.push_back(tab);
    for (const Vec2& at : std::vector<Vec2>(part.vertices)) part.add_corner(at);
    const Vec2 along{(side == 0 ? -1.0 : 1.0) * std::sin(f), std::cos(f)},
        origin{0.0, out.origin_mm};
    out.card.joints.push_back({PartJointKind::Glue,
                               {number, tab, {Vec2{from, 0.0}, Vec2{to, 0.0}}},
                               {0,
                                static_cast<std::uint32_t>(side),
                                {Vec2(origin + from * along), Vec2(origin + to * along)}},
                               side == 1});
    folds.push_back(to - from);  // slots part it, but a person folds it as one
  }
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMostListed = 12;
  const std::size_t shown = std::min(names.size(), kMostListed);
  const std::string list = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return shown < names.size() ? fmt::format("{} and {} more", list, names.size() - shown) : list;
}

std::string slice_name(const std::vector<Slice>& slices, std::size_t slice) {
  std::size_t first = 0;
  while (slices[first].family != slices[slice].family) ++first;
  return fmt::format("{}{}", slices[slice].family == SliceFamily::X ? 'x' : 'y', slice - first);
}

void warn_of_drops(const SlicedCard& made, DroppedPiece::Reason reason, const char* code,
                   const char* why, std::vector<Warning>& out) {
  std::vector<std::string> names;
  double area = 0.0;
  std::size_t count = 0;
  for (const DroppedPiece& one : made.lattice.dropped) {
    if (one.reason != reason) continue;
    const std::string name = slice_name(made.slices, one.slice);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    area += one.area_mm2, ++count;
  }
  if (count == 0) return;
  out.push_back({.code = code,
                 .message = fmt::format("{} piece{} of paper, {:.0f} mm2 together, {} left out: {} "
                                        "(of {})",
                                        count, count == 1 ? "" : "s", area,
                                        count == 1 ? "is" : "are", why, listed(names))});
}

/// Walls beside slots that may tear: those between two slots, or those at the solid's outline.
void warn_of_thin_walls(const SlicedCard& made, bool between_slots, std::vector<Warning>& out) {
  const std::vector<std::string> names = piece_names(made);
  std::vector<std::string> walls;
  bool in_x = false, in_y = false;
  for (const ThinWall& wall :
       thin_walls(made.slices, made.lattice, made.slot_mm, kThinWall_mm, kThinLength_mm)) {
    if (wall.is_between_slots != between_slots) continue;
    walls.push_back(fmt::format("{} ({:.1f} mm over {:.0f} mm, beside {})", names[wall.piece],
                                wall.thick_mm, wall.length_mm, names[wall.other]));
    const bool is_x = made.slices[made.lattice.pieces[wall.other].slice].family == SliceFamily::X;
    (is_x ? in_x : in_y) = true;
  }
  if (walls.empty()) return;
  const char* fields = !in_x ? "y_slices" : !in_y ? "x_slices" : "x_slices or y_slices";
  out.push_back(
      {.code = between_slots ? "slots_crowded" : "walls_thin",
       .message = fmt::format(
           "paper beside slots is thinner than {} mm and may tear, in {} piece{}: {}; {}",
           kThinWall_mm, walls.size(), walls.size() == 1 ? "" : "s", listed(walls),
           between_slots
               ? fmt::format("the slots are too near to each other: give fewer {}, or a larger "
                             "scale_mm",
                             fields)
               : fmt::format("the slots run along the edge of the solid: one more or one fewer of "
                             "{} moves them",
                             fields))});
}

void add_warnings(SlicedCard& out) {
  using Reason = DroppedPiece::Reason;
  std::vector<Warning>& warnings = out.warnings;
  warn_of_drops(out, Reason::Small, "parts_dropped", "too small to cut", warnings);
  warn_of_drops(out, Reason::Loose, "islands_dropped",
                "too few crossings hold them; more slices may hold them", warnings);
  warn_of_drops(out, Reason::Blocked, "islands_blocked",
                "paper of the same slice above them is in the way when they are put in", warnings);
  const std::vector<std::string> names = piece_names(out);
  std::vector<std::string> kept;
  for (std::size_t p = 0; p < names.size(); ++p)
    if (out.lattice.pieces[p].is_island) kept.push_back(names[p]);
  if (!kept.empty())
    warnings.push_back(
        {.code = "islands_kept",
         .message = fmt::format("{} piece{} not on the ground {} held by slots only: "
                                "{}",
                                kept.size(), kept.size() == 1 ? "" : "s",
                                kept.size() == 1 ? "is" : "are", listed(kept))});
  if (out.lattice.cleared > 0)
    warnings.push_back(
        {.code = "crossings_cleared",
         .message = fmt::format("slices would cross {} more time{} above or below their slots; one "
                                "of them is cut through there, so that it can be put in",
                                out.lattice.cleared, out.lattice.cleared == 1 ? "" : "s")});
  for (const bool between_slots : {false, true}) warn_of_thin_walls(out, between_slots, warnings);
}

/// Whether slices can be cut in a time that a person waits for.
Result<void> check_effort(const std::vector<Slice>& slices) {
  std::size_t corners = 0, blanks = 0;
  for (const Slice& slice : slices)
    for (const FlatRings* rings : {&slice.ground, &slice.islands})
      for (const std::vector<Vec2>& ring : *rings) {
        corners += ring.size();
        if (area_of({ring}) > 0.0) ++blanks;
      }
  if (blanks > kMostBlanks)
    return fail(ErrorKind::Infeasible, "/sliceform",
                fmt::format("cuts the shape into {} separate pieces of paper; at most {} can be "
                            "looked at: give fewer slices, or a shape of fewer parts",
                            blanks, kMostBlanks));
  if (corners > kMostCorners)
    return fail(ErrorKind::Infeasible, "/sliceform",
                fmt::format("makes outlines of {} corners together; at most {} can be cut: give "
                            "fewer slices, a smaller scale_mm, or a smoother shape",
                            corners, kMostCorners));
  return {};
}

}  // namespace

std::vector<std::string> piece_names(const SlicedCard& made) {
  std::map<std::size_t, std::size_t> count;
  for (const SlicePiece& piece : made.lattice.pieces) ++count[piece.slice];
  std::map<std::size_t, std::size_t> number;
  std::vector<std::string> out;
  for (const SlicePiece& piece : made.lattice.pieces) {
    std::string name = slice_name(made.slices, piece.slice);
    if (count[piece.slice] > 1) name += fmt::format("-{}", ++number[piece.slice]);
    out.push_back(std::move(name));
  }
  return out;
}

Result<SlicedCard> sliced_card(const DesignSpec& spec, const SurfaceAssets& assets,
                               const Progress& progress) {
  tell(progress, "reading the shape");
  const SlicesSpec& asked = spec.sliced;
  SlicedCard out;
  out.card.name = spec.name;
  out.frame_rad = radians(asked.frame_deg);
  out.base_mm = asked.base_mm;
  out.slot_mm = asked.looseness * asked.paper_mm / std::sin(2.0 * out.frame_rad);
  auto mesh = frame_target(spec, assets);
  if (!mesh) return tl::unexpected(mesh.error());
  tell(progress, "cutting the shape into slices");
  const std::array foot_at{asked.base_mm - 0.5 * sunk_mm(asked)};
  const auto foot = plane_sections(*mesh, 2, foot_at, kMostOpen);
  if (!foot) return tl::unexpected(foot.error());
  const FlatRings stands = inside_of(foot->planes.front());
  const auto x = family_of(*mesh, 0, asked.x_slices, stands);
  if (!x) return tl::unexpected(x.error());
  const auto y = family_of(*mesh, 1, asked.y_slices, inside_of(turned(stands)));
  if (!y) return tl::unexpected(y.error());
  add_slices(asked, out.frame_rad, SliceFamily::X, *x, y->last_ground(), out.slices);
  add_slices(asked, out.frame_rad, SliceFamily::Y, *y, x->last_ground(), out.slices);
  if (auto done = check_effort(out.slices); !done) return tl::unexpected(done.error());
  tell(progress, "cutting the slots");
  out.lattice = cross_slices(out.slices, {.width_mm = out.slot_mm}, kLeast_mm2);
  if (out.lattice.pieces.size() < 4)
    return fail(ErrorKind::Infeasible, "/sliceform",
                "leaves no slices that hold each other; give more slices, or a larger scale_mm");
  if (out.lattice.pieces.size() > kMostPieces)
    return fail(ErrorKind::Infeasible, "/sliceform",
                fmt::format("makes {} pieces of paper; at most {} can be made: give fewer slices",
                            out.lattice.pieces.size(), kMostPieces));
  if (out.lattice.crossings.size() > kMostCrossings)
    return fail(ErrorKind::Infeasible, "/sliceform",
                fmt::format("makes {} crossings; at most {} can be checked: give fewer slices",
                            out.lattice.crossings.size(), kMostCrossings));
  if (!comes_down_freely(out.slices, out.lattice))
    return fail(ErrorKind::Internal, "/sliceform",
                "makes pieces that cannot be put together, which is a fault in popcut: report it "
                "with the design, and try other numbers of slices");
  if (auto done = set_pages(asked, out); !done) return tl::unexpected(done.error());
  add_parts(out);
  std::vector<double> folds{out.card.length_mm};
  glue_feet(out, folds);
  out.folds = folds.size(), out.tabs = 2;
  std::size_t waste = 0;
  for (const SlicePiece& piece : out.lattice.pieces) waste += piece.paper.size() - 1;  // its holes
  out.handwork = hands::handwork(folds, waste, out.tabs);
  const double f = out.frame_rad;
  out.frame_target = std::move(*mesh);
  out.target = out.frame_target;
  move_corners(out.target, [&](const Vec3& p) {
    return Vec3{(p.x() - p.y()) * std::sin(f), out.origin_mm + (p.x() + p.y()) * std::cos(f),
                p.z()};
  });
  if (const std::size_t gaps = x->gaps + y->gaps; gaps > 0)
    out.warnings.push_back(
        {.code = "gaps_closed",
         .message = fmt::format("the mesh is open at {} place{} of the slices, {:.2g} mm together; "
                                "straight lines close {}",
                                gaps, gaps == 1 ? "" : "s", x->gaps_mm + y->gaps_mm,
                                gaps == 1 ? "it" : "them")});
  add_warnings(out);
  return out;
}

}  // namespace popcut
