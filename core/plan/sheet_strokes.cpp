// SPDX-License-Identifier: MIT
#include "core/plan/sheet_strokes.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/machines/motion.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

constexpr std::uint8_t kMark = 6;  // after the operations

// Places of points, as fine as drawings are cleaned.
using Place = std::pair<std::int64_t, std::int64_t>;
Place place_of(const PagePoint& p) {
  constexpr double kSame_mm = 1e-3;
  return {std::llround(p.x / kSame_mm), std::llround(p.y / kSame_mm)};
}

// The corners of the ticks and letters on a sheet.
std::set<Place> mark_places(const Plan& plan, const PlannedSheet& sheet) {
  std::set<Place> places;
  if (!plan.layout) return places;
  for (const std::uint32_t i : sheet.pieces) {
    const SheetPiece& piece = plan.layout->pieces[i];
    for (std::size_t l = piece.first_mark; l < piece.work.lines.size(); ++l)
      for (const PagePoint& p : piece.work.points_of(piece.work.lines[l]))
        places.insert(place_of(piece.transform(p)));
  }
  return places;
}

bool lies_on(const std::set<Place>& places, std::span<const PagePoint> points) {
  if (places.empty()) return false;
  return std::all_of(points.begin(), points.end(), [&](const PagePoint& p) {
    const Place at = place_of(p);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        if (places.contains({at.first + dx, at.second + dy})) return true;
    return false;
  });
}

struct PlacedPiece {
  std::uint32_t number{};
  Box box;
};

std::vector<PlacedPiece> placed_pieces(const Plan& plan, const PlannedSheet& sheet) {
  std::vector<PlacedPiece> all;
  if (!plan.layout) return all;
  for (const std::uint32_t i : sheet.pieces) {
    const SheetPiece& piece = plan.layout->pieces[i];
    PlacedPiece placed{i + 1, {}};
    for (const PagePoint& p : piece.work.points) placed.box.add(piece.transform(p));
    all.push_back(placed);
  }
  return all;
}

double outside_mm(const Box& box, const PagePoint& p) {
  return std::max(std::max({box.x0 - p.x, p.x - box.x1, 0.0}),
                  std::max({box.y0 - p.y, p.y - box.y1, 0.0}));
}

// Pieces lie beside each other, so the box that a point is in, or is nearest to, is its piece's.
std::uint32_t piece_at(const std::vector<PlacedPiece>& pieces, const PagePoint& p) {
  std::uint32_t nearest = 1;
  double least = std::numeric_limits<double>::infinity();
  for (const PlacedPiece& piece : pieces) {
    const double off = outside_mm(piece.box, p);
    if (off < least) least = off, nearest = piece.number;
  }
  return nearest;
}

// Whether a stroke goes over the line of the one before it: back along it, or round it again.
bool goes_over(const Toolpath& path, const Stroke& before, const Stroke& stroke) {
  if (before.operation != stroke.operation || before.line != stroke.line ||
      before.count != stroke.count)
    return false;
  const auto a = path.points_of(before), b = path.points_of(stroke);
  return std::equal(a.begin(), a.end(), b.begin()) || std::equal(a.rbegin(), a.rend(), b.begin());
}

// From START until the tool begins to come down on the first stroke: what the plan's time has
// besides the strokes and what follows them.
double lead_in_s(const Plan& plan, const PlannedSheet& sheet, double strokes_s) {
  const Motion& motion = plan.machine.motion;
  const Toolpath& path = sheet.sent_path();
  double after = strokes_s + motion.trailer_s +
                 travel_seconds(distance(path.points_of(path.strokes.back()).back(), {}), motion);
  if (sheet.feed_out_mm) after += travel_seconds(sheet.area_mm[1], motion);
  return std::max(0.0, sheet.seconds - after);
}

void add_times(const Plan& plan, const PlannedSheet& sheet, std::vector<StrokeNote>& notes) {
  if (!plan.machine.driven() || notes.empty()) return;
  const FirmwareSwivel swivel{
      plan.machine.firmware_blade_offset ? plan.material.blade_offset_mm : 0.0,
      sheet.knife.blade_tools};
  const std::vector<StrokeTime> times =
      stroke_times(sheet.sent_path(), plan.machine.motion, swivel);
  const double lead_in = lead_in_s(plan, sheet, times.back().end_s);
  for (std::size_t i = 0; i < notes.size(); ++i) {
    notes[i].start_s = lead_in + times[i].begin_s;
    notes[i].end_s = lead_in + times[i].end_s;
  }
}

