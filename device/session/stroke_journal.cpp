// SPDX-License-Identifier: MIT
#include "device/session/stroke_journal.hpp"

#include <algorithm>

namespace popcut {
namespace {

/// The last of the strokes, from the first on, for which `holds` is true; -1 if there is none.
template <typename Holds>
std::int64_t last_of(const EncodedProgram& program, Holds holds) {
  const auto& strokes = program.strokes;
  return std::partition_point(strokes.begin(), strokes.end(), holds) - strokes.begin() - 1;
}

}  // namespace

bool StrokeJournal::intend(std::uint64_t until) {
  if (failure_) return false;
  const std::int64_t last =
      last_of(program_, [&](const ByteRange& stroke) { return stroke.begin < until; });
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
      last_of(program_, [&](const ByteRange& stroke) { return stroke.begin < accepted; });
  const std::int64_t certain =
      std::min(taken, last_of(program_, [&](const ByteRange& s) { return s.end <= sure; }));
  if (certain <= certain_ && taken <= taken_) return;
  certain_ = std::max(certain, certain_);
  taken_ = std::max(taken, taken_);
  const Result<void> written =
      options_.settle(certain_, taken_, std::min(accepted, program_.geometry.end));
  if (!written) failure_ = written.error();
}

std::uint64_t stroke_end_after(const EncodedProgram& program, std::uint64_t byte) {
  if (byte == program.geometry.begin) return byte;
  const std::int64_t before =
      last_of(program, [&](const ByteRange& stroke) { return stroke.end < byte; });
  const auto at = static_cast<std::size_t>(before + 1);
  return at == program.strokes.size() ? program.geometry.end
                                      : std::max(program.strokes[at].end, byte);
}

std::string lift_at(const EncodedProgram& program, std::uint64_t byte) {
  for (std::size_t k = program.strokes.size(); k-- > 0;) {
    const ByteRange& stroke = program.strokes[k];
    if (stroke.end <= byte && stroke.begin != stroke.end) return lift_after(program, k);
  }
  return {};
}

}  // namespace popcut
