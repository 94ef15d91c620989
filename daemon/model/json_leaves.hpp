// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace popcut::daemon {

/// A text, number or truth value in a small JSON document.
struct JsonLeaf {
  std::size_t item{};         ///< the element of the outermost list that it is in, from 0
  int depth{};                ///< how many lists and objects it is in
  std::string_view parent{};  ///< the name of the object that it is in; empty: it has none
  std::string_view name{};    ///< empty: an element of a list
  std::optional<std::string_view> text{};
  std::optional<double> number{};
  bool is_true{false};
};

/// Calls `take` for each leaf, in order. It makes no tree: where memory is out, the destructor of
/// nlohmann's tree ends the program, and this throws std::bad_alloc.
/// @return whether all of `json` is JSON; if not, some leaves may have been taken
[[nodiscard]] bool each_json_leaf(std::string_view json,
                                  const std::function<void(const JsonLeaf&)>& take);

}  // namespace popcut::daemon
