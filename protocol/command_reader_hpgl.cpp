// SPDX-License-Identifier: MIT
#include <array>
#include <string_view>
#include <utility>

#include "core/text/words.hpp"
#include "protocol/command_reader.hpp"

namespace popcut {
namespace {

constexpr auto kHpglCommands = [] {
  using enum Verb;
  using enum CommandForm;
  return std::array{
      CommandEntry{"PD", Draw, Points},
      CommandEntry{"PU", Move, Points},
      CommandEntry{"PA", Absolute, Points},
      CommandEntry{"PR", Other, Points},
      // One letter: U and D of some vinyl cutters, the others CAMM-GL mode 1, where I and R are
      // relative. Its arcs, texts and hatchings (A C E G K N P Q S T) are not followed.
      CommandEntry{"U", Move, Points},
      CommandEntry{"D", Draw, Points},
      CommandEntry{"M", Move, Points},
      CommandEntry{"I", Draw, Points},
      CommandEntry{"R", Move, Points},
      CommandEntry{"H", Home},
      CommandEntry{"L", LineType},
      CommandEntry{"B", Other},
      CommandEntry{"F", Speed},
      CommandEntry{"SP", SelectTool},
      CommandEntry{"VS", Speed},
      CommandEntry{"FS", Force},
      CommandEntry{"IN", Initialise},
      CommandEntry{"DF", Other},
      CommandEntry{"AS", Other},
      CommandEntry{"FC", BladeOffset},
      CommandEntry{"FD", Other},
      CommandEntry{"IP", Other},
      CommandEntry{"IW", WindowFar},
      CommandEntry{"LT", LineType},
      CommandEntry{"PS", Other},
      CommandEntry{"PW", Other},
      CommandEntry{"WU", Other},
      CommandEntry{"PT", Other},
      CommandEntry{"NP", Other},
      CommandEntry{"NR", Other},
      CommandEntry{"PG", Other},
      CommandEntry{"TR", Other},
      CommandEntry{"QL", Other},
      CommandEntry{"OA", Query},
      CommandEntry{"OC", Query},
      CommandEntry{"OE", Query},
      CommandEntry{"OF", Query},
      CommandEntry{"OH", Query},
      CommandEntry{"OI", Query},
      CommandEntry{"OP", Query},
      CommandEntry{"OS", Query},
      CommandEntry{"OW", Query},
      CommandEntry{"SC", Unknown, Unsupported},
      CommandEntry{"RO", Unknown, Unsupported},
      CommandEntry{"LB", Unknown, Text},
      CommandEntry{"PE", Unknown, Encoded},
  };
}();

constexpr std::size_t kLongestControl = 256;

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

}  // namespace

HpglReader::HpglReader() : CommandReader(Dialect::Hpgl, 0.025, kHpglCommands) {}

void HpglReader::take(char c, Program& into) {
  switch (state_) {
    case State::Between:
      if (c == ';')
        push(Verb::Empty, {}, offset_, offset_ + 1, into);
      else if (!is_blank(c))
        begin(c);
      return;
    case State::Mnemonic:
      if (is_letter(c)) {
        raw_ += c;
        return take_mnemonic(capital(c));
      }
      // Not a letter: a command of one letter, if there is one.
      entry_ = find_command(mnemonic_);
      state_ = entry_ != nullptr ? State::Numbers : State::Raw;
      return take(c, into);
    case State::Numbers:
      return take_number(c, into);
    case State::Raw:
      if (c == raw_end_) return close(offset_ + 1, into);
      raw_ += c;
      return;
    default:
      return;
  }
}

void HpglReader::begin(char c) {
  begin_command(c);
  mnemonic_.assign(1, capital(c));
  raw_end_ = ';';
  state_ = is_letter(c) || c == '!' ? State::Mnemonic : State::Raw;
}

void HpglReader::take_escape(char c, Program& into) {
  const auto done = [&](Verb verb) {
    state_ = resume_;
    push(verb, std::exchange(control_, {}), escape_at_, offset_ + 1, into);
  };
  if (state_ == State::Escape) {
    if (c == '.')
      state_ = State::Control;
    else
      done(c == 'E' ? Verb::Other : Verb::Unknown);
    return;
  }
  if (state_ == State::Control) {
    constexpr std::string_view kQueries = "BEOL", kPlain = "(YZ)JKR";
    if (kQueries.find(c) != std::string_view::npos)
      done(Verb::Query);
    else if (kPlain.find(c) != std::string_view::npos)
      done(Verb::Other);
    else if (is_letter(c) || c == '@')
      state_ = State::ControlArgs;
    else
      done(Verb::Unknown);
    return;
  }
  constexpr std::string_view kArguments = "0123456789;-+ ";
  if (c == ':')
    done(Verb::Other);
  else if (kArguments.find(c) == std::string_view::npos || control_.size() > kLongestControl)
    done(Verb::Unknown);
}

void HpglReader::take_mnemonic(char c) {
  mnemonic_ += c;
  if (mnemonic_.front() == '!' && mnemonic_.size() < 3) return;
  entry_ = find_command(mnemonic_);
  state_ = State::Numbers;
  if (entry_ == nullptr ||
      (entry_->form != CommandForm::Text && entry_->form != CommandForm::Encoded))
    return;
  state_ = State::Raw;
  raw_end_ = entry_->form == CommandForm::Text ? kEtx : ';';
}

void HpglReader::take_number(char c, Program& into) {
  if (arguments_.take(c)) {
    raw_ += c;
    return;
  }
  if (c == ';') return close(offset_ + 1, into);
  if (is_letter(c) || c == '!') {
    close(offset_, into);
    return begin(c);
  }
  raw_ += c;
  entry_ = nullptr;
  mnemonic_.clear();
  state_ = State::Raw;
}

void HpglReader::close(std::uint64_t end, Program& into) {
  const bool raw = state_ == State::Raw;
  state_ = State::Between;
  arguments_.end();
  const std::vector<double>& values = arguments_.values();
  const bool vendor = !raw && mnemonic_.size() == 3 && mnemonic_.front() == '!';
  const bool known = entry_ != nullptr && entry_->verb != Verb::Unknown;
  const bool odd = known && entry_->form == CommandForm::Points && values.size() % 2 != 0;
  if (raw || arguments_.bad() || odd || (!known && !vendor)) return push_unknown(end, into);
  if (known && entry_->form == CommandForm::Points) return close_points(end, into);
  Verb verb = vendor ? Verb::Other : entry_->verb;
  if (values.empty() && (verb == Verb::Speed || verb == Verb::Force || verb == Verb::LineType ||
                         verb == Verb::BladeOffset))
    verb = Verb::Other;  // back to the default
  if (verb == Verb::Initialise) down_ = relative_ = false;
  if (mnemonic_ == "DF") relative_ = false;  // default settings; the pen stays where it is
  if (verb == Verb::Home) position_ = {}, down_ = false;
  if (verb == Verb::WindowFar) return close_window(end, into);
  constexpr std::array kNone{0.0};
  const bool deselects = verb == Verb::SelectTool && values.empty();
  push_numbers(verb, mnemonic_, deselects ? std::span<const double>(kNone) : std::span(values), end,
               into);
}

// One command of HPGL is both corners; without numbers the window is as large as it can be.
void HpglReader::close_window(std::uint64_t end, Program& into) {
  const std::span<const double> values = arguments_.values();
  if (!values.empty() && values.size() != 4) return push_unknown(end, into);
  push_numbers(Verb::WindowNear, mnemonic_, values.first(values.size() / 2), end, into);
  push_numbers(Verb::WindowFar, mnemonic_, values.last(values.size() / 2), end, into);
  // Each has bytes of its own: the second half the last one.
  into.commands.back().begin = into.commands.rbegin()[1].end = end - 1;
}

void HpglReader::close_points(std::uint64_t end, Program& into) {
  const std::vector<double>& values = arguments_.values();
  Verb verb = entry_->verb;
  const std::string_view word = entry_->mnemonic;
  const bool one_letter = word.size() == 1;
  bool relative = relative_;
  if (one_letter || word == "PD" || word == "PU") {
    down_ = verb == Verb::Draw;
    if (one_letter && word != "U" && word != "D") relative = word == "I" || word == "R";
  } else {
    relative = relative_ = word == "PR";
    if (values.empty()) return push(verb, mnemonic_, begin_, end, into);
    verb = down_ ? Verb::Draw : Verb::Move;
  }
  push_points(verb, relative, end, into);
}

}  // namespace popcut
