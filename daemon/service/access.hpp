// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// Who may use the service: tokens, and the sessions of pages. See `Service`.
class Access {
 public:
  virtual ~Access() = default;
  /// The owner of a token; nothing if it is unknown or has expired.
  [[nodiscard]] virtual std::optional<Principal> authenticate(std::string_view bearer) = 0;
  [[nodiscard]] virtual Answer<NewToken> create_token(const Principal&, const std::string& name,
                                                      Role role, std::optional<int> lifetime_s) = 0;
  [[nodiscard]] virtual std::vector<TokenRecord> tokens() = 0;
  [[nodiscard]] virtual Answer<void> delete_token(const Principal&, const std::string& id) = 0;
  /// A word that becomes a session's token once, within 60 s: what `popcut open` gives the page.
  [[nodiscard]] virtual Answer<std::string> create_one_shot(const Principal&) = 0;
  [[nodiscard]] virtual Answer<NewToken> open_session(const std::string& one_shot) = 0;
};

}  // namespace popcut::daemon
