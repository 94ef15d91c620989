// SPDX-License-Identifier: MIT
#include "daemon/cli/view/person_name.hpp"

#include <pwd.h>
#include <sys/types.h>

#include <charconv>
#include <string_view>
#include <vector>

namespace popcut::cli {

std::string person_name(const std::string& principal) {
  constexpr std::string_view kUser = "uid:";
  if (principal.rfind(kUser, 0) != 0) return principal;
  uid_t number = 0;
  const char* const end = principal.data() + principal.size();
  const auto read = std::from_chars(principal.data() + kUser.size(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return principal;
  passwd entry{}, *found = nullptr;
  std::vector<char> room(16 * 1024);
  if (::getpwuid_r(number, &entry, room.data(), room.size(), &found) != 0 || found == nullptr)
    return principal;
  return std::string(found->pw_name) + " (" + principal + ")";
}

}  // namespace popcut::cli
