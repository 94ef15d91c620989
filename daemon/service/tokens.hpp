// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/service/service.hpp"
#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// Tokens, and the sessions of pages. Only the digest of a secret is stored.
class Tokens : public Access {
 public:
  Tokens(ServiceStore& store, const ServiceOptions& options) : store_(store), options_(options) {}

  std::optional<Principal> authenticate(std::string_view bearer) override;
  Answer<NewToken> create_token(const Principal& who, const std::string& name, Role role,
                                std::optional<int> lifetime_s) override;
  std::vector<TokenRecord> tokens() override;
  Answer<void> delete_token(const Principal& who, const std::string& id) override;
  Answer<std::string> create_one_shot(const Principal& who) override;
  Answer<NewToken> open_session(const std::string& one_shot) override;
  /// Forgets what has expired.
  void tidy();

 private:
  struct OneShot {
    Principal principal;
    std::int64_t until_ms{};  ///< monotonic
  };
  NewToken store(const char* kind, const std::string& name, Role role, const std::string& principal,
                 std::optional<TimeMs> expires);
  ServiceStore& store_;
  const ServiceOptions& options_;
  std::map<std::string, OneShot> one_shots_;  ///< by the digest of the word
};

}  // namespace popcut::daemon
