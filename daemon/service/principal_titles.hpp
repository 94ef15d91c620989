// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The login name of a user of this system; empty if there is none.
[[nodiscard]] std::string login_name(uid_t user);

/// What people call a principal. Each title is looked up once and kept in memory, because names of
/// tokens do not change, and lists of jobs repeat the same few principals.
class PrincipalTitles {
 public:
  PrincipalTitles(ServiceStore& store, const ServiceOptions& options)
      : store_(store), options_(options) {}
  /// "Ben's tablet" for "token:01J...", "ana" for "uid:1000". The principal itself for a user
  /// without a login name, and for a token that was deleted before its title was looked up.
  ///
  /// @throws StoreFault
  [[nodiscard]] std::string of(const std::string& principal);

 private:
  [[nodiscard]] std::string look_up(const std::string& principal);
  ServiceStore& store_;
  const ServiceOptions& options_;
  std::map<std::string, std::string> known_{};
};

}  // namespace popcut::daemon
