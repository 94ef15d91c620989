// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/http/api/message.hpp"

namespace popcut::daemon::http {

/// Parses a body. The depth is watched while it is read, so that no deep value ever exists;
/// members that stand twice, NaN, infinities and numbers too large for a double are refused.
///
/// @retval MalformedJson  with the byte at which it went wrong
[[nodiscard]] Answer<nlohmann::json> parse_body(std::string_view text, int max_depth);

/// Reads the members of a body and keeps all faults with their JSON pointers. `finish` adds members
/// that were not read, with the nearest known name.
class Members {
 public:
  /// `value` lives longer than this.
  Members(const nlohmann::json& value, std::vector<RequestFault>& faults, std::string pointer = "");

  [[nodiscard]] bool has(const std::string& name) const;
  /// UTF-8 without control characters, of 1 to `most` code points; lines only if `lines`.
  std::optional<std::string> text(const std::string& name, std::size_t most, bool lines = false);
  /// As `text`, and it may be empty.
  std::optional<std::string> text_or_empty(const std::string& name, std::size_t most,
                                           bool lines = false);
  std::optional<std::int64_t> integer(const std::string& name, std::int64_t low, std::int64_t high);
  std::optional<bool> boolean(const std::string& name);
  /// One of `words`.
  std::optional<std::string> word(const std::string& name, const std::vector<std::string>& words);
  std::vector<std::string> texts(const std::string& name, std::size_t most_items,
                                 std::size_t most_each);
  /// An object of words and values: texts, numbers and booleans, all as text.
  std::map<std::string, std::string> options(const std::string& name);
  /// A fault if there is no such member.
  void require(const std::string& name, const std::string& what);
  void fault(const std::string& name, std::string code, std::string detail);
  void finish();
  /// The names that were asked for: all that the body may have.
  [[nodiscard]] const std::vector<std::string>& known() const { return known_; }

 private:
  const nlohmann::json* find(const std::string& name);
  /// A fault of a member that is there, with what stands there if that is short. Never of a text
  /// that may be a secret.
  void fault_of(const std::string& name, std::string code, std::string detail);
  std::optional<std::string> checked_text(const std::string& name, std::size_t least,
                                          std::size_t most, bool lines);
  const nlohmann::json& value_;
  std::vector<RequestFault>& faults_;
  std::string pointer_;
  std::vector<std::string> known_;
};

/// Problem of `faults`.
[[nodiscard]] Problem validation(std::vector<RequestFault> faults);

/// Parses and reads a body of members in one go: `read` takes what it wants. No body at all is one
/// without members.
template <typename Value, typename Read>
Answer<Value> read_body_as(const Request& request, int max_depth, Read read) {
  const Answer<nlohmann::json> json =
      parse_body(request.body.empty() ? "{}" : request.body, max_depth);
  if (!json) return tl::unexpected<Problem>(json.error());
  std::vector<RequestFault> faults;
  Members members(*json, faults);
  if (!faults.empty()) return tl::unexpected<Problem>(validation(std::move(faults)));
  Value value = read(members);
  members.finish();
  if (!faults.empty()) return tl::unexpected<Problem>(validation(std::move(faults)));
  return value;
}

}  // namespace popcut::daemon::http
