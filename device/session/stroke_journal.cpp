// SPDX-License-Identifier: MIT
#include "device/session/stroke_journal.hpp"

#include <algorithm>

namespace popcut {
bool StrokeJournal::intend(std::uint64_t until) {
  if (failure_) return false;
  const std::int64_t last = begun_before(until) - 1;
  if (last <= intended_) return true;
  if (options_.intend) {
    if (const Result<void> written = options_.intend(last); !written) {
      failure_ = written.error();
      return false;
    }
  }
  intended_ = last;
  return true;
}

void StrokeJournal::settle(std::uint64_t ready_bytes, std::uint64_t good_bytes,
                           std::uint64_t accepted) {
  if (failure_ || !options_.settle || accepted <= program_.geometry.begin) return;
  const std::uint64_t pushed =
      good_bytes - std::min<std::uint64_t>(good_bytes, machine_.buffer_bytes);
  const std::uint64_t sure = std::min(accepted, std::max(ready_bytes, pushed));
  const std::int64_t taken =
      std::lower_bound(lines_.begin(), lines_.end(), accepted) - lines_.begin() - 1;
  const auto& strokes = program_.strokes;
  const auto unsure = std::partition_point(strokes.begin(), strokes.end(),
                                           [&](const ByteRange& s) { return s.end <= sure; });
  const std::int64_t certain = std::min<std::int64_t>(taken, unsure - strokes.begin() - 1);
  if (certain <= certain_ && taken <= taken_) return;
  certain_ = std::max(certain, certain_);
  taken_ = std::max(taken, taken_);
  const Result<void> written =
      options_.settle(certain_, taken_, std::min(accepted, program_.geometry.end));
  if (!written) failure_ = written.error();
}

std::uint64_t StrokeJournal::stop_after(std::uint64_t byte) const {
  const auto& strokes = program_.strokes;
  if (byte == program_.geometry.begin) return byte;
  const auto at = static_cast<std::size_t>(
      std::partition_point(strokes.begin(), strokes.end(),
                           [&](const ByteRange& stroke) { return stroke.end < byte; }) -
      strokes.begin());
  if (at == strokes.size()) return program_.geometry.end;
  if (strokes[at].end == byte) return byte;
  return byte <= lines_[at] && byte > strokes[at].begin ? lines_[at] : strokes[at].end;
}

std::string StrokeJournal::lift_at(std::uint64_t byte) const {
  for (auto k = static_cast<std::size_t>(begun_before(byte)); k-- > 0;) {
    const ByteRange& stroke = program_.strokes[k];
    if (stroke.begin == stroke.end) continue;
    if (stroke.end <= byte) return lift_after(program_, k);
    if (stroke.begin < byte && byte <= lines_[k]) return {};  // it has moved there with the tool up
  }
  return {};
}

std::int64_t StrokeJournal::begun_before(std::uint64_t byte) const {
  const auto& strokes = program_.strokes;
  return std::partition_point(strokes.begin(), strokes.end(),
                              [&](const ByteRange& stroke) { return stroke.begin < byte; }) -
         strokes.begin();
}

}  // namespace popcut
