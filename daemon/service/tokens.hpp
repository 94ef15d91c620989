// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/service/memory.hpp"

namespace popcut::daemon {

/// Who may ask: tokens, and the sessions of pages. Of a secret only its digest is stored.
class Tokens {
 public:
  Tokens(Memory& memory, const ServiceOptions& options) : memory_(memory), options_(options) {}

  [[nodiscard]] std::optional<Principal> authenticate(std::string_view bearer);
  [[nodiscard]] Answer<NewToken> create(const Principal& who, const std::string& name, Role role,
                                        std::optional<int> lifetime_s);
  [[nodiscard]] std::vector<TokenRecord> list();
  [[nodiscard]] Answer<void> remove(const Principal& who, const std::string& id);
  [[nodiscard]] Answer<std::string> create_one_shot(const Principal& who);
  [[nodiscard]] Answer<NewToken> open_session(const std::string& one_shot);
  /// Forgets what has expired.
  void tidy();

 private:
  struct OneShot {
    Principal principal;
    std::int64_t until_ms{};  ///< monotonic
  };
  NewToken store(const char* kind, const std::string& name, Role role, const std::string& principal,
                 std::optional<TimeMs> expires);
  Memory& memory_;
  const ServiceOptions& options_;
  std::map<std::string, OneShot> one_shots_;  ///< by the digest of the word
};

}  // namespace popcut::daemon
