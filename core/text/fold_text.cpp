// SPDX-License-Identifier: MIT
#include "core/text/fold_text.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut {
namespace {

using Json = nlohmann::json;

constexpr double kNull = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMaxClasses = 100;
constexpr std::size_t kMaxOtherNames = 50;
constexpr std::size_t kMaxTitle = 1000;

/// The kind of value that a member holds.
enum class Form {
  Skip,
  Frames,
  Rows,
  Angles,
  Letters,
  Classes,
  Unit,
  Title,
  Parent,
  Psi,
  DesignPsi,
  Inherit,
  Numbers
};

/// A member of a frame that popcut reads.
struct Member {
  std::string_view key;
  Form form;
  FoldColumn FrameText::*column{nullptr};
  bool of_file{false};  ///< of the key frame only
};
constexpr std::array kMembers{
    Member{"vertices_coords", Form::Rows, &FrameText::vertices_coords},
    Member{"edges_vertices", Form::Rows, &FrameText::edges_vertices},
    Member{"faces_vertices", Form::Rows, &FrameText::faces_vertices},
    Member{"edges_foldAngle", Form::Angles, &FrameText::edges_fold_angle},
    Member{"edges_foldAngles", Form::Angles, &FrameText::edges_fold_angle},
    Member{"edges_assignment", Form::Letters, &FrameText::edges_assignment},
    Member{"frame_classes", Form::Classes},
    Member{"frame_unit", Form::Unit},
    Member{"frame_title", Form::Title},
    Member{"file_title", Form::Title, nullptr, true},
    Member{"frame_parent", Form::Parent},
    Member{"frame_popcut:psi_rad", Form::Psi},
    Member{"popcut:design_psi_rad", Form::DesignPsi, nullptr, true},
    Member{"popcut:model_placement", Form::Numbers, &FrameText::model_placement, true},
    Member{"frame_inherit", Form::Inherit},
    Member{"file_frames", Form::Frames, nullptr, true}};

/// Receives the parser's events and sorts them into columns. `value_depth_` is the depth of the
/// object with the current member: the member's outer list opens at that depth.
class FoldSax : public nlohmann::json_sax<Json> {
 public:
  FoldSax(std::string_view text, const FoldLimits& limits)
      : text_(text), most_numbers_(limits.numbers) {
    frames_.emplace_back();
  }

  bool null() override {
    const bool whole = is_column() && level() == 0;  // a member that is null counts as missing
    if (whole || form_ == Form::Unit || form_ == Form::Title) return done();
    return scalar(kNull, "null");
  }
  bool boolean(bool value) override {
    if (form_ == Form::Inherit && level() == 0) {
      frame().inherit = value;
      return done();
    }
    return form_ == Form::Skip ? scalar(0.0, "") : wrong("true or false");
  }
  bool number_integer(number_integer_t value) override {
    return scalar(static_cast<double>(value), "a number");
  }
  bool number_unsigned(number_unsigned_t value) override {
    return scalar(static_cast<double>(value), "a number");
  }
  bool number_float(number_float_t value, const string_t&) override {
    return scalar(value, "a number");
  }
  bool string(string_t& value) override;
  bool binary(binary_t&) override { return wrong("binary data"); }
  bool start_object(std::size_t) override;
  bool key(string_t& name) override;
  bool end_object() override;
  bool start_array(std::size_t) override;
  bool end_array() override;
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& why) override;

  Error error;
  std::vector<FrameText> take() { return std::move(frames_); }

 private:
  FrameText& frame() { return frames_[owner_]; }
  [[nodiscard]] int level() const { return depth_ - value_depth_; }
  [[nodiscard]] bool is_column() const {
    return form_ == Form::Rows || form_ == Form::Angles || form_ == Form::Letters ||
           form_ == Form::Numbers;
  }
  /// Counts a number or a row.
  bool count() {
    return ++numbers_ <= most_numbers_ ||
           stop(ErrorKind::OutOfRange, place(),
                fmt::format("more than {} numbers in the file; split it", most_numbers_));
  }
  bool done() {
    form_ = Form::Skip;
    return true;
  }
  bool stop(ErrorKind kind, std::string place, std::string detail) {
    error = Error{kind, std::move(place), std::move(detail)};
    return false;
  }
  [[nodiscard]] std::string place() const;
  bool wrong(const char* found);
  bool scalar(double value, const char* found);
  bool open();

  std::string_view text_;
  std::size_t most_numbers_;
  std::vector<FrameText> frames_;
  std::string key_;
  FoldColumn* column_{nullptr};
  Form form_{Form::Skip};
  std::size_t owner_{0};  ///< the frame of the current member
  int depth_{0};
  int value_depth_{0};
  std::size_t numbers_{0};
  bool in_frames_{false};
};

