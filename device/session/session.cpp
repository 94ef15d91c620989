// SPDX-License-Identifier: MIT
#include "device/session/session.hpp"

#include <algorithm>
#include <array>

#include "device/session/session_run.hpp"

namespace popcut {
namespace {

/// A session from `options.first_stroke` on: the rest of the program as one of its own, with
/// strokes numbered as in the whole.
SessionEnd run_rest(Transport& transport, const Machine& machine, const EncodedProgram& program,
                    const SessionOptions& options) {
  const std::size_t first = options.first_stroke;
  SessionEnd end;
  end.fates.assign(std::min(first, program.strokes.size()), StrokeFate::NotSent);
  const Result<EncodedProgram> rest = rest_of(program, first);
  if (!rest) {
    end.error = rest.error();
    return end;
  }
  const auto shift = static_cast<std::int64_t>(first);
  SessionOptions own = options;
  own.first_stroke = 0;
  if (options.progress)
    own.progress = [&](SessionProgress p) {
      p.strokes_done += first;
      p.strokes += first;
      options.progress(p);
    };
  if (options.intend) own.intend = [&](std::int64_t last) { return options.intend(last + shift); };
  if (options.settle)
    own.settle = [&](std::int64_t certain, std::int64_t taken, std::uint64_t bytes) {
      return options.settle(certain + shift, taken + shift, bytes);
    };
  SessionEnd rest_end = SessionRun(transport, machine, *rest, own).run();
  rest_end.fates.insert(rest_end.fates.begin(), end.fates.begin(), end.fates.end());
  return rest_end;
}

}  // namespace

std::string_view name_of(SessionPhase phase) {
  constexpr std::array<std::string_view, 8> kNames{"connecting",
                                                   "sending the settings",
                                                   "searching for the marks",
                                                   "cutting",
                                                   "paused on the panel",
                                                   "held",
                                                   "finishing",
                                                   "parking"};
  return kNames.at(static_cast<std::size_t>(phase));
}

StrokeFate fate_of(ByteRange stroke, std::uint64_t ready_bytes, std::uint64_t good_bytes,
                   std::uint64_t accepted, std::uint64_t buffer_bytes) {
  if (stroke.begin >= std::min(accepted, stroke.end)) return StrokeFate::NotSent;
  const bool pushed_through = stroke.end + buffer_bytes <= good_bytes;
  return stroke.end <= ready_bytes || pushed_through ? StrokeFate::Certain : StrokeFate::InDoubt;
}

SessionEnd run_session(Transport& transport, const Machine& machine, const EncodedProgram& program,
                       const SessionOptions& options) {
  if (options.first_stroke > 0) return run_rest(transport, machine, program, options);
  return SessionRun(transport, machine, program, options).run();
}

}  // namespace popcut
