// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/plan/marks.hpp"
#include "core/result.hpp"
#include "core/drawing/toolpath.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// Bytes `begin .. end` of a program.
struct ByteRange {
  std::uint64_t begin{};
  std::uint64_t end{};
  friend constexpr auto operator<=>(const ByteRange&, const ByteRange&) = default;
};

/// A program as it is sent: `setup` blocks, then `geometry`, then `trailer`, with nothing between
/// them. A session waits until the device is ready after the setup, the geometry and the trailer.
///
/// Every range ends at the end of a command. The strokes' ranges follow each other without gaps
/// and fill the geometry: a stroke's bytes are the settings that changed before it, the move with
/// the tool up to its start, and its lines. No queries are part of a program.
struct EncodedProgram {
  Dialect dialect{};
  std::string bytes;
  std::vector<ByteRange> setup;
  ByteRange geometry;
  ByteRange trailer;
  std::vector<ByteRange> strokes;   ///< one a stroke of the toolpath, in its order
  std::vector<std::uint32_t> dots;  ///< strokes all of whose points round to one unit: not sent,
                                    ///< their range is empty, and whoever calls tells the user
  /// Between setup and geometry, if there are registration marks: the search for them, which the
  /// machine answers once. Nothing may follow before it has said that they are found.
  ByteRange search{};

  [[nodiscard]] std::span<const std::byte> view(ByteRange range) const {
    return std::as_bytes(std::span(bytes)).subspan(range.begin, range.end - range.begin);
  }
  [[nodiscard]] std::span<const std::byte> view() const { return std::as_bytes(std::span(bytes)); }
};

/// What a tool holder holds. A pen gets no blade offset and no longer corners.
enum class ToolKind : std::uint8_t { Blade, Pen };

/// How lines are written in GPGL.
enum class DrawForm : std::uint8_t {
  Usual,   ///< as the variant's own software does: BE from the Cameo 3 on, D before
  Text,    ///< D
  Binary,  ///< BE1, BE2, BE3
};

/// The words for moving and drawing.
enum class HpglWords : std::uint8_t {
  PenUpDown,  ///< PUx,y; PDx,y;
  UpDown,     ///< Ux,y; Dx,y; (some vinyl cutters)
  MoveDraw,   ///< Mx,y; Dx,y; (CAMM-GL mode 1, whose absolute points need no PA)
};

/// What HPGL machines differ in beside their units.
struct HpglHabits {
  HpglWords words{HpglWords::PenUpDown};
  bool move_by_pa{false};      ///< PU takes no point: `PU;PAx,y;`
  bool newline{false};         ///< a newline after each command
  bool speed_and_force{true};  ///< VS and FS are sent, where the machine's scales have steps
  bool final_in{true};         ///< the trailer ends with IN
  bool negative{false};        ///< negative coordinates are lawful
};

/// The habits that a machine's variant names: words joined by "+", as in "pa+newline".
///
/// generic, camm2: none of the others. pa: PU takes no point. newline: one after each command.
/// plain: no VS and FS. open: no final IN. ud: U and D for PU and PD. camm1: CAMM-GL mode 1.
/// negative: negative coordinates are lawful, as they are for camm1 and camm2.
///
/// @retval OutOfRange  a word that is none of these, or two that contradict each other
[[nodiscard]] Result<HpglHabits> hpgl_habits(std::string_view variant);

/// What a job adds to strokes, machine and material.
struct JobOptions {
  double page_width_mm{};         ///< page or mat along the carriage; 0: the machine's own width
  double page_length_mm{};        ///< page or mat along the feed; 0: the machine's own length
  std::optional<int> mat_code{};  ///< what TG sends; none: 0 (no mat) for machines that know mats
  double window_left_mm{};        ///< upper left corner of the working window
  double window_top_mm{};
  bool autoblade{true};  ///< false: a ratchet blade sits in the holder of the autoblade
  bool track_enhancing{false};
  bool corner_lift{false};                   ///< lift at sharp corners ("line segment overcut")
  std::optional<int> corner_start_tenths{};  ///< corner extension in 0.1 mm; none: as usual
  std::optional<int> corner_end_tenths{};
  /// What the holders 1, 2, ... hold. Those not listed: a pen if all strokes of the holder are
  /// drawn, else a blade.
  std::vector<ToolKind> holders{};
  DrawForm draw{DrawForm::Usual};
  bool fractions{false};             ///< GPGL: coordinates in hundredths of a unit, lines as D
  std::optional<HpglHabits> hpgl{};  ///< none: those of the machine's variant
  /// GPGL: registration marks to search first; coordinates are then counted from their corner.
  std::optional<MarkLayout> marks{};
};

/// Options for a job on a mat.
[[nodiscard]] inline JobOptions on_mat(const Mat& mat) {
  return {.page_width_mm = mat.width_mm, .page_length_mm = mat.length_mm, .mat_code = mat.code};
}

/// Writes a toolpath as a program for `machine`, in its language and variant.
///
/// Coordinates are rounded to the nearest unit, half away from zero. Points that round to the same
/// unit as the one before them are left out. Settings are sent with the first stroke's values and
/// again between strokes, but only those that change. Force and speed go to the nearest step.
///
/// @retval OutOfRange  a force, speed, tool, depth or coordinate that the machine does not take;
/// the
///                     place is the stroke (`/strokes/N`) or the field of the machine
[[nodiscard]] Result<EncodedProgram> encode(const Toolpath& toolpath, const Machine& machine,
                                            const Material& material,
                                            const JobOptions& options = {});

/// What lifts the tool where stroke `index` of a program ends, for a pause between strokes: a move
/// to where it stands. Empty for a dot.
[[nodiscard]] std::string lift_after(const EncodedProgram& program, std::size_t index);

/// What is left of a program from stroke `first` on, as a program of its own: the whole setup, the
/// settings that earlier strokes changed, the search for marks if there is one, the strokes from
/// `first` on (each begins with a move, tool up), and the trailer. Stroke 0 of it is `first`.
///
/// @retval OutOfRange  there is no such stroke
/// @retval Malformed   a stroke before it cannot be read
[[nodiscard]] Result<EncodedProgram> rest_of(const EncodedProgram& program, std::size_t first);

/// The commands of GPGL that make a machine search registration marks (inkscape-silhouette).
[[nodiscard]] std::string mark_search(const MarkLayout& marks, const Machine& machine);

/// `encode` for machines whose language is gpgl.
[[nodiscard]] Result<EncodedProgram> encode_gpgl(const Toolpath& toolpath, const Machine& machine,
                                                 const Material& material,
                                                 const JobOptions& options = {});

/// `encode` for machines whose language is hpgl. Negative coordinates are an error unless the
/// machine's habits take them: many machines that speak HPGL take none.
[[nodiscard]] Result<EncodedProgram> encode_hpgl(const Toolpath& toolpath, const Machine& machine,
                                                 const Material& material,
                                                 const JobOptions& options = {});

}  // namespace popcut
