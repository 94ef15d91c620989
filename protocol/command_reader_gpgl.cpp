// SPDX-License-Identifier: MIT
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "protocol/command_reader.hpp"

namespace popcut {
namespace {

// Sources: Graphtec's GP-GL command list, and what Silhouette's own software and published drivers
// send. The commands that draw most come first.
constexpr auto kGpglCommands = [] {
  using enum Verb;
  using enum CommandForm;
  return std::array{
      CommandEntry{"D", Draw, Points},
      CommandEntry{"M", Move, Points},
      CommandEntry{"BE", Draw, Deltas},
      CommandEntry{"E", Draw, Steps},
      CommandEntry{"O", Move, Steps},
      CommandEntry{"!", Speed, Numbers, 1},
      CommandEntry{"FX", Force, Numbers, 1},
      CommandEntry{"FC", BladeOffset, Numbers, 1},
      CommandEntry{"FE", CornerLift, Numbers, 1},
      CommandEntry{"FF", CornerExtend, Numbers, 1},
      CommandEntry{"J", SelectTool, Numbers, 1},
      CommandEntry{"TG", Mat, Numbers, 1},
      CommandEntry{"FN", Orientation, Numbers, 1},
      CommandEntry{"TB", Other, Numbered, 1},
      CommandEntry{"\\", WindowNear, Numbers, 2},
      CommandEntry{"Z", WindowFar, Numbers, 2},
      CommandEntry{"TF", Autoblade, Numbers, 1},
      CommandEntry{"FY", TrackEnhance, Numbers, 1},
      CommandEntry{"L", LineType, Numbers, 1},
      CommandEntry{"H", Home},
      CommandEntry{"TT", Home},
      CommandEntry{"SO", SetOrigin},
      CommandEntry{"FQ", Query, Numbered, 1},
      CommandEntry{"FG", Query},
      CommandEntry{"FA", Query},
      CommandEntry{"TC", Query},
      CommandEntry{"TI", Query},
      CommandEntry{"TO", Query},
      CommandEntry{"U", Query},
      CommandEntry{"[", Query},
      CommandEntry{"G", Query},
      CommandEntry{"?", Query},
      CommandEntry{"FW", Other, Numbers, 1},
      CommandEntry{"FM", Other, Numbers, 1},
      CommandEntry{"FO", Other},
      CommandEntry{"FU", Other, Numbers, 1},
      CommandEntry{"FD", Other, Numbers, 1},
      CommandEntry{"FB", Other},
      CommandEntry{"TJ", Other, Numbers, 1},
      CommandEntry{"*", Other, Numbers, 1},
      CommandEntry{"&", Other, Numbers, 3},
      CommandEntry{"BS", Other},
      CommandEntry{"BZ", Unknown, Unsupported},
      CommandEntry{"W", Unknown, Unsupported},
      CommandEntry{"WP", Unknown, Unsupported},
      CommandEntry{"]", Unknown, Unsupported},
      CommandEntry{")", Unknown, Unsupported},
      CommandEntry{"Y", Unknown, Unsupported},
      CommandEntry{"_", Unknown, Unsupported},
      CommandEntry{"P", Unknown, Text},
  };
}();

bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

GpglReader::GpglReader() : CommandReader(Dialect::Gpgl, 0.05, kGpglCommands) {}

void GpglReader::take(char c, Program& into) {
  switch (state_) {
    case State::Between:
      if (c == kEtx)
        push(Verb::Empty, {}, offset_, offset_ + 1, into);
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
      raw_ += c;
      form_ = &kDeltaForms[static_cast<std::size_t>(c - '1')];
      state_ = State::Deltas;
      return;
    case State::Deltas:
      return take_delta(c, into);
    case State::Raw:
      if (c == kEtx) return close(offset_ + 1, into);
      raw_ += c;
      return;
    default:
      return;
  }
}

void GpglReader::begin(char c) {
  begin_command(c);
  mnemonic_.assign(1, c);
  entry_ = find_command(mnemonic_);
  deltas_.clear();
  form_ = nullptr;
  index_ = digits_ = 0;
  weight_ = 1;
  if (entry_ != nullptr && entry_->form == CommandForm::Text)
    state_ = State::Raw;
  else
    state_ = entry_ != nullptr || is_capital(c) ? State::Mnemonic : State::Raw;
}

void GpglReader::take_escape(char c, Program& into) {
  const State interrupted = resume_;
  const std::uint64_t end = offset_ + 1;
  if (state_ == State::Jog) {
    into.args.push_back(static_cast<unsigned char>(c));
    push(Verb::Other, "JOG", escape_at_, end, into);
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
      return push(Verb::Query, "ENQ", escape_at_, end, into);
    case 0x15:
      return push(Verb::Query, "NAK", escape_at_, end, into);
    case 0x0f:
      return push(Verb::Query, "SI", escape_at_, end, into);
    case 0x0b:
      return push(Verb::Query, "VT", escape_at_, end, into);
    case 0x04:
      if (interrupted != State::Between) push_unknown(escape_at_, into);
      push(Verb::Initialise, "EOT", escape_at_, end, into);
      state_ = State::Between;
      position_ = {};
      return;
    default:
      return push(Verb::Unknown, std::exchange(control_, {}), escape_at_, end, into);
  }
}

void GpglReader::take_mnemonic(char c, Program& into) {
  if (is_capital(c)) {
    const CommandEntry* const longer = find_command(mnemonic_ + c);
    if (entry_ != nullptr && longer == nullptr) {  // a whole command without arguments
      close(offset_, into);
      return begin(c);
    }
    mnemonic_ += c;
    raw_ += c;
    entry_ = longer;
    if (longer != nullptr)
      state_ = longer->form == CommandForm::Deltas ? State::FormDigit : State::Numbers;
    return;
  }
  state_ = State::Numbers;
  take_number(c, into);
}

void GpglReader::take_number(char c, Program& into) {
  if (arguments_.take(c)) {
    raw_ += c;
    return;
  }
  if (c == kEtx) return close(offset_ + 1, into);
  if (is_capital(c) || find_command({&c, 1}) != nullptr) {
    close(offset_, into);
    return begin(c);
  }
  raw_ += c;
  entry_ = nullptr;
  state_ = State::Raw;
}

void GpglReader::take_delta(char c, Program& into) {
  if (c == kEtx) return close_deltas(offset_ + 1, into);
  raw_ += c;
  const auto digit = static_cast<unsigned char>(c);
  if (digit < kDeltaZero) {
    entry_ = nullptr;
    state_ = State::Raw;
    return;
  }
  index_ += (digit - kDeltaZero) * weight_;
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
    return push_unknown(end, into);
  }
  const auto first = static_cast<std::uint32_t>(into.points.size());
  into.points.insert(into.points.end(), deltas_.begin(), deltas_.end());
  position_ = deltas_.back();
  into.commands.push_back({Verb::Draw, first, static_cast<std::uint32_t>(deltas_.size()), begin_,
                           end - (stray > 0 ? stray + 1 : 0), 0});
  if (stray > 0)  // bytes that make no whole point
    push(Verb::Unknown, raw_.substr(raw_.size() - stray), end - stray - 1, end, into);
  state_ = State::Between;
}

void GpglReader::close(std::uint64_t end, Program& into) {
  using enum CommandForm;
  state_ = State::Between;
  arguments_.end();
  const std::vector<double>& values = arguments_.values();
  const bool unknown = entry_ == nullptr || arguments_.bad() || values.size() < entry_->least;
  if (unknown || entry_->form == Unsupported || entry_->form == Text || entry_->form == Deltas)
    return push_unknown(end, into);
  if (entry_->form == Points || entry_->form == Steps) {
    if (values.empty() || values.size() % 2 != 0) return push_unknown(end, into);
    return push_points(entry_->verb, entry_->form == Steps, end, into);
  }
  // A scale other than 1:1 would move every later point. It is not followed, so it is Unknown.
  if (entry_->mnemonic == "&" && (values[0] != values[2] || values[1] != values[2]))
    return push_unknown(end, into);
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
  push_numbers(verb, std::move(text), std::span(values).subspan(skip), end, into);
}

}  // namespace popcut
