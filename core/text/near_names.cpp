// SPDX-License-Identifier: MIT
#include "core/text/near_names.hpp"

#include <fmt/format.h>

#include "core/text/json_fields.hpp"

namespace popcut {

std::string suggestion(std::string_view wrong, const std::vector<std::string>& names) {
  const std::string near = nearest_word(wrong, names);
  if (!near.empty()) return fmt::format("did you mean {}?", near);
  return fmt::format("one of {}", fmt::join(names, ", "));
}

}  // namespace popcut