std::string FoldSax::place() const {
  if (depth_ == 0) return "/";
  std::string pointer = frames_[owner_].place;
  if (in_frames_ && depth_ == 2) return fmt::format("/file_frames/{}", frames_.size() - 1);
  pointer += "/" + key_;
  if (column_ == nullptr || level() == 0) return pointer;
  if (form_ != Form::Rows) return fmt::format("{}/{}", pointer, column_->number.size());
  if (level() == 1) return fmt::format("{}/{}", pointer, column_->row_first.size());
  return fmt::format("{}/{}/{}", pointer, column_->row_first.size() - 1,
                     column_->number.size() - column_->row_first.back());
}

bool FoldSax::wrong(const char* found) {
  if (form_ == Form::Skip)
    return depth_ > 0 || stop(ErrorKind::Malformed, "/", "a FOLD file must be an object");
  // What must stand at a member, in its list, and in the lists of that.
  constexpr std::array<std::array<const char*, 3>, 13> kRight{{
      {},
      {"a list of frames", "a frame (an object)"},
      {"a list of lists", "a list", "a number"},
      {"a list of angles", "a number of degrees or null", "a number of degrees or null"},
      {"a list of letters", "one of B M V F U C J", "one of B M V F U C J"},
      {"a list of strings", "a list of strings", "a list of strings"},
      {"a string", "a string", "a string"},
      {"a string", "a string", "a string"},
      {"the number of a frame", "the number of a frame", "the number of a frame"},
      {"an angle in radians", "an angle in radians", "an angle in radians"},
      {"an angle in radians", "an angle in radians", "an angle in radians"},
      {"true or false", "true or false", "true or false"},
      {"a list of numbers", "a number", "a number"},
  }};
  const int at = form_ == Form::Frames ? int{depth_ > 1} : std::clamp(level(), 0, 2);
  return stop(
      ErrorKind::Malformed, place(),
      fmt::format("is {}; it must be {}", found,
                  kRight.at(static_cast<std::size_t>(form_)).at(static_cast<std::size_t>(at))));
}

bool FoldSax::scalar(double value, const char* found) {
  switch (form_) {
    case Form::Skip:
      return depth_ > 0 || wrong(found);
    case Form::Rows:
      if (level() != 2 || std::isnan(value)) return wrong(found);
      column_->number.push_back(value);
      return count();
    case Form::Angles:
      if (level() != 1) return wrong(found);
      column_->number.push_back(value);
      return count();
    case Form::Numbers:
      if (level() != 1 || std::isnan(value)) return wrong(found);
      column_->number.push_back(value);
      return count();
    case Form::Letters:
      if (level() != 1 || !std::isnan(value)) return wrong(found);
      column_->number.push_back(static_cast<double>('U'));
      return count();
    case Form::Parent:
    case Form::Psi:
    case Form::DesignPsi:
      if (level() != 0) return wrong(found);
      if (!std::isnan(value))
        (form_ == Form::Parent ? frame().parent
         : form_ == Form::Psi  ? frame().psi_rad
                               : frame().design_psi_rad) = value;
      return done();
    default:
      return wrong(found);
  }
}

bool FoldSax::string(string_t& value) {
  if (form_ == Form::Skip) return depth_ > 0 || wrong("a string");
  if (form_ == Form::Letters && level() == 1 && value.size() == 1) {
    column_->number.push_back(static_cast<double>(value[0]));
    return count();
  }
  if (form_ == Form::Classes && level() == 1) {
    if (frame().classes.size() < kMaxClasses) frame().classes.push_back(value);
    return true;
  }
  if (form_ == Form::Unit && level() == 0) {
    frame().unit = value;
    return done();
  }
  if (form_ == Form::Title && level() == 0) {
    (key_ == "file_title" ? frame().file_title : frame().title) = value.substr(0, kMaxTitle);
    return done();
  }
  return wrong("a string");
}

bool FoldSax::open() {
  if (++depth_ <= kMaxFoldDepth) return true;
  return stop(ErrorKind::Malformed, "",
              fmt::format("lists and objects are nested deeper than {}; a FOLD file needs 5",
                          kMaxFoldDepth));
}

bool FoldSax::start_object(std::size_t) {
  if (depth_ == 0) return open();
  if (form_ == Form::Frames && depth_ == 2) {
    if (frames_.size() > kMaxFoldFrames) {
      return stop(ErrorKind::OutOfRange, "/file_frames",
                  fmt::format("more than {} frames", kMaxFoldFrames));
    }
    frames_.emplace_back();
    frames_.back().place = fmt::format("/file_frames/{}", frames_.size() - 2);
    form_ = Form::Skip;
    return open();
  }
  return form_ == Form::Skip ? open() : wrong("an object");
}

