// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/plan/order/order.hpp"
#include "core/warning.hpp"

namespace popcut {

/// The direction of closed cuts and outlines, as seen on the sheet.
enum class CutDirection : std::uint8_t { Any, Clockwise, CounterClockwise };

/// Options of a plan that override the material's knife settings.
struct KnifeOptions {
  std::optional<FoldMode> folds{};
  std::optional<double> overcut_mm{};
  CutDirection direction{CutDirection::Any};
};

/// Tool, force and speed of each kind of stroke and each pen, within the limits of the machine.
/// Warns once per kind and pen.
class StrokeSettings {
 public:
  /// @param material  must outlive this object, as must `warnings`
  StrokeSettings(const Machine& machine, const Material& material, FoldMode folds,
                 std::vector<Warning>& warnings);
  const ToolSettings& of(PenOperation operation);
  /// How folds without room for a dash are scored instead: cut half through where the machine sets
  /// its force, else pressed with a stylus where there is a holder for it; none: they cannot be.
  [[nodiscard]] static std::optional<ToolSettings> scoring(const Machine& machine,
                                                           const Material& material);
  const ToolSettings& scored();
  /// The force of pass number `pass` (from 0), within the limits of the machine, in gf.
  [[nodiscard]] double force_gf(const ToolSettings& tool, int pass) const;

 private:
  const ToolSettings& fitted(std::size_t kind, std::uint8_t pen);
  void fit(ToolSettings& tool, const std::string& kind);
  void fit_scale(double& value, const SteppedScale& scale, const std::string& kind,
                 const char* what, const char* unit);

  const Machine& machine_;
  std::vector<Warning>& warnings_;
  std::span<const PenSettings> pens_;
  std::array<ToolSettings, 5> tools_;  ///< draw, score, fold, cut, folds scored for want of room
  std::vector<std::optional<ToolSettings>> fitted_;  ///< by pen, then by kind; once it was used
};

/// Makes all closed cuts and outlines go in the same direction.
void turn_round(LineWork& work, CutDirection direction);

/// Strokes in the order of `visits`, as drawn. Further passes of a closed line follow without
/// lifting; those of an open line go back along it. If each pass has its own force, every pass is a
/// separate stroke.
struct DrawnStrokes {
  Toolpath path;
  std::uint16_t blade_tools{};  ///< bit n: tool holder n holds a blade
};

/// Makes the strokes of `visits` with the tool settings of each operation.
[[nodiscard]] DrawnStrokes make_strokes(const Dashed& dashed, const std::vector<Visit>& visits,
                                        StrokeSettings& settings);

/// What the knife adds to strokes; see `blade.hpp`.
struct KnifeWork {
  double overcut_mm{};
  int rounds{1};             ///< rounds of a closed cut in one stroke; the fewest of all pens
  double blade_offset_mm{};  ///< offset that popcut compensates; 0: the firmware does
  double swivel_above_rad{};
  std::uint16_t blade_tools{};

  [[nodiscard]] bool blade(int tool) const { return (blade_tools >> tool & 1) != 0; }
};

/// The strokes as they are sent, one for one; none if they are sent as drawn.
[[nodiscard]] std::optional<Toolpath> sent_strokes(const Toolpath& drawn, const KnifeWork& knife);

/// What the knife does besides the drawing: overcuts as the tip cuts them, and entry rotations as
/// the axis moves.
struct KnifeMarks {
  struct Mark {
    std::uint32_t stroke{}, first{}, count{};  ///< points `first .. first + count`
  };
  std::vector<PagePoint> points;
  std::vector<Mark> overcuts, lead_ins;

  [[nodiscard]] std::span<const PagePoint> points_of(const Mark& mark) const {
    return std::span(points).subspan(mark.first, mark.count);
  }
};

/// Overcuts and entry rotations of the strokes, for drawing them: of all, or of `strokes` from
/// `first_stroke` on, because those of all of a large drawing are many.
[[nodiscard]] KnifeMarks knife_marks(const Toolpath& drawn, const KnifeWork& knife,
                                     std::size_t first_stroke = 0,
                                     std::size_t strokes = static_cast<std::size_t>(-1));

}  // namespace popcut
