// SPDX-License-Identifier: MIT
#include "core/plan/plan_options.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/field_table.hpp"
#include "core/text/near_names.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

using nlohmann::json;
using Kind = PlanOption::Kind;

constexpr double kMostSeed = 9e18;
constexpr std::size_t kMostListed = 1000;
constexpr std::size_t kMostShown = 40;  // characters of a wrong value in an error

// 1. Values from text.

/// Reads a number; one in mm may have its unit behind it: 80, 80mm, 8cm or 3in.
bool read_value(std::string_view text, std::string_view unit, double& number) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 1}, {"cm", 10}, {"in", 25.4}};
  double mm = 1;
  if (unit == "mm" && text.size() > 2)
    for (const auto& [name, size_mm] : kUnits)
      if (same_word(text.substr(text.size() - 2), name)) {
        mm = size_mm;
        text.remove_suffix(2);
        break;
      }
  if (!read_number(text, number)) return false;
  number *= mm;
  return std::isfinite(number);
}

std::optional<json> numbers_in(std::string_view text, std::string_view unit) {
  json numbers = json::array();
  while (numbers.size() < kMostListed) {
    const std::string_view item = text.substr(0, text.find(','));
    double number{};
    if (!read_value(item, unit, number)) return std::nullopt;
    numbers.push_back(number);
    if (item.size() == text.size()) return numbers;
    text.remove_prefix(item.size() + 1);
  }
  return std::nullopt;
}

/// The value in `text`; nothing if the option has no such value.
std::optional<json> value_in(const PlanOption& option, std::string_view text,
                             const Member& member) {
  const auto if_valid = [](bool is_valid, const auto& value) {
    return is_valid ? std::optional<json>(value) : std::nullopt;
  };
  double number{};
  std::uint64_t whole{};
  const auto word = std::find(option.words.begin(), option.words.end(), text);
  const bool is_word = word != option.words.end();
  switch (option.kind) {
    case Kind::Flag:
      return if_valid(text == "true" || text == "false", text == "true");
    case Kind::Number:
      return if_valid(read_value(text, option.unit, number), number);
    case Kind::Whole:
      return if_valid(read_number(text, whole), whole);
    case Kind::Word:
      if (member.takes_index) return if_valid(is_word, word - option.words.begin());
      return if_valid(is_word || text.empty(), std::string(text));
    case Kind::Lengths:
      return numbers_in(text, option.unit);
    case Kind::Place: {
      auto place = numbers_in(text, option.unit);
      return place && place->size() == 2 ? place : std::nullopt;
    }
    case Kind::Text:
      break;
  }
  return std::string(text);
}

/// Sets the option to the value in `text`. @return whether it has such a value
bool set_value(const PlanOption& option, PlanOptions& options, std::string_view text) {
  const Member member = option.member(options);
  const bool is_absent = member.takes_null && text.empty();
  const std::optional<json> value = is_absent ? json() : value_in(option, text, member);
  if (value) member.set(member.at, *value);
  return value.has_value();
}

// 2. The kinds of rows.

using MemberOf = Member (*)(PlanOptions&);

/// The value of the member that is not set: the default.
json usual_value(MemberOf member) {
  PlanOptions usual;
  const Member of = member(usual);
  return of.get(of.at);
}

PlanOption row(std::string_view name, Kind kind, MemberOf member, std::string_view help) {
  return {.name = name, .kind = kind, .help = help, .member = member};
}

PlanOption flag(std::string_view name, MemberOf member, std::string_view help) {
  return row(name, Kind::Flag, member, help);
}

struct Limits {
  double least, most;
  std::string_view unit{};
};

/// A number, a whole number or a list of numbers, as the member is. `usual` describes the default
/// of one that may be absent.
PlanOption number(std::string_view name, MemberOf member, std::string_view form,
                  const Limits& limits, std::string_view help, std::string usual = {}) {
  const json value = usual_value(member);
  PlanOption option = row(name, Kind::Number, member, help);
  if (value.is_number_unsigned()) option.kind = Kind::Whole;
  if (value.is_array()) option.kind = Kind::Lengths;
  option.form = form;
  option.least = limits.least;
  option.most = limits.most;
  option.unit = limits.unit;
  option.usual = value.is_number() ? fmt::format("{:g}", value.get<double>()) : std::move(usual);
  return option;
}

