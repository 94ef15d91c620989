// SPDX-License-Identifier: MIT
#include "core/plan/plan_options.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/text/field_reader.hpp"
#include "core/text/near_names.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

using Kind = PlanOption::Kind;

constexpr double kMostSeed = 9e18;
constexpr std::size_t kMostListed = 1000;
constexpr std::size_t kMostShown = 40;  // characters of a wrong value in an error

// 1. Values from text.

bool read(std::string_view text, double& value) {
  return read_number(text, value) && std::isfinite(value);
}

bool read(std::string_view text, std::uint64_t& value) { return read_number(text, value); }

bool read(std::string_view text, bool& value) {
  value = text == "true";
  return value || text == "false";
}

bool read(std::string_view text, std::string& value) {
  value = text;
  return true;
}

bool read(std::string_view text, std::vector<double>& values) {
  for (values.clear(); values.size() < kMostListed;) {
    const std::string_view item = text.substr(0, text.find(','));
    if (!read(item, values.emplace_back())) return false;
    if (item.size() == text.size()) return true;
    text.remove_prefix(item.size() + 1);
  }
  return false;
}

bool read(std::string_view text, PagePoint& point) {
  std::vector<double> values;
  if (!read(text, values) || values.size() != 2) return false;
  point = {values[0], values[1]};
  return true;
}

// 2. What each kind of member has in common.

template <typename T>
struct Inner {
  using type = T;
  static constexpr bool is_optional = false;
};
template <typename T>
struct Inner<std::optional<T>> {
  using type = T;
  static constexpr bool is_optional = true;
};

/// The member that `Field` gives, its value where it is there, and whether it may not be there.
template <typename Field>
using Member = std::remove_reference_t<std::invoke_result_t<Field, PlanOptions&>>;
template <typename Field>
using Value = typename Inner<Member<Field>>::type;
template <typename Field>
constexpr bool may_be_absent = Inner<Member<Field>>::is_optional;

std::vector<double> numbers_of(double value) { return {value}; }
std::vector<double> numbers_of(std::uint64_t value) { return {static_cast<double>(value)}; }
std::vector<double> numbers_of(const std::vector<double>& values) { return values; }
template <typename T>
std::vector<double> numbers_of(const std::optional<T>& value) {
  return value ? numbers_of(*value) : std::vector<double>();
}

/// The row of a member: `field` gives the member of some options.
template <typename Field>
PlanOption row(std::string_view name, Kind kind, Field field, std::string_view help) {
  PlanOption option{.name = name, .kind = kind, .help = help};
  if constexpr (!std::is_enum_v<Value<Field>>)
    option.set = [field](PlanOptions& options, std::string_view text) {
      Value<Field> value{};
      if (may_be_absent<Field> && text.empty()) {
        field(options) = Member<Field>{};
        return true;
      }
      const bool is_one = read(text, value);
      if (is_one) field(options) = std::move(value);
      return is_one;
    };
  return option;
}

template <typename Field>
PlanOption flag(std::string_view name, Field field, std::string_view help) {
  return row(name, Kind::Flag, field, help);
}

struct Range {
  double least, most;
  std::string_view unit{};
};

/// A number, or a list of numbers; `usual` describes the default of one that may be absent.
template <typename Field>
PlanOption number(std::string_view name, Field field, std::string_view form, const Range& range,
                  std::string_view help, std::string usual = {}) {
  PlanOption option = row(name, Kind::Number, field, help);
  if constexpr (std::is_same_v<Member<Field>, std::uint64_t>) option.kind = Kind::Whole;
  if constexpr (std::is_same_v<Member<Field>, std::vector<double>>) option.kind = Kind::Lengths;
  option.form = form;
  option.least = range.least;
  option.most = range.most;
  option.unit = range.unit;
  option.numbers = [field](const PlanOptions& options) {
    return numbers_of(field(const_cast<PlanOptions&>(options)));  // it only reads
  };
  const std::vector<double> before = option.numbers(PlanOptions{});
  option.usual =
      !usual.empty() || before.empty() ? std::move(usual) : fmt::format("{:g}", before.front());
  return option;
}

