// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/clean.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/knife/strokes.hpp"
#include "core/plan/order/order.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

struct Member;

/// What draws ticks and letters on pieces of an oversized drawing.
enum class LabelTool : std::uint8_t {
  Auto,  ///< the pen where the machine has a holder for it, else the knife
  Pen,
  Cut,  ///< as rows of short cuts
  None,
};

/// Which of TB51 and TB53 gives a registration mark's arm; sources disagree.
enum class MarkForm : std::uint8_t { Arm, Line };

/// Which blade the first holder has, on machines that can hold an autoblade.
enum class BladeKind : std::uint8_t {
  Auto,       ///< the one that the machine reports; its depth stays as it is where it reports none
  Autoblade,  ///< the machine sets it to the material's depth
  Ratchet,    ///< set by hand
};

/// Where the tool parks at the end: where it began, or below what was cut, so that the sheet is fed
/// out.
enum class Finish : std::uint8_t { Home, Below };

/// The unit of length of a file that names none, or the wrong one.
enum class LengthUnit : std::uint8_t { Auto, Mm, Cm, M, Inch, Foot, Point };
/// One unit in mm; none for Auto.
[[nodiscard]] std::optional<double> unit_mm(LengthUnit unit);

/// How a drawing becomes sheets. The members that a person may set are the rows of
/// `plan_option_table`; their defaults are those below.
struct PlanOptions {
  std::string machine{}, material{};  ///< names; empty: `make_plan_job` chooses
  std::string mat{};                  ///< name or size, see `choose_mat`; empty: the machine's own
  PlaceOptions place{};
  double scale{1};                   ///< of the drawing; see `drawing_transform`
  std::optional<double> width_mm{};  ///< of the drawing on the sheet, in place of `scale`
  double rotate_deg{0};              ///< clockwise
  bool mirror{false};                ///< cut the sheet as seen from behind
  std::uint64_t per_sheet{1};        ///< copies of the drawing, side by side
  std::string dialect{};             ///< "gpgl" or "hpgl"; empty: the machine's
  OrderOptions order{};              ///< its `cost` is the machine's
  double weed_box_mm{0};             ///< distance of a box around the drawing; 0: none
  std::string pens{};                ///< settings in place of the material's, see `with_pens`
  BladeKind blade{BladeKind::Auto};  ///< of a machine that can hold an autoblade
  bool track_enhancing{false};       ///< the sheet is rolled in and out before the cut
  Finish finish{Finish::Home};
  bool mat_free{false};  ///< without a mat: sets bands and corners of `order`
  CleanOptions clean{};
  KnifeOptions knife{};
  std::string svg_profile{"auto"};
  bool weld{false};          ///< filled shapes that lie over each other become one
  bool tells_doubles{true};  ///< warn of lines that run close beside each other
  std::string layers{};      ///< what names mean, see `parse_layer_uses`
  std::string colors{};      ///< what colours mean, see `parse_colour_uses`
  double curve_tolerance_mm{0.02}, svg_dpi{96};
  std::uint64_t pdf_page{1};                 ///< of a PDF, from 1
  LengthUnit units{LengthUnit::Auto};        ///< of DXF and FOLD files
  bool no_split{false};                      ///< a drawing that is too large is refused
  std::vector<double> seams_x{}, seams_y{};  ///< seams that were asked for, drawing mm
  LabelTool labels{LabelTool::Auto};
  std::size_t letters_taken{};  ///< by the tabs of a card of parts: seams have the next ones
  bool marks{false};            ///< the sheet is printed with registration marks
  MarkForm mark_form{MarkForm::Arm};
  /// In place of the machine's `MarkSearch`: left and top; empty: the machine's.
  std::vector<double> mark_start{}, mark_again{};
  bool keep_lines{false};  ///< the sheet keeps its lines as they were before folds were dashed
  Progress progress{};     ///< told before each step of a sheet
};

/// One option of a plan, as a row of the table from which everything else is made: the command
/// line, its help, completions and manual page, requests to popcutd, their schema, and errors.
struct PlanOption {
  enum class Kind : std::uint8_t { Flag, Number, Whole, Word, Text, Lengths, Place };

  std::string_view name;  ///< "curve-tolerance"; `--curve-tolerance` on the command line
  Kind kind{};
  std::string_view help;             ///< one phrase, without a full stop
  std::string_view form{};           ///< what stands for a value in help: "MM", "NAME|WxH"
  std::string usual{};               ///< the default as text; "" if there is none
  double least{}, most{};            ///< Number, Whole and each of Lengths; both are valid
  std::string_view unit{};           ///< "mm"; "" for a plain number
  std::vector<std::string> words{};  ///< of a Word
  std::string_view opposite{};       ///< a name under which requests may give a flag's opposite
  bool of_request{false};  ///< stands beside the options of a request: machine and material

  Member (*member)(PlanOptions&){};  ///< where the value goes

  /// The numbers in the member; none where the option has no range, or no value.
  [[nodiscard]] std::vector<double> numbers(const PlanOptions& options) const;
};

/// All options, in the order in which help lists them.
[[nodiscard]] std::span<const PlanOption> plan_option_table();

/// Where errors place an option: "/options/mat", or "/machine" for what stands beside the options.
/// In the text of errors and warnings an option stands in backquotes: `mat`.
[[nodiscard]] std::string pointer_to(const PlanOption& option);

/// What a value must be: "give a number from 0.01 to 1000".
[[nodiscard]] std::string right_value(const PlanOption& option, std::string_view wrong = {});

/// Options by name with their values as text: flags are "true" or "false", lists have commas
/// between. An empty text of an option without a default is as if it were not there.
///
/// @retval Usage  no such option, a value that is not valid, or two that contradict each other;
///                place is `pointer_to` the option
[[nodiscard]] Result<PlanOptions> read_plan_options(
    const std::map<std::string, std::string>& options);

/// Holds numbers against the ranges of the table, and options against each other.
///
/// @retval OutOfRange  a number is out of its range; place is `pointer_to` the option
/// @retval Usage       two contradict each other
[[nodiscard]] Result<void> check_plan_options(const PlanOptions& options);

}  // namespace popcut
