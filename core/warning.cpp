// SPDX-License-Identifier: MIT
#include "core/warning.hpp"

#include <algorithm>
#include <iterator>

namespace popcut {

std::vector<Warning> spoiling(const std::vector<Warning>& warnings) {
  std::vector<Warning> those;
  std::copy_if(warnings.begin(), warnings.end(), std::back_inserter(those),
               [](const Warning& one) { return one.spoils; });
  return those;
}

std::vector<std::string> messages_of(const std::vector<Warning>& warnings) {
  std::vector<std::string> texts;
  texts.reserve(warnings.size());
  for (const Warning& one : warnings) texts.push_back(one.message);
  return texts;
}

}  // namespace popcut