/// One of the names of an enumeration's values, in their order; or of texts. `usual` describes the
/// default of one that may be absent.
template <typename Field>
PlanOption word(std::string_view name, Field field, std::vector<std::string> words,
                std::string_view help, std::string usual = {}) {
  PlanOption option = row(name, Kind::Word, field, help);
  option.set = [field, words](PlanOptions& options, std::string_view text) {
    constexpr bool is_text = std::is_same_v<Member<Field>, std::string>;
    if ((may_be_absent<Field> || is_text) && text.empty()) {
      field(options) = Member<Field>{};
      return true;
    }
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end()) return false;
    if constexpr (is_text)
      field(options) = *found;
    else
      field(options) = static_cast<Value<Field>>(found - words.begin());
    return true;
  };
  if constexpr (std::is_enum_v<Member<Field>>) {
    PlanOptions usually;
    usual = words.at(static_cast<std::size_t>(field(usually)));
  }
  option.words = std::move(words);
  option.usual = std::move(usual);
  return option;
}

template <typename Field>
PlanOption text(std::string_view name, Field field, std::string_view form, std::string_view help,
                std::string usual = {}) {
  PlanOption option = row(name, Kind::Text, field, help);
  PlanOptions usually;
  option.form = form;
  option.usual = usual.empty() ? field(usually) : std::move(usual);
  return option;
}

template <typename Field>
PlanOption place(std::string_view name, Field field, std::string_view help) {
  PlanOption option = row(name, Kind::Place, field, help);
  option.form = "X,Y";
  option.unit = "mm";
  return option;
}

PlanOption of_request(PlanOption option) {
  option.of_request = true;
  return option;
}

PlanOption with_opposite(PlanOption option, std::string_view name) {
  option.opposite = name;
  return option;
}

// 3. The table.

#define MEMBER(path) \
  [](PlanOptions & options) -> auto& { return options.path; }

