// SPDX-License-Identifier: MIT
#include "daemon/model/local_users.hpp"

namespace popcut::daemon {

std::optional<Role> role_of(const LocalUser& user, const LocalUsers& users, uid_t own_uid) {
  if (user.uid == 0 || user.uid == own_uid) return Role::Admin;
  std::optional<Role> role;
  if (const auto own = users.users.find(user.uid); own != users.users.end()) role = own->second;
  for (const gid_t group : user.groups)
    if (const auto found = users.groups.find(group);
        found != users.groups.end() && (!role || *role < found->second))
      role = found->second;
  return role;
}

}  // namespace popcut::daemon
