// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The login name of a user in the system's list of users; empty if it has none.
[[nodiscard]] std::string login_name(uid_t user);

/// What people call a principal. Each is looked up once: a token's name does not change, and a list
/// of jobs names the same few again and again.
class PrincipalTitles {
 public:
  PrincipalTitles(ServiceStore& store, const ServiceOptions& options)
      : store_(store), options_(options) {}
  /// "Ben's tablet" for "token:01J...", "ana" for "uid:1000"; the name of the principal itself for
  /// a token that was deleted, and a user without a login name. Throws StoreFault.
  [[nodiscard]] std::string of(const std::string& principal);

 private:
  [[nodiscard]] std::string looked_up(const std::string& principal);
  ServiceStore& store_;
  const ServiceOptions& options_;
  std::map<std::string, std::string> known_{};
};

}  // namespace popcut::daemon
