// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut::planning {

/// What goes through the pipes between popcutd and its worker: frames, each a head of 20 bytes
/// ("PCW1", kind and name's length as 4 bytes, content's length as 8, all little-endian), the name,
/// and the content.
enum class FrameKind : std::uint32_t {
  Task = 1,     ///< to the worker: what to do, JSON; first
  Design = 2,   ///< to the worker: the design's bytes
  Asset = 3,    ///< to the worker: an asset's bytes; the name is its id
  Go = 4,       ///< to the worker: nothing more comes
  File = 5,     ///< from the worker: a file of the outcome
  Outcome = 6,  ///< from the worker: the figures, JSON; last
  Failure = 7,  ///< from the worker: one error, JSON; last
  Phase = 8,    ///< from the worker: what it is at, JSON
};

struct Frame {
  FrameKind kind{};
  std::string name;
  std::string bytes;
};

/// How a worker ends whose processor time is up.
inline constexpr int kOutOfTimeCode = 64;
/// And one that wanted more memory than there is, where it could not say so.
inline constexpr int kOutOfMemoryCode = 65;

inline constexpr std::size_t kFrameHeadBytes = 20;
inline constexpr std::size_t kMostNameBytes = 100;

/// The bytes before a frame's content.
[[nodiscard]] std::string frame_head(FrameKind kind, std::string_view name, std::uint64_t bytes);

/// Puts frames together from bytes that come in pieces. Memory grows with what has arrived, never
/// with what a head promises.
class FrameReader {
 public:
  /// @param most_bytes  of all contents together
  explicit FrameReader(std::uint64_t most_bytes) : left_(most_bytes) {}

  /// Takes bytes in and calls `take` for each frame that is whole.
  ///
  /// @retval Malformed   no head, an unknown kind, a name that is no plain file's name
  /// @retval OutOfRange  more than `most_bytes`
  [[nodiscard]] Result<void> feed(std::string_view bytes,
                                  const std::function<Result<void>(Frame)>& take);
  /// Whether nothing of a further frame has arrived.
  [[nodiscard]] bool at_rest() const { return buffer_.empty() && !frame_; }

 private:
  [[nodiscard]] Result<void> begin();
  std::uint64_t left_;
  std::string buffer_;  ///< head and name, while they are not whole
  std::optional<Frame> frame_;
  std::uint64_t expected_{};
};

/// "sheet-01.gpgl": letters of ASCII, digits, '-', '_' and '.', none of the dots first.
[[nodiscard]] bool is_plain_name(std::string_view name);

}  // namespace popcut::planning
