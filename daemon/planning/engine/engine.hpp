// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string_view>

#include "core/result.hpp"
#include "daemon/planning/frames.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {

/// Puts a task together from its frames, which come in pieces.
class TaskReader {
 public:
  /// @retval Malformed, OutOfRange  these are no frames of a task, or too many bytes
  [[nodiscard]] Result<void> feed(std::string_view bytes);
  /// Whether nothing has come yet.
  [[nodiscard]] bool at_rest() const { return !task_ && frames_.at_rest(); }
  /// Whether the frame has come that says that nothing more comes.
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  /// The task, once it is whole.
  [[nodiscard]] Result<WorkerTask> take() { return std::move(task_); }

 private:
  [[nodiscard]] Result<void> take_in(Frame frame);

  FrameReader frames_{std::uint64_t{2} << 30};
  Result<WorkerTask> task_{fail(ErrorKind::Malformed, "pipe", "no task was sent")};
  bool is_whole_{false};
};

/// Takes a frame of what comes of a task. An error ends the task.
using FrameSink = std::function<Result<void>(FrameKind, std::string_view name, std::string_view)>;

/// Does the task that `read` gives, and sends what comes of it: its files, now and then what it is
/// at, and last its figures or one error. Needs no files, processes or threads: what `popcutd
/// --worker` and engine.wasm share. The same task gives the same frames, but for those of kind
/// Phase.
///
/// @param spent  called if memory has run out: may end the program, or says what else helps (", or
///               ..."), after "make it smaller or simpler"
/// @retval Unwritable  what `send` says of the last frame
[[nodiscard]] Result<void> answer(const std::function<Result<WorkerTask>()>& read,
                                  const FrameSink& send,
                                  const std::function<std::string_view()>& spent);

}  // namespace popcut::planning
