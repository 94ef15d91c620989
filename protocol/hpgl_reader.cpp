// SPDX-License-Identifier: MIT
#include "protocol/hpgl_reader.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "protocol/append.hpp"
#include "protocol/gpgl_variants.hpp"

namespace popcut {

enum class HpglForm : std::uint8_t {
  Numbers,      // arguments as sent
  Points,       // PU PD PA PR
  Unsupported,  // known to change what is drawn in a way that we cannot follow
  Label,        // text up to ETX
  Encoded,      // bytes up to the semicolon
};

struct HpglCommand {
  std::string_view mnemonic;
  Verb verb;
  HpglForm form{HpglForm::Numbers};
};

namespace {

using enum HpglForm;

constexpr std::array kCommands{
    HpglCommand{"PD", Verb::Draw, Points},
    HpglCommand{"PU", Verb::Move, Points},
    HpglCommand{"PA", Verb::Absolute, Points},
    HpglCommand{"PR", Verb::Other, Points},
    // One letter: U and D of some vinyl cutters, the others CAMM-GL mode 1, where I and R are
    // relative. Its arcs, texts and hatchings (A C E G K N P Q S T) are not followed.
    HpglCommand{"U", Verb::Move, Points},
    HpglCommand{"D", Verb::Draw, Points},
    HpglCommand{"M", Verb::Move, Points},
    HpglCommand{"I", Verb::Draw, Points},
    HpglCommand{"R", Verb::Move, Points},
    HpglCommand{"H", Verb::Home},
    HpglCommand{"L", Verb::LineType},
    HpglCommand{"B", Verb::Other},
    HpglCommand{"F", Verb::Speed},
    HpglCommand{"SP", Verb::SelectTool},
    HpglCommand{"VS", Verb::Speed},
    HpglCommand{"FS", Verb::Force},
    HpglCommand{"IN", Verb::Initialise},
    HpglCommand{"DF", Verb::Other},
    HpglCommand{"AS", Verb::Other},
    HpglCommand{"FC", Verb::BladeOffset},
    HpglCommand{"FD", Verb::Other},
    HpglCommand{"IP", Verb::Other},
    HpglCommand{"IW", Verb::Other},
    HpglCommand{"LT", Verb::LineType},
    HpglCommand{"PS", Verb::Other},
    HpglCommand{"PW", Verb::Other},
    HpglCommand{"WU", Verb::Other},
    HpglCommand{"PT", Verb::Other},
    HpglCommand{"NP", Verb::Other},
    HpglCommand{"NR", Verb::Other},
    HpglCommand{"PG", Verb::Other},
    HpglCommand{"TR", Verb::Other},
    HpglCommand{"QL", Verb::Other},
    HpglCommand{"OA", Verb::Query},
    HpglCommand{"OC", Verb::Query},
    HpglCommand{"OE", Verb::Query},
    HpglCommand{"OF", Verb::Query},
    HpglCommand{"OH", Verb::Query},
    HpglCommand{"OI", Verb::Query},
    HpglCommand{"OP", Verb::Query},
    HpglCommand{"OS", Verb::Query},
    HpglCommand{"OW", Verb::Query},
    HpglCommand{"SC", Verb::Unknown, Unsupported},
    HpglCommand{"RO", Verb::Unknown, Unsupported},
    HpglCommand{"LB", Verb::Unknown, Label},
    HpglCommand{"PE", Verb::Unknown, Encoded},
};

constexpr std::size_t kLongestControl = 256;

const HpglCommand* find_command(std::string_view mnemonic) {
  return command_named(kCommands, mnemonic);
}

bool is_letter(unsigned char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
char capital(unsigned char c) {
  return static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
}

}  // namespace

void HpglReader::feed(std::span<const std::byte> piece, Program& into) {
  into.dialect = Dialect::Hpgl;
  into.unit_mm = 0.025;
  for (const std::byte byte : piece) {
    take(std::to_integer<unsigned char>(byte), into);
    ++offset_;
  }
}

void HpglReader::finish(Program& into) {
  into.dialect = Dialect::Hpgl;
  into.unit_mm = 0.025;
  if (state_ == State::Escape || state_ == State::Control || state_ == State::ControlArg) {
    append_command(Verb::Unknown, std::exchange(control_, {}), escape_at_, offset_, into);
    into.truncated = true;
    state_ = resume_;
  }
  if (state_ == State::Between) return;
  append_command(Verb::Unknown, std::exchange(raw_, {}), begin_, offset_, into);
  into.truncated = true;
  state_ = State::Between;
}

void HpglReader::take(unsigned char c, Program& into) {
  switch (state_) {
    case State::Escape:
    case State::Control:
    case State::ControlArg:
      return take_escape(c, into);
    default:
      break;
  }
  if (c == static_cast<unsigned char>(kEsc)) {
    resume_ = std::exchange(state_, State::Escape);
    escape_at_ = offset_;
    control_.assign(1, kEsc);
    return;
  }
  if (state_ != State::Between && offset_ - begin_ >= kLongestCommand) give_up(into);
  switch (state_) {
    case State::Between:
      if (c == ';')
        append_command(Verb::Empty, {}, offset_, offset_ + 1, into);
      else if (!is_blank(c))
        begin(static_cast<char>(c));
      return;
    case State::Mnemonic:
      if (is_letter(c)) {
        raw_ += static_cast<char>(c);
        return take_mnemonic(capital(c));
      }
      // Not a letter: a command of one letter, if there is one.
      entry_ = find_command(mnemonic_);
      state_ = entry_ != nullptr ? State::Numbers : State::Raw;
      return take(c, into);
    case State::Numbers:
      return take_number(c, into);
    case State::Raw:
      if (c == static_cast<unsigned char>(raw_end_)) return close(offset_ + 1, into);
      raw_ += static_cast<char>(c);
      return;
    default:
      return;
  }
}

/// As `GpglReader::give_up`.
void HpglReader::give_up(Program& into) {
  append_command(Verb::Unknown, std::exchange(raw_, {}), begin_, offset_, into);
  begin_ = offset_;
  entry_ = nullptr;
  mnemonic_.clear();
  arguments_.clear();
  state_ = State::Raw;
}

void HpglReader::begin(char c) {
  begin_ = offset_;
  raw_.assign(1, c);
  mnemonic_.assign(1, capital(static_cast<unsigned char>(c)));
  raw_end_ = ';';
  entry_ = nullptr;
  arguments_.clear();
  state_ = is_letter(static_cast<unsigned char>(c)) || c == '!' ? State::Mnemonic : State::Raw;
}

void HpglReader::take_escape(unsigned char c, Program& into) {
  control_ += static_cast<char>(c);
  const auto done = [&](Verb verb) {
    state_ = resume_;
    append_command(verb, std::exchange(control_, {}), escape_at_, offset_ + 1, into);
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
    if (kQueries.find(static_cast<char>(c)) != std::string_view::npos)
      done(Verb::Query);
    else if (kPlain.find(static_cast<char>(c)) != std::string_view::npos)
      done(Verb::Other);
    else if (is_letter(c) || c == '@')
      state_ = State::ControlArg;
    else
      done(Verb::Unknown);
    return;
  }
  constexpr std::string_view kArguments = "0123456789;-+ ";
  if (c == ':')
    done(Verb::Other);
  else if (kArguments.find(static_cast<char>(c)) == std::string_view::npos ||
           control_.size() > kLongestControl)
    done(Verb::Unknown);
}

void HpglReader::take_mnemonic(char c) {
  mnemonic_ += c;
  if (mnemonic_.front() == '!' && mnemonic_.size() < 3) return;
  entry_ = find_command(mnemonic_);
  state_ = State::Numbers;
  if (entry_ == nullptr || (entry_->form != Label && entry_->form != Encoded)) return;
  state_ = State::Raw;
  raw_end_ = entry_->form == Label ? kEtx : ';';
}

void HpglReader::take_number(unsigned char c, Program& into) {
  if (arguments_.take(static_cast<char>(c))) {
    raw_ += static_cast<char>(c);
    return;
  }
  if (c == ';') return close(offset_ + 1, into);
  if (is_letter(c) || c == '!') {
    close(offset_, into);
    return begin(static_cast<char>(c));
  }
  raw_ += static_cast<char>(c);
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
  const bool odd = known && entry_->form == Points && values.size() % 2 != 0;
  if (raw || arguments_.bad() || odd || (!known && !vendor))
    return append_command(Verb::Unknown, std::exchange(raw_, {}), begin_, end, into);
  if (known && entry_->form == Points) return push_points(end, into);
  Verb verb = vendor ? Verb::Other : entry_->verb;
  if (values.empty() && (verb == Verb::Speed || verb == Verb::Force || verb == Verb::LineType ||
                         verb == Verb::BladeOffset))
    verb = Verb::Other;  // back to the default
  if (verb == Verb::Initialise) down_ = relative_ = false;
  if (verb == Verb::Home) position_ = {}, down_ = false;
  const auto first = static_cast<std::uint32_t>(into.args.size());
  into.args.insert(into.args.end(), values.begin(), values.end());
  if (verb == Verb::SelectTool && values.empty()) into.args.push_back(0);
  append_command(verb, mnemonic_, begin_, end, into);
  into.commands.back().first = first;
  into.commands.back().count = static_cast<std::uint32_t>(into.args.size()) - first;
}

void HpglReader::push_points(std::uint64_t end, Program& into) {
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
    if (values.empty()) return append_command(verb, mnemonic_, begin_, end, into);
    verb = down_ ? Verb::Draw : Verb::Move;
  }
  append_points(verb, values, relative, position_, begin_, end, into);
}

}  // namespace popcut
