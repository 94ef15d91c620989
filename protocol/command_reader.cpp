// SPDX-License-Identifier: MIT
#include "protocol/command_reader.hpp"

#include <algorithm>
#include <utility>

namespace popcut {

void CommandReader::feed(std::span<const std::byte> piece, Program& into) {
  into.dialect = dialect_;
  into.unit_mm = unit_mm_;
  for (const std::byte byte : piece) {
    const auto c = std::to_integer<char>(byte);
    if (in_escape()) {
      control_ += c;
      take_escape(c, into);
    } else if (c == kEsc) {
      resume_ = std::exchange(state_, State::Escape);
      escape_at_ = offset_;
      control_.assign(1, kEsc);
    } else {
      if (state_ != State::Between && offset_ - begin_ >= kLongestCommand) give_up(into);
      take(c, into);
    }
    ++offset_;
  }
}

void CommandReader::finish(Program& into) {
  into.dialect = dialect_;
  into.unit_mm = unit_mm_;
  if (in_escape()) {
    push(Verb::Unknown, std::exchange(control_, {}), escape_at_, offset_, into);
    into.truncated = true;
    state_ = resume_;
  }
  if (state_ == State::Between) return;
  push_unknown(offset_, into);
  into.truncated = true;
  state_ = State::Between;
}

/// A command without an end is not kept forever: its bytes so far are one Unknown, the rest
/// another.
void CommandReader::give_up(Program& into) {
  push_unknown(offset_, into);
  begin_ = offset_;
  entry_ = nullptr;
  mnemonic_.clear();
  arguments_.clear();
  state_ = State::Raw;
}

const CommandEntry* CommandReader::find_command(std::string_view mnemonic) const {
  const auto found = std::find_if(commands_.begin(), commands_.end(),
                                  [&](const CommandEntry& c) { return c.mnemonic == mnemonic; });
  return found == commands_.end() ? nullptr : &*found;
}

void CommandReader::begin_command(char c) {
  begin_ = offset_;
  raw_.assign(1, c);
  entry_ = nullptr;
  arguments_.clear();
}

void CommandReader::push(Verb verb, std::string text, std::uint64_t begin, std::uint64_t end,
                         Program& into) {
  std::uint32_t index = 0;
  if (!text.empty()) {
    // The same few mnemonics repeat, so each is kept once; Unknown texts are not searched.
    constexpr std::size_t kSearched = 64;
    const std::size_t searched = verb == Verb::Unknown ? 0 : std::min(into.texts.size(), kSearched);
    const auto known = std::find(into.texts.begin(),
                                 into.texts.begin() + static_cast<std::ptrdiff_t>(searched), text);
    index = static_cast<std::uint32_t>(known - into.texts.begin());
    if (index == searched) {
      index = static_cast<std::uint32_t>(into.texts.size());
      into.texts.push_back(std::move(text));
    }
  }
  into.commands.push_back({verb, 0, 0, begin, end, index});
}

void CommandReader::push_unknown(std::uint64_t end, Program& into) {
  push(Verb::Unknown, std::exchange(raw_, {}), begin_, end, into);
}

void CommandReader::push_numbers(Verb verb, std::string text, std::span<const double> values,
                                 std::uint64_t end, Program& into) const {
  const auto first = static_cast<std::uint32_t>(into.args.size());
  into.args.insert(into.args.end(), values.begin(), values.end());
  push(verb, std::move(text), begin_, end, into);
  into.commands.back().first = first;
  into.commands.back().count = static_cast<std::uint32_t>(values.size());
}

void CommandReader::push_points(Verb verb, bool relative, std::uint64_t end, Program& into) {
  const std::vector<double>& coordinates = arguments_.values();
  const auto first = static_cast<std::uint32_t>(into.points.size());
  for (std::size_t k = 0; k + 1 < coordinates.size(); k += 2) {
    const MachinePoint from = relative ? position_ : MachinePoint{};
    position_ = {from.a + coordinates[k], from.b + coordinates[k + 1]};
    into.points.push_back(position_);
  }
  into.commands.push_back(
      {verb, first, static_cast<std::uint32_t>(coordinates.size() / 2), begin_, end, 0});
}

}  // namespace popcut
