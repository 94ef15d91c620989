// SPDX-License-Identifier: MIT
#include "protocol/gpgl_reader.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "protocol/append.hpp"
#include "protocol/decode.hpp"
#include "protocol/gpgl_variants.hpp"

namespace popcut {

enum class GpglForm : std::uint8_t {
  Numbers,      // arguments as sent
  Points,       // pairs, absolute
  Steps,        // pairs, relative
  Numbered,     // the first argument belongs to the mnemonic: TB50, FQ0
  Deltas,       // BE
  Text,         // up to the ETX
  Unsupported,  // known to draw something that we cannot follow
};

struct GpglCommand {
  std::string_view mnemonic;
  Verb verb;
  GpglForm form{GpglForm::Numbers};
  std::uint8_t least{};  // fewest arguments
};

namespace {

using enum GpglForm;

// Sources: Graphtec's GP-GL command list, and what Silhouette's own software and published drivers
// send. The commands that draw most come first.
constexpr std::array kCommands{
    GpglCommand{"D", Verb::Draw, Points},
    GpglCommand{"M", Verb::Move, Points},
    GpglCommand{"BE", Verb::Draw, GpglForm::Deltas},
    GpglCommand{"E", Verb::Draw, Steps},
    GpglCommand{"O", Verb::Move, Steps},
    GpglCommand{"!", Verb::Speed, Numbers, 1},
    GpglCommand{"FX", Verb::Force, Numbers, 1},
    GpglCommand{"FC", Verb::BladeOffset, Numbers, 1},
    GpglCommand{"FE", Verb::CornerLift, Numbers, 1},
    GpglCommand{"FF", Verb::CornerExtend, Numbers, 1},
    GpglCommand{"J", Verb::SelectTool, Numbers, 1},
    GpglCommand{"TG", Verb::Mat, Numbers, 1},
    GpglCommand{"FN", Verb::Orientation, Numbers, 1},
    GpglCommand{"TB", Verb::Other, Numbered, 1},
    GpglCommand{"\\", Verb::WindowNear, Numbers, 2},
    GpglCommand{"Z", Verb::WindowFar, Numbers, 2},
    GpglCommand{"TF", Verb::Autoblade, Numbers, 1},
    GpglCommand{"FY", Verb::TrackEnhance, Numbers, 1},
    GpglCommand{"L", Verb::LineType, Numbers, 1},
    GpglCommand{"H", Verb::Home},
    GpglCommand{"TT", Verb::Home},
    GpglCommand{"SO", Verb::SetOrigin},
    GpglCommand{"FQ", Verb::Query, Numbered, 1},
    GpglCommand{"FG", Verb::Query},
    GpglCommand{"FA", Verb::Query},
    GpglCommand{"TC", Verb::Query},
    GpglCommand{"TI", Verb::Query},
    GpglCommand{"TO", Verb::Query},
    GpglCommand{"U", Verb::Query},
    GpglCommand{"[", Verb::Query},
    GpglCommand{"G", Verb::Query},
    GpglCommand{"?", Verb::Query},
    GpglCommand{"FW", Verb::Other, Numbers, 1},
    GpglCommand{"FM", Verb::Other, Numbers, 1},
    GpglCommand{"FO", Verb::Other},
    GpglCommand{"FU", Verb::Other, Numbers, 1},
    GpglCommand{"FD", Verb::Other, Numbers, 1},
    GpglCommand{"FB", Verb::Other},
    GpglCommand{"TJ", Verb::Other, Numbers, 1},
    GpglCommand{"*", Verb::Other, Numbers, 1},
    GpglCommand{"&", Verb::Other, Numbers, 3},
    GpglCommand{"BS", Verb::Other},
    GpglCommand{"BZ", Verb::Unknown, Unsupported},
    GpglCommand{"W", Verb::Unknown, Unsupported},
    GpglCommand{"WP", Verb::Unknown, Unsupported},
    GpglCommand{"]", Verb::Unknown, Unsupported},
    GpglCommand{")", Verb::Unknown, Unsupported},
    GpglCommand{"Y", Verb::Unknown, Unsupported},
    GpglCommand{"_", Verb::Unknown, Unsupported},
    GpglCommand{"P", Verb::Unknown, Text},
};

const GpglCommand* find_command(std::string_view mnemonic) {
  return command_named(kCommands, mnemonic);
}

bool is_letter(unsigned char c) { return c >= 'A' && c <= 'Z'; }
char to_char(unsigned char c) { return static_cast<char>(c); }

}  // namespace

void GpglReader::feed(std::span<const std::byte> piece, Program& into) {
  into.dialect = Dialect::Gpgl;
  for (const std::byte byte : piece) {
    take(std::to_integer<unsigned char>(byte), into);
    ++offset_;
  }
}

void GpglReader::finish(Program& into) {
  into.dialect = Dialect::Gpgl;
  if (state_ == State::Escape || state_ == State::Jog) {
    push_unknown(state_ == State::Jog ? std::string("\x1b\0", 2) : "\x1b", escape_at_, offset_,
                 into);
    into.truncated = true;
    state_ = resume_;
  }
  if (state_ == State::Between) return;
  push_unknown(std::exchange(raw_, {}), begin_, offset_, into);
  into.truncated = true;
  state_ = State::Between;
}

void GpglReader::take(unsigned char c, Program& into) {
  if (state_ == State::Escape || state_ == State::Jog) return take_escape(c, into);
  if (c == static_cast<unsigned char>(kEsc)) {
    resume_ = std::exchange(state_, State::Escape);
    escape_at_ = offset_;
    return;
  }
  if (state_ != State::Between && offset_ - begin_ >= kLongestCommand) give_up(into);
  switch (state_) {
    case State::Between:
      if (c == static_cast<unsigned char>(kEtx))
        append_command(Verb::Empty, {}, offset_, offset_ + 1, into);
      else if (!is_blank(c) && c != ',')
        begin(c);
      return;
    case State::Mnemonic:
      return take_mnemonic(c, into);
    case State::Numbers:
      return take_number(c, into);
    case State::FormDigit:
      if (c < '1' || c > '3') {
        state_ = State::Raw;
        return take(c, into);
      }
      raw_ += to_char(c);
      form_ = &kDeltaForms[static_cast<std::size_t>(c - '1')];
      state_ = State::Deltas;
      return;
    case State::Deltas:
      return take_delta(c, into);
    case State::Raw:
      if (c == static_cast<unsigned char>(kEtx)) return close(offset_ + 1, into);
      raw_ += to_char(c);
      return;
    case State::Escape:
    case State::Jog:
      return;
  }
}

/// A command without an end is not kept for ever: what there is of it is unknown, and the rest too.
void GpglReader::give_up(Program& into) {
  push_unknown(std::exchange(raw_, {}), begin_, offset_, into);
  begin_ = offset_;
  entry_ = nullptr;
  arguments_.clear();
  deltas_.clear();
  state_ = State::Raw;
}

void GpglReader::begin(unsigned char c) {
  begin_ = offset_;
  raw_.assign(1, to_char(c));
  mnemonic_.assign(1, to_char(c));
  entry_ = find_command(mnemonic_);
  arguments_.clear();
  deltas_.clear();
  form_ = nullptr;
  index_ = digits_ = 0;
  weight_ = 1;
  if (entry_ != nullptr && entry_->form == Text)
    state_ = State::Raw;
  else
    state_ = entry_ != nullptr || is_letter(c) ? State::Mnemonic : State::Raw;
}

void GpglReader::take_escape(unsigned char c, Program& into) {
  const State interrupted = resume_;
  const std::uint64_t end = offset_ + 1;
  if (state_ == State::Jog) {
    into.args.push_back(c);
    append_command(Verb::Other, "JOG", escape_at_, end, into);
    into.commands.back().first = static_cast<std::uint32_t>(into.args.size() - 1);
    into.commands.back().count = 1;
    state_ = interrupted;
    return;
  }
  if (c == 0x00) {
    state_ = State::Jog;
    return;
  }
  state_ = interrupted;
  switch (c) {
    case 0x05:
      return append_command(Verb::Query, "ENQ", escape_at_, end, into);
    case 0x15:
      return append_command(Verb::Query, "NAK", escape_at_, end, into);
    case 0x0f:
      return append_command(Verb::Query, "SI", escape_at_, end, into);
    case 0x0b:
      return append_command(Verb::Query, "VT", escape_at_, end, into);
    case 0x04:
      if (interrupted != State::Between)
        push_unknown(std::exchange(raw_, {}), begin_, escape_at_, into);
      append_command(Verb::Initialise, "EOT", escape_at_, end, into);
      state_ = State::Between;
      position_ = {};
      return;
    default:
      return push_unknown({kEsc, to_char(c)}, escape_at_, end, into);
  }
}

void GpglReader::take_mnemonic(unsigned char c, Program& into) {
  if (is_letter(c)) {
    const GpglCommand* const longer = find_command(mnemonic_ + to_char(c));
    if (entry_ != nullptr && longer == nullptr) {  // a whole command without arguments
      close(offset_, into);
      return begin(c);
    }
    mnemonic_ += to_char(c);
    raw_ += to_char(c);
    entry_ = longer;
    if (longer != nullptr)
      state_ = longer->form == GpglForm::Deltas ? State::FormDigit : State::Numbers;
    return;
  }
  state_ = State::Numbers;
  take_number(c, into);
}

void GpglReader::take_number(unsigned char c, Program& into) {
  if (arguments_.take(to_char(c))) {
    raw_ += to_char(c);
    return;
  }
  if (c == static_cast<unsigned char>(kEtx)) return close(offset_ + 1, into);
  const char letter = to_char(c);
  if (is_letter(c) || find_command({&letter, 1}) != nullptr) {
    close(offset_, into);
    return begin(c);
  }
  raw_ += to_char(c);
  entry_ = nullptr;
  state_ = State::Raw;
}

void GpglReader::take_delta(unsigned char c, Program& into) {
  if (c == static_cast<unsigned char>(kEtx)) return close_deltas(offset_ + 1, into);
  raw_ += to_char(c);
  if (c < kDeltaZero) {
    entry_ = nullptr;
    state_ = State::Raw;
    return;
  }
  index_ += (c - kDeltaZero) * weight_;
  weight_ *= kDeltaBase;
  if (++digits_ < form_->digits) return;
  const Delta delta = delta_of(*form_, index_);
  const MachinePoint from = deltas_.empty() ? position_ : deltas_.back();
  deltas_.push_back(
      {from.a + static_cast<double>(delta.feed), from.b + static_cast<double>(delta.carriage)});
  index_ = digits_ = 0;
  weight_ = 1;
}

void GpglReader::close_deltas(std::uint64_t end, Program& into) {
  const auto stray = static_cast<std::size_t>(digits_);
  if (deltas_.empty()) {
    state_ = State::Between;
    return push_unknown(std::exchange(raw_, {}), begin_, end, into);
  }
  const auto first = static_cast<std::uint32_t>(into.points.size());
  into.points.insert(into.points.end(), deltas_.begin(), deltas_.end());
  position_ = deltas_.back();
  into.commands.push_back({Verb::Draw, first, static_cast<std::uint32_t>(deltas_.size()), begin_,
                           end - (stray > 0 ? stray + 1 : 0), 0});
  if (stray > 0)  // bytes that make no whole point
    push_unknown(raw_.substr(raw_.size() - stray), end - stray - 1, end, into);
  state_ = State::Between;
}

void GpglReader::close(std::uint64_t end, Program& into) {
  state_ = State::Between;
  arguments_.end();
  const std::vector<double>& values = arguments_.values();
  const bool unknown = entry_ == nullptr || arguments_.bad() || values.size() < entry_->least;
  if (unknown || entry_->form == Unsupported || entry_->form == Text ||
      entry_->form == GpglForm::Deltas)
    return push_unknown(std::exchange(raw_, {}), begin_, end, into);
  if (entry_->form == Points || entry_->form == Steps) {
    if (values.empty() || values.size() % 2 != 0)
      return push_unknown(std::exchange(raw_, {}), begin_, end, into);
    return push_points(entry_->form == Steps, end, into);
  }
  // A scale other than 1:1 would move every later point: not followed, and so not understood.
  if (entry_->mnemonic == "&" && (values[0] != values[2] || values[1] != values[2]))
    return push_unknown(std::exchange(raw_, {}), begin_, end, into);
  Verb verb = entry_->verb;
  std::string text(entry_->mnemonic);
  std::size_t skip = 0;
  if (entry_->form == Numbered) {
    text += fmt::format("{}", values[0]);
    skip = 1;
    if (text == "TB50") verb = Verb::Orientation;
    if (text == "TB71") verb = Verb::Query;
  }
  if (verb == Verb::Home || verb == Verb::SetOrigin) position_ = {};
  const auto first = static_cast<std::uint32_t>(into.args.size());
  into.args.insert(into.args.end(), values.begin() + static_cast<std::ptrdiff_t>(skip),
                   values.end());
  append_command(verb, std::move(text), begin_, end, into);
  into.commands.back().first = first;
  into.commands.back().count = static_cast<std::uint32_t>(values.size() - skip);
}

void GpglReader::push_points(bool relative, std::uint64_t end, Program& into) {
  const std::vector<double>& values = arguments_.values();
  append_points(entry_->verb, values, relative, position_, begin_, end, into);
}

void GpglReader::push_unknown(std::string text, std::uint64_t begin, std::uint64_t end,
                              Program& into) {
  append_command(Verb::Unknown, std::move(text), begin, end, into);
}

}  // namespace popcut
