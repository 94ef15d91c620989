// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string_view>

namespace popcut::planning {

/// A way of making a card without a cutter that popcut drives.
struct MakeWay {
  std::string_view name;     ///< "hand", "cricut", "silhouette", "laser"
  std::string_view machine;  ///< unless another one is named; empty: an ideal plotter
  std::string_view mat;      ///< the same; empty: the machine's first
  std::string_view formats;  ///< of 'popcut plan --formats'
  std::string_view folds{};  ///< "perforate" where all folds are dashes; empty: the machine's
};

[[nodiscard]] std::span<const MakeWay> make_ways();
/// Null if there is none of this name.
[[nodiscard]] const MakeWay* find_make_way(std::string_view name);

}  // namespace popcut::planning
