// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/marks.hpp"
#include "core/result.hpp"
#include "protocol/encoded_program.hpp"

namespace popcut {

/// What is in a tool holder. A pen gets no blade offset and no corner extension.
enum class ToolKind : std::uint8_t { Blade, Pen };

/// How lines are written in GPGL.
enum class DrawForm : std::uint8_t {
  Usual,   ///< like the variant's own software: BE from the Cameo 3 on, D before
  Text,    ///< D
  Binary,  ///< BE1, BE2, BE3
};

/// The commands for moving and drawing.
enum class HpglWords : std::uint8_t {
  PenUpDown,  ///< PUx,y; PDx,y;
  UpDown,     ///< Ux,y; Dx,y; (some vinyl cutters)
  MoveDraw,   ///< Mx,y; Dx,y; (CAMM-GL mode 1, whose absolute points need no PA)
};

/// How HPGL machines differ, apart from their units.
struct HpglHabits {
  HpglWords words{HpglWords::PenUpDown};
  bool move_by_pa{false};      ///< PU takes no point: `PU;PAx,y;`
  bool newline{false};         ///< a newline after each command
  bool speed_and_force{true};  ///< VS and FS are sent, where the machine's scales have steps
  bool final_in{true};         ///< the trailer ends with IN
  bool negative{false};        ///< negative coordinates are valid
};

/// The habits that a machine's variant names: words joined by "+", as in "pa+newline".
///
/// generic: no habit. pa: PU takes no point. newline: one after each command. plain: no VS and FS.
/// open: no final IN. ud: U and D instead of PU and PD. camm1: CAMM-GL mode 1, with negative
/// coordinates. camm2, negative: negative coordinates are valid.
///
/// @retval OutOfRange  an unknown word, or two words that contradict each other
[[nodiscard]] Result<HpglHabits> hpgl_habits(std::string_view variant);

/// Options of a job, in addition to strokes, machine and material.
struct JobOptions {
  double page_width_mm{};         ///< page or mat along the carriage; 0: the machine's own width
  double page_length_mm{};        ///< page or mat along the feed; 0: the machine's own length
  std::optional<int> mat_code{};  ///< sent with TG; none: 0 (no mat) for machines with mats
  double window_left_mm{};        ///< upper left corner of the working window
  double window_top_mm{};
  bool autoblade{true};   ///< false: the autoblade's holder has a ratchet blade in it
  bool ask_blade{false};  ///< the autoblade's depth is for machines that report an autoblade only
  /// Rolls the sheet in and out before the cut. None: the program leaves it as it is set.
  std::optional<bool> track_enhancing{};
  /// Where the tool goes after the trailer, past the last place that was cut, mm; none: it stays
  /// where it parks. In GPGL that is the origin of the next job.
  std::optional<double> feed_out_mm{};
  bool corner_lift{false};                   ///< lift at sharp corners ("line segment overcut")
  std::optional<int> corner_start_tenths{};  ///< corner extension in 0.1 mm; none: the variant's
  std::optional<int> corner_end_tenths{};
  /// What is in the holders 1, 2, ... A holder that is not listed has a pen if all its strokes are
  /// drawn, else a blade.
  std::vector<ToolKind> holders{};
  DrawForm draw{DrawForm::Usual};
  bool fractions{false};             ///< GPGL: coordinates in hundredths of a unit, lines as D
  std::optional<HpglHabits> hpgl{};  ///< none: those of the machine's variant
  /// GPGL: registration marks to find first; coordinates then count from their corner.
  std::optional<MarkLayout> marks{};
};

/// A program that moves the tool, up, once around `box` (page mm), so that a person sees where the
/// sheet will be cut. It lowers nothing: it is written as a cut of the box, and every line of that
/// is then turned into a move.
///
/// @retval Internal  a line would be left
/// @retval as `encode`
[[nodiscard]] Result<EncodedProgram> frame_of(const Box& box, const Machine& machine,
                                              const Material& material, JobOptions options);

/// Options for a job on a mat.
[[nodiscard]] inline JobOptions on_mat(const Mat& mat) {
  return {.page_width_mm = mat.width_mm, .page_length_mm = mat.length_mm, .mat_code = mat.code};
}

/// Writes a toolpath as a program for `machine`, in its language and variant.
///
/// Coordinates are rounded to the nearest unit, half away from zero. A point that rounds to the
/// same unit as the one before it is left out. The setup has the first stroke's settings; later
/// only settings that change are sent, between strokes. Force and speed are rounded to the nearest
/// step.
///
/// @retval OutOfRange  a force, speed, tool, depth or coordinate that the machine does not take;
/// the
///                     place is the stroke (`/strokes/N`) or the field of the machine
[[nodiscard]] Result<EncodedProgram> encode(const Toolpath& toolpath, const Machine& machine,
                                            const Material& material,
                                            const JobOptions& options = {});

/// The GPGL commands that make a machine search for registration marks (inkscape-silhouette).
[[nodiscard]] std::string mark_search(const MarkLayout& marks, const Machine& machine);

/// `encode` for machines whose language is gpgl.
[[nodiscard]] Result<EncodedProgram> encode_gpgl(const Toolpath& toolpath, const Machine& machine,
                                                 const Material& material,
                                                 const JobOptions& options = {});

/// `encode` for machines whose language is hpgl. Many HPGL machines take no negative coordinates,
/// so they are an error unless the machine's habits allow them.
[[nodiscard]] Result<EncodedProgram> encode_hpgl(const Toolpath& toolpath, const Machine& machine,
                                                 const Material& material,
                                                 const JobOptions& options = {});

}  // namespace popcut