// A list of numbers in JSON, written at once.
class NumberList {
 public:
  explicit NumberList(std::string& text) : text_(text) { text_ += '['; }
  NumberList(const NumberList&) = delete;
  NumberList& operator=(const NumberList&) = delete;
  ~NumberList() { text_ += ']'; }
  void whole(std::uint64_t number) {
    separate();
    std::array<char, kLongestNumber> digits;
    text_.append(digits.data(),
                 std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
  }
  void thousandths(double number) {
    separate();
    append_rounded(text_, std::round(number * 1e3) / 1e3);
  }

 private:
  void separate() {
    if (text_.back() != '[') text_ += ',';
  }
  std::string& text_;
};

template <typename Values, typename Put>
void add_list(std::string& text, std::string_view name, const Values& values, const Put& put) {
  text += fmt::format("\"{}\":", name);
  NumberList list(text);
  for (const auto& value : values) put(list, value);
}

}  // namespace

const std::vector<std::string_view>& stroke_kinds() {
  static const std::vector<std::string_view> kinds{"draw", "score",   "mountain", "valley",
                                                   "cut",  "outline", "mark"};
  return kinds;
}

std::vector<StrokeNote> stroke_notes(const Plan& plan, std::size_t number) {
  const PlannedSheet& sheet = plan.sheets[number];
  const Toolpath& drawn = sheet.path;
  const std::set<Place> marks = mark_places(plan, sheet);
  const std::vector<PlacedPiece> pieces = placed_pieces(plan, sheet);
  std::vector<StrokeNote> notes(drawn.strokes.size());
  for (std::size_t i = 0; i < notes.size(); ++i) {
    const Stroke& stroke = drawn.strokes[i];
    const auto points = drawn.points_of(stroke);
    notes[i].kind = lies_on(marks, points) ? kMark : static_cast<std::uint8_t>(stroke.operation);
    notes[i].piece = piece_at(pieces, points.front());
    if (i > 0 && goes_over(drawn, drawn.strokes[i - 1], stroke))
      notes[i].pass = notes[i - 1].pass + 1;
  }
  add_times(plan, sheet, notes);
  return notes;
}

std::string sheet_strokes_json(const Plan& plan, std::size_t number, std::string_view side) {
  const PlannedSheet& sheet = plan.sheets[number];
  const Toolpath& path = sheet.sent_path();
  const std::vector<StrokeNote> notes = stroke_notes(plan, number);
  Box box;
  for (const PagePoint& p : path.points) box.add(p);
  if (path.points.empty()) box = {0, 0, 0, 0};
  std::string text;
  text.reserve(512 + 40 * notes.size() + 16 * path.points.size());
  text += fmt::format(R"({{"sheet":{},"width_mm":)", number + 1);
  append_rounded(text, sheet.area_mm[0]);
  text += R"(,"length_mm":)";
  append_rounded(text, sheet.area_mm[1]);
  text += fmt::format(R"(,"mat":{},"material":{},"side":{},"drawing_mm":)",
                      sheet.mat.name.empty() ? "null" : json_quoted(sheet.mat.name),
                      json_quoted(plan.material.name), side.empty() ? "null" : json_quoted(side));
  {
    NumberList corner(text);
    for (const double mm : {box.x0, box.y0, box.width(), box.height()}) corner.thousandths(mm);
  }
  text += R"(,"kinds":[)";
  for (const std::string_view kind : stroke_kinds())
    text += fmt::format("{}\"{}\"", text.back() == '[' ? "" : ",", kind);
  text += R"(],"stroke":{)";
  add_list(text, "kind", notes, [](NumberList& l, const StrokeNote& n) { l.whole(n.kind); });
  text += ',';
  add_list(text, "piece", notes, [](NumberList& l, const StrokeNote& n) { l.whole(n.piece); });
  text += ',';
  add_list(text, "pass", notes,
           [](NumberList& l, const StrokeNote& n) { l.whole(static_cast<std::uint64_t>(n.pass)); });
  text += ',';
  add_list(text, "start_s", notes,
           [](NumberList& l, const StrokeNote& n) { l.thousandths(n.start_s); });
  text += ',';
  add_list(text, "end_s", notes,
           [](NumberList& l, const StrokeNote& n) { l.thousandths(n.end_s); });
  text += ',';
  add_list(text, "points", path.strokes,
           [](NumberList& l, const Stroke& stroke) { l.whole(stroke.count); });
  text += "},";
  text += "\"xy_mm\":";
  {
    NumberList list(text);
    for (const Stroke& stroke : path.strokes)
      for (const PagePoint& p : path.points_of(stroke)) {
        list.thousandths(p.x);
        list.thousandths(p.y);
      }
  }
  text += "}\n";
  return text;
}

}  // namespace popcut
