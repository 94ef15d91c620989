// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string_view>

namespace popcut {

/// Told by what may take long how far it is. May be empty.
///
/// `what` is what is being done, in words for a person ("cutting the shape into slices"). `done` is
/// the part of this that is done, 0 to 1; below 0 where that is not known. Called on the thread
/// that computes, at steps of at least some microseconds: never from an inner loop.
using Progress = std::function<void(std::string_view what, double done)>;

inline constexpr double kUnknownPart = -1.0;

/// `progress(what, done)`, unless it is empty.
inline void tell(const Progress& progress, std::string_view what, double done = kUnknownPart) {
  if (progress) progress(what, done);
}

}  // namespace popcut
