// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "daemon/http/api/message.hpp"

namespace popcut::daemon::http {

/// Parses a body. The depth is watched while it is read, so that no deep value ever exists;
/// members that stand twice, NaN, infinities and numbers too large for a double are refused.
///
/// @retval MalformedJson  with the byte at which it went wrong
[[nodiscard]] Answer<nlohmann::json> parse_body(std::string_view text, int max_depth);

/// How a body names its fields: for the `FieldReader` of a body.
[[nodiscard]] const Notation& body_notation();

/// The object of plan options at `name`: texts, numbers and booleans, all as text.
[[nodiscard]] std::map<std::string, std::string> read_options(FieldReader& fields,
                                                              const std::string& name);

/// What `fields` found wrong so far, for an answer.
[[nodiscard]] std::vector<RequestFault> request_faults(const FieldReader& fields);

/// Problem of `faults`.
[[nodiscard]] Problem validation(std::vector<RequestFault> faults);

/// Parses and reads a body in one go: `read` takes the fields that it wants, all others are faults.
/// No body at all is one without fields.
template <typename Value, typename Read>
Answer<Value> read_body_as(const Request& request, int max_depth, Read read) {
  const Answer<nlohmann::json> json =
      parse_body(request.body.empty() ? "{}" : request.body, max_depth);
  if (!json) return tl::unexpected<Problem>(json.error());
  FieldReader fields(*json, "", body_notation());
  if (!json->is_object()) return tl::unexpected<Problem>(validation(request_faults(fields)));
  Value value = read(fields);
  if (!fields.finish()) return tl::unexpected<Problem>(validation(request_faults(fields)));
  return value;
}

}  // namespace popcut::daemon::http
