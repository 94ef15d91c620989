// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <map>
#include <optional>
#include <vector>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// Roles of the users of this computer on the unix socket. Root and the user that the
/// daemon runs as are always admin; a user who is not listed has no role.
struct LocalUsers {
  std::map<uid_t, Role> users{};
  std::map<gid_t, Role> groups{};  ///< of several, the greatest role counts
};

/// The role that `users` give to `user`, whose daemon runs as `own_uid`; nothing: none.
[[nodiscard]] std::optional<Role> role_of(const LocalUser& user, const LocalUsers& users,
                                          uid_t own_uid);

}  // namespace popcut::daemon