/// One of the names of an enumeration's values, in their order; or of texts. `usual` describes the
/// default of one that may be absent.
PlanOption word(std::string_view name, MemberOf member, std::vector<std::string> words,
                std::string_view help, std::string usual = {}) {
  PlanOption option = row(name, Kind::Word, member, help);
  const json value = usual_value(member);
  option.usual = value.is_number() ? words.at(value.get<std::size_t>()) : std::move(usual);
  option.words = std::move(words);
  return option;
}

PlanOption text(std::string_view name, MemberOf member, std::string_view form,
                std::string_view help, std::string usual = {}) {
  PlanOption option = row(name, Kind::Text, member, help);
  option.form = form;
  option.usual = usual.empty() ? usual_value(member).get<std::string>() : std::move(usual);
  return option;
}

PlanOption place(std::string_view name, MemberOf member, std::string_view help) {
  PlanOption option = row(name, Kind::Place, member, help);
  option.form = "X,Y";
  option.unit = "mm";
  return option;
}

Member point(std::optional<PagePoint>* to) {
  Member member(to, [](void* at, const json& value) {
    auto& point = *static_cast<std::optional<PagePoint>*>(at);
    point.reset();
    if (!value.is_null()) point = PagePoint{value[0].get<double>(), value[1].get<double>()};
  });
  member.takes_null = true;
  return member;
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

#define MEMBER(path) [](PlanOptions& options) { return Member(&options.path); }

// clang-format off
std::vector<PlanOption> make_table() {
  constexpr Limits kSearch{-kFarthestSearchMm, kFarthestSearchMm, "mm"};
  constexpr Limits kSeams{-kMaxCoordinate, kMaxCoordinate, "mm"};
  return {
      of_request(text("machine", MEMBER(machine), "NAME",
           "The cutter; 'popcut machines' lists them", "cameo3")),
      of_request(text("material", MEMBER(material), "NAME",
           "What you cut; 'popcut materials' lists them", "paper-220")),
      text("mat", MEMBER(mat), "NAME|WxH",
           "A mat of the machine, a paper such as A4, A3-landscape or letter, or a size such as "
           "300x200 (mm), 30x20cm or 12x12in; a paper or size without --machine plans for an ideal "
           "plotter; roll cuts from a roll, over the length of the drawing"),
      place("at", [](PlanOptions& options) { return point(&options.place.at); },
           "Where the drawing's upper left corner goes on the sheet, in mm"),
      number("scale", MEMBER(scale), "N", {0.0001, 10'000},
           "Scale the drawing: 2 is twice as large"),
      number("width", MEMBER(width_mm), "MM", {0.1, kMaxCoordinate, "mm"},
           "Scale the drawing to this width, in mm", "as drawn"),
      number("rotate", MEMBER(rotate_deg), "DEG", {-360, 360, "degrees"},
           "Turn the drawing clockwise, in degrees"),
      number("per-sheet", MEMBER(per_sheet), "N", {1, 10'000},
           "How many copies of the drawing to cut on the sheet, side by side"),
      flag("mirror", MEMBER(mirror),
           "Cut from the back: the mirror image, with mountain and valley folds exchanged"),
      word("order", MEMBER(order.method), {"quick", "best", "keep"},
           "Order of the strokes: quick, best (searches longer for a fast order), or keep (as "
           "drawn)"),
      number("effort", MEMBER(order.effort), "N", {0.01, 1000},
           "With order best, how long to search: 2 tries twice as many changes and stops after 2 minutes"),
      number("seed", MEMBER(order.seed), "N", {0, kMostSeed},
           "With order best, the random seed; the same seed gives the same order"),
      number("weed-box", MEMBER(weed_box_mm), "MM", {0, 1000, "mm"},
           "Last, cut a box at this distance around the drawing, so that vinyl can be weeded in one "
           "piece; 0: no box"),
      text("pen", MEMBER(pens), "TEXT",
           "Settings for this job in place of the material's, such as \"cut: force=90 passes=2; red: "
           "speed=20\": force (gf), speed (mm/s), passes, step (gf more on each further pass), tool; "
           "for cut, fold, draw, score, light, mountain, valley, outline, a colour or a layer"),
      word("blade", MEMBER(blade), {"auto", "autoblade", "ratchet"},
           "Which blade is in the machine: autoblade (the machine sets its depth), ratchet (you set "
           "it), or auto (the one that the machine reports; if it reports none, the depth does not "
           "change)"),
      flag("track-enhancing", MEMBER(track_enhancing),
           "Silhouette: roll the sheet in and out before the cut, so that a long sheet slips less"),
      word("finish", MEMBER(finish), {"home", "below"},
           "Where the tool parks: at home, or below the cut so that the sheet is fed out; a Silhouette "
           "begins the next job there"),
      flag("mat-free", MEMBER(mat_free),
           "Cut without a mat: work in bands along the feed, never turn the blade in a sharp "
           "corner, cut the outline last"),
      word("dialect", MEMBER(dialect), {"gpgl", "hpgl"},
           "Language of the program; without --machine, popcut takes a machine that speaks it"),
      text("svg-profile", MEMBER(svg_profile), "NAME",
           "How popcut decides what the strokes of an SVG mean: auto (by their names; refuses several "
           "colours without names), popcut (by their names; cuts the others), origami-sim, "
           "lightburn, cricut, boxes-py, plain, or a profile of your own"),
      text("layers", MEMBER(layers), "TEXT",
           "What the lines of a layer or group are for, such as \"Wing=fold; Notes=ignore\": cut, "
           "outline, score, fold, fold-mountain, fold-valley, draw or ignore"),
      text("colors", MEMBER(colors), "TEXT",
           "What the lines of a colour are for, where no layer says it, such as "
           "\"red=fold-mountain; #0000ff=fold-valley\"; the uses are those of layers"),
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
      number("one-pass", MEMBER(clean.one_pass_mm), "MM", {0, kMostOnePass, "mm"},
           "If two lines run side by side, closer than this, cut only one; 0: cut both"),
      flag("weld", MEMBER(weld),
           "Join filled shapes of an SVG that overlap, and cut around the result"),
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
      number("mark-start", MEMBER(mark_start), "LEFT,UP", kSearch,
           "If your cutter does not find the marks, begin its search elsewhere: this far left of and "
           "above the square's outer corner, in mm; negative is right and down", "the machine's"),
      number("mark-again", MEMBER(mark_again), "MM,...", kSearch,
           "After a search that finds no marks, search again; the new search starts this much lower "
           "than the first, in mm", "the machine's"),
      number("curve-tolerance", MEMBER(curve_tolerance_mm), "MM", {0.001, 1, "mm"},
           "Largest distance between a curve and the straight lines that replace it"),
      number("svg-dpi", MEMBER(svg_dpi), "N", {1, 10'000},
           "SVG units (px) in an inch; 72 for old Illustrator files"),
      number("pdf-page", MEMBER(pdf_page), "N", {1, 100'000}, "Which page of a PDF to read"),
      word("units", MEMBER(units), {"auto", "mm", "cm", "m", "in", "ft", "pt"},
           "Unit of length of a DXF or FOLD file, in place of what the file says"),
      flag("clip", MEMBER(place.clip),
           "Leave out what lies outside the area instead of refusing the drawing"),
  };
}
// clang-format on
#undef MEMBER

bool is_within(const PlanOption& option, const PlanOptions& options) {
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
                fmt::format("no such option exists; {}", suggestion(name, names)));
  }
  const std::string given = text;
  if (name == found->opposite && (text == "true" || text == "false"))
    text = text == "true" ? "false" : "true";
  if (set_value(*found, options, text) && is_within(*found, options)) return {};
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
  if (options.mark_again.size() > kMostSearches)
    return fail(
        ErrorKind::Usage, "/options/mark-again",
        fmt::format("has {} lengths; give at most {}", options.mark_again.size(), kMostSearches));
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

std::vector<double> PlanOption::numbers(const PlanOptions& options) const {
  if (kind != Kind::Number && kind != Kind::Whole && kind != Kind::Lengths) return {};
  const Member of = member(const_cast<PlanOptions&>(options));  // it only reads
  const json value = of.get(of.at);
  if (value.is_array()) return value.get<std::vector<double>>();
  return value.is_null() ? std::vector<double>() : std::vector{value.get<double>()};
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
      if (option.most < kMaxCoordinate)
        return fmt::format("give numbers from {:g} to {:g}{} with commas between", option.least,
                           option.most, unit);
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