// clang-format off
std::vector<PlanOption> make_table() {
  constexpr Range kSeams{-kMaxCoordinate, kMaxCoordinate, "mm"};
  return {
      of_request(text("machine", MEMBER(machine), "NAME",
           "The cutter; 'popcut machines' lists them", "cameo3")),
      of_request(text("material", MEMBER(material), "NAME",
           "What you cut; 'popcut materials' lists them", "paper-220")),
      text("mat", MEMBER(mat), "NAME|WxH",
           "A mat of the machine, a paper such as A4, A3-landscape or letter, or a size such as "
           "300x200 (mm), 30x20cm or 12x12in; a paper or size without --machine plans for an ideal "
           "plotter; roll cuts from a roll, as long as the drawing"),
      place("at", MEMBER(place.at),
           "Where the drawing's upper left corner goes on the sheet, in mm"),
      number("scale", MEMBER(scale), "N", {0.0001, 10'000},
           "Scale the drawing: 2 is twice as large"),
      number("width", MEMBER(width_mm), "MM", {0.1, kMaxCoordinate, "mm"},
           "Scale the drawing to this width, in mm", "as drawn"),
      number("rotate", MEMBER(rotate_deg), "DEG", {-360, 360, "degrees"},
           "Turn the drawing clockwise, in degrees"),
      number("per-sheet", MEMBER(per_sheet), "N", {1, 10'000},
           "How often to cut the drawing on the sheet, side by side"),
      flag("mirror", MEMBER(mirror),
           "Cut from the back: the mirror image, with mountain and valley folds exchanged"),
      word("order", MEMBER(order.method), {"quick", "best", "keep"},
           "Order of the strokes: quick, best (searches longer for a fast order), or keep (as "
           "drawn)"),
      number("effort", MEMBER(order.effort), "N", {0.01, 1000},
           "How long best searches: 2 tries twice as many changes and stops after 2 minutes"),
      number("seed", MEMBER(order.seed), "N", {0, kMostSeed},
           "Random seed of best; the same seed gives the same order"),
      number("weed-box", MEMBER(weed_box_mm), "MM", {0, 1000, "mm"},
           "Cut a box around the drawing, so far from it, last: vinyl is then weeded in one piece; 0 is "
           "no box"),
      text("pen", MEMBER(pens), "TEXT",
           "Settings for this job in place of the material's, such as \"cut: force=90 passes=2; red: "
           "speed=20\": force (gf), speed (mm/s), passes, step (gf more on each further pass), tool; "
           "for cut, fold, draw, score, light, mountain, valley, outline, a colour or a layer"),
      word("blade", MEMBER(blade), {"auto", "autoblade", "ratchet"},
           "Which blade is in the machine: autoblade (the machine sets its depth), ratchet (you set "
           "it), or auto (the one that the machine reports; the depth stays as it is if it reports "
           "none)"),
      flag("track-enhancing", MEMBER(track_enhancing),
           "Silhouette: roll the sheet in and out before the cut, so that a long sheet slips less"),
      word("finish", MEMBER(finish), {"home", "below"},
           "Where the tool goes at the end: home, or below what was cut, so that the sheet comes out; a "
           "Silhouette begins the next job there"),
      flag("mat-free", MEMBER(mat_free),
           "Cut without a mat: work in bands along the feed, never turn the blade in a sharp "
           "corner, cut the outline last"),
      word("dialect", MEMBER(dialect), {"gpgl", "hpgl"},
           "Language of the program; without --machine, popcut takes a machine that speaks it"),
      text("svg-profile", MEMBER(svg_profile), "NAME",
           "How popcut decides what the strokes of an SVG mean: auto (by their names; refuses several "
           "colours without names), popcut (by their names; cuts the others), origami-sim, "
           "lightburn, cricut, boxes-py, plain, or a profile of your own"),
      word("folds", MEMBER(knife.folds), {"perforate", "score", "light"},
           "How folds are made: perforate (dashes), score (press with a stylus) or light (cut "
           "half through)", "the material's"),
      number("overcut", MEMBER(knife.overcut_mm), "MM", {0, 10, "mm"},
           "On closed lines, start this far before the first point and end this far after it",
           "the material's"),
      word("direction", MEMBER(knife.direction), {"any", "cw", "ccw"},
           "Direction of closed cuts: any, cw (clockwise) or ccw (counter-clockwise)"),
      number("snap", MEMBER(clean.snap_mm), "MM", {0, kMostSnap, "mm"},
           "Join line ends closer than this"),
      number("seam-x", MEMBER(seams_x), "MM,...", kSeams,
           "Split the drawing at these distances from its left edge, in mm"),
      number("seam-y", MEMBER(seams_y), "MM,...", kSeams,
           "Split the drawing at these distances from its upper edge, in mm"),
      word("labels", MEMBER(labels), {"auto", "pen", "cut", "none"},
           "Marks and letters that show how to glue pieces: pen, cut (as short cuts), none, or "
           "auto (pen if the machine holds one, else cut)"),
      with_opposite(flag("no-split", MEMBER(no_split),
           "Refuse a drawing that is too large instead of splitting it"), "split"),
      flag("marks", MEMBER(marks),
           "The sheet is printed with registration marks; the cutter looks for them first"),
      word("mark-form", MEMBER(mark_form), {"arm", "line"},
           "If your cutter does not find the marks, try line. arm: the command TB51 gives the length "
           "of the marks' arms, and TB53 their thickness; line: the reverse"),
      number("curve-tolerance", MEMBER(curve_tolerance_mm), "MM", {0.001, 1, "mm"},
           "Largest distance between a curve and the straight lines that replace it"),
      number("svg-dpi", MEMBER(svg_dpi), "N", {1, 10'000},
           "SVG units (px) in an inch; 72 for old Illustrator files"),
      word("units", MEMBER(units), {"auto", "mm", "cm", "m", "in", "ft", "pt"},
           "Unit of length of a DXF or FOLD file, in place of what the file says"),
      flag("clip", MEMBER(place.clip),
           "Leave out what lies outside the area instead of refusing the drawing"),
  };
}
// clang-format on
#undef MEMBER

bool is_within(const PlanOption& option, const PlanOptions& options) {
  if (!option.numbers) return true;
  const std::vector<double> numbers = option.numbers(options);
  return std::all_of(numbers.begin(), numbers.end(),
                     [&](double n) { return n >= option.least && n <= option.most; });
}

std::string shown(std::string_view text) {
  return fmt::format("is \"{}\"", text.substr(0, kMostShown));
}

/// Sets the option `name` to the value in `text`.
Result<void> set_option(PlanOptions& options, const std::string& name, std::string text) {
  const auto table = plan_option_table();
  const auto found = std::find_if(table.begin(), table.end(), [&](const PlanOption& option) {
    return !option.of_request &&
           (option.name == name || (!option.opposite.empty() && option.opposite == name));
  });
  if (found == table.end()) {
    std::vector<std::string> names;
    for (const PlanOption& option : table)
      for (const std::string_view one : {option.name, option.opposite})
        if (!one.empty() && !option.of_request) names.emplace_back(one);
    return fail(ErrorKind::Usage, "/options/" + name.substr(0, 80),
                fmt::format("there is no such option; {}", suggestion(name, names)));
  }
  const std::string given = text;
  if (name == found->opposite && (text == "true" || text == "false"))
    text = text == "true" ? "false" : "true";
  if (found->set(options, text) && is_within(*found, options)) return {};
  return fail(ErrorKind::Usage, name == found->opposite ? "/options/" + name : pointer_to(*found),
              fmt::format("{}; {}", shown(given), right_value(*found, given)));
}

/// Whether two options contradict each other.
Result<void> check_pairs(const PlanOptions& options) {
  if (options.mat_free && options.order.method == OrderMethod::Keep)
    return fail(ErrorKind::Usage, "/options/mat-free",
                "changes the order that `order` keep preserves; leave one of them out");
  if (options.no_split && !(options.seams_x.empty() && options.seams_y.empty()))
    return fail(ErrorKind::Usage, "/options/no-split",
                "contradicts `seam-x` and `seam-y`; give one or the other");
  if (options.width_mm && options.scale != 1)
    return fail(ErrorKind::Usage, "/options/width", "contradicts `scale`; give one or the other");
  if (options.per_sheet > 1 &&
      (options.marks || !options.seams_x.empty() || !options.seams_y.empty() || options.place.clip))
    return fail(ErrorKind::Usage, "/options/per-sheet",
                "goes with one whole drawing; leave out `marks`, `seam-x`, `seam-y` and `clip`");
  if (options.weed_box_mm > 0 && (options.marks || options.place.clip))
    return fail(ErrorKind::Usage, "/options/weed-box",
                "goes with a whole drawing; leave out `marks` and `clip`");
  const bool changed =
      options.width_mm || options.scale != 1 || options.rotate_deg != 0 || options.mirror;
  if (options.marks && changed)
    return fail(ErrorKind::Usage, "/options/marks",
                "says that the sheet is printed already; leave out `scale`, `width`, `rotate` and "
                "`mirror`");
  return {};
}

}  // namespace

std::span<const PlanOption> plan_option_table() {
  static const std::vector<PlanOption> kTable = make_table();
  return kTable;
}

std::string pointer_to(const PlanOption& option) {
  return (option.of_request ? "/" : "/options/") + std::string(option.name);
}

std::string right_value(const PlanOption& option, std::string_view wrong) {
  const std::string unit = option.unit.empty() ? "" : fmt::format(" ({})", option.unit);
  switch (option.kind) {
    case Kind::Flag:
      return "give true or false";
    case Kind::Number:
      return fmt::format("give a number from {:g} to {:g}{}", option.least, option.most, unit);
    case Kind::Whole:
      return fmt::format("give a whole number from {:.0f} to {:.0f}{}", option.least, option.most,
                         unit);
    case Kind::Word:
      return suggestion(wrong, option.words);
    case Kind::Lengths:
      return fmt::format("give numbers with commas between{}", unit);
    case Kind::Place:
      return fmt::format("give X,Y{}, as in 20,30", unit);
    case Kind::Text:
      break;
  }
  return "give a text";
}

Result<PlanOptions> read_plan_options(const std::map<std::string, std::string>& options) {
  PlanOptions out;
  for (const auto& [name, text] : options)
    if (const auto set = set_option(out, name, text); !set) return tl::unexpected(set.error());
  if (const auto valid = check_pairs(out); !valid) return tl::unexpected(valid.error());
  return out;
}

namespace {

std::string listed(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + exact_number(value);
  return text;
}

}  // namespace

std::optional<double> unit_mm(LengthUnit unit) {
  constexpr std::array<double, 7> kMm{0, 1, 10, 1000, 25.4, 304.8, 25.4 / 72};
  if (unit == LengthUnit::Auto) return std::nullopt;
  return kMm.at(static_cast<std::size_t>(unit));
}

Result<void> check_plan_options(const PlanOptions& options) {
  for (const PlanOption& option : plan_option_table())
    if (!is_within(option, options))
      return fail(ErrorKind::OutOfRange, pointer_to(option),
                  fmt::format("{} is out of range; {}", listed(option.numbers(options)),
                              right_value(option)));
  return check_pairs(options);
}

}  // namespace popcut
