// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// What is known of the strokes of one blank, over all attempts.
enum class PathFate : std::uint8_t { NotSent, InDoubt, Certain };

/// A run of strokes with one fate.
struct FateRun {
  PathRange paths;
  PathFate fate{};
};

/// The strokes `0 .. strokes - 1` of a blank as runs, from the records of its attempts in their
/// order: a later attempt that touched a stroke knows better than an earlier one, except that what
/// was certainly cut stays so.
[[nodiscard]] std::vector<FateRun> merged_fates(std::int64_t strokes,
                                                const std::vector<std::vector<FateRun>>& attempts);

/// The ledger's lists from the runs.
void fill_ledger(Ledger& ledger, const std::vector<FateRun>& runs);

/// The request `resume-from`, and what the store knows.
struct ResumeRequest {
  std::int64_t from_path{};
  bool re_registered{false};
  bool accept_double_cut{false};
  bool skip_in_doubt{false};
};
struct ResumeFacts {
  std::int64_t strokes{};
  bool same_device_session{false};  ///< the cutter was never away since the sheet was cut
};

/// Whether a sheet may go on from `from_path` on the same blank; else why not, in words: all that
/// stands against it, so that who answers it all is not refused again.
///
/// The strokes from there on may hold none that was cut or may have been, unless the person says
/// that these may be cut twice. Those before it must all be cut, unless they are in doubt and the
/// person leaves them so.
[[nodiscard]] tl::expected<void, std::string> may_resume(const std::vector<FateRun>& runs,
                                                         const ResumeRequest& request,
                                                         const ResumeFacts& facts);

/// Complete requests that `may_resume` lets pass, at most three, with no more allowed than each
/// needs: as near to `wanted` as can be, then those that cut nothing twice before those that may.
[[nodiscard]] std::vector<ResumeRequest> possible_resumes(const std::vector<FateRun>& runs,
                                                          const ResumeRequest& wanted,
                                                          const ResumeFacts& facts);

}  // namespace popcut::daemon