bool FoldSax::key(string_t& name) {
  const bool of_frame = in_frames_ && depth_ == 3;
  if (depth_ != 1 && !of_frame) return true;
  key_ = name;
  value_depth_ = depth_;
  const auto member = std::find_if(kMembers.begin(), kMembers.end(), [&](const Member& known) {
    return known.key == name && (!known.of_file || depth_ == 1);
  });
  form_ = member == kMembers.end() ? Form::Skip : member->form;
  owner_ = of_frame ? frames_.size() - 1 : 0;
  FrameText& owner = frames_[owner_];
  column_ = form_ == Form::Skip || member->column == nullptr ? nullptr : &(owner.*member->column);
  if (form_ == Form::Skip && owner.other_names.size() < kMaxOtherNames && name.size() < 64 &&
      name.find(':') == string_t::npos)
    owner.other_names.push_back(name);
  if (form_ == Form::Frames) {
    if (frames_.size() > 1)
      return stop(ErrorKind::Malformed, "/file_frames", "the member occurs twice; remove one");
    in_frames_ = true;
  }
  if (column_ != nullptr && column_->present) {
    return stop(ErrorKind::Malformed, owner.place + "/" + name,
                "the member occurs twice; remove one");
  }
  return true;
}

bool FoldSax::end_object() {
  --depth_;
  if (in_frames_ && depth_ == 2) form_ = Form::Frames;
  return true;
}

bool FoldSax::start_array(std::size_t) {
  if (depth_ == 0) return wrong("a list");
  switch (form_) {
    case Form::Skip:
      return open();
    case Form::Frames:
      return depth_ == 1 ? open() : wrong("a list");
    case Form::Rows:
      if (level() == 0) column_->present = true;
      if (level() == 1) {
        column_->row_first.push_back(static_cast<std::uint32_t>(column_->number.size()));
        if (!count()) return false;
      }
      return level() < 2 ? open() : wrong("a list");
    case Form::Angles:
    case Form::Letters:
    case Form::Numbers:
      column_->present = true;
      [[fallthrough]];
    case Form::Classes:
      return level() == 0 ? open() : wrong("a list");
    default:
      return wrong("a list");
  }
}

bool FoldSax::end_array() {
  --depth_;
  if (in_frames_ && depth_ == 1) {
    in_frames_ = false;
    form_ = Form::Skip;
  } else if (form_ != Form::Skip && form_ != Form::Frames && level() == 0) {
    form_ = Form::Skip;
  }
  return true;
}

bool FoldSax::parse_error(std::size_t position, const std::string&,
                          const nlohmann::detail::exception& why) {
  const std::string_view before = text_.substr(0, std::min(position, text_.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column =
      newline == std::string_view::npos ? before.size() : before.size() - newline - 1;
  std::string reason = why.what();
  if (const std::size_t from = reason.find(": "); from != std::string::npos)
    reason.erase(0, from + 2);
  if (reason.size() > 160) reason.resize(160);
  return stop(ErrorKind::Malformed, fmt::format("line {}, column {}", line, column),
              "is not JSON: " + reason);
}

}  // namespace

double fold_unit_mm(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 30> kUnits{
      {{"mm", 1.0},
       {"cm", 10.0},
       {"m", 1000.0},
       {"in", 25.4},
       {"pt", 25.4 / 72},
       {"um", 1e-3},
       {"nm", 1e-6},
       {"unit", 1.0},
       // Words that FOLD does not have, and programs write.
       {"millimeter", 1.0},
       {"millimeters", 1.0},
       {"millimetre", 1.0},
       {"millimetres", 1.0},
       {"centimeter", 10.0},
       {"centimeters", 10.0},
       {"centimetre", 10.0},
       {"centimetres", 10.0},
       {"meter", 1000.0},
       {"meters", 1000.0},
       {"metre", 1000.0},
       {"metres", 1000.0},
       {"inch", 25.4},
       {"inches", 25.4},
       {"\"", 25.4},
       {"ft", 304.8},
       {"foot", 304.8},
       {"feet", 304.8},
       {"point", 25.4 / 72},
       {"points", 25.4 / 72},
       {"units", 1.0},
       {"px", 25.4 / 96}}};
  const std::string plain = lower(trimmed(unit));
  for (const auto& [name, mm] : kUnits)
    if (plain == name) return mm;
  return plain.empty() ? 1.0 : 0.0;
}

Result<std::vector<FrameText>> read_fold_text(std::string_view text, const FoldLimits& limits) {
  if (text.size() > limits.bytes) {
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("the text has {} bytes; the limit is {}", text.size(), limits.bytes));
  }
  std::string kept;
  text = plain_text(text, kept);
  FoldSax sax(text, limits);
  if (!Json::sax_parse(text, &sax)) return tl::unexpected<Error>(std::move(sax.error));
  return sax.take();
}

}  // namespace popcut
