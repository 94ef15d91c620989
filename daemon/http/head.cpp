// SPDX-License-Identifier: MIT
#include "daemon/http/head.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "core/text/words.hpp"

namespace popcut::daemon::http {
namespace {

constexpr std::size_t kMostFields = 64;
constexpr std::size_t kLongestTarget = 2048;

using Fault = std::optional<Problem>;

Fault bad(std::string detail) { return Problem{ProblemKind::BadRequest, std::move(detail)}; }

bool is_token_char(char c) {
  if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) return true;
  return std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

// RFC 3986: pchar, "/" and "?"; a percent sign is looked at when the target is decoded.
bool is_target_char(char c) {
  if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) return true;
  return std::string_view("-._~!$&'()*+,;=:@/?%").find(c) != std::string_view::npos;
}

bool is_value_char(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte == '\t' || (byte >= 0x20 && byte != 0x7F);
}

Fault check_request_line(std::string_view line, bool& is_http_1_0) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    return bad("the request line must be 'METHOD /path HTTP/1.1'");
  const std::string_view method = line.substr(0, first), version = line.substr(last + 1);
  const std::string_view target = line.substr(first + 1, last - first - 1);
  if (method.empty() || method.size() > 16 ||
      !std::all_of(method.begin(), method.end(), [](char c) { return c >= 'A' && c <= 'Z'; }))
    return bad("the method must be a word of capital letters");
  if (version != "HTTP/1.1" && version != "HTTP/1.0")
    return bad("the version must be HTTP/1.1 or HTTP/1.0");
  is_http_1_0 = version == "HTTP/1.0";
  if (target.size() > kLongestTarget)
    return bad(fmt::format("the path is longer than {} characters", kLongestTarget));
  if (target.empty() || target.front() != '/')
    return bad("the target must be a path that starts with a slash, not a full URI");
  if (!std::all_of(target.begin(), target.end(), is_target_char))
    return bad("the path contains characters that must be percent-encoded");
  return std::nullopt;
}

struct Fields {
  std::vector<std::string> seen{};
  std::optional<std::string_view> host{}, length{}, coding{};
};

// Headers of which a second one would change what the request means.
constexpr std::array<std::string_view, 13> kOnce{
    "host",          "content-length", "transfer-encoding", "authorization",
    "content-type",  "if-match",       "if-none-match",     "idempotency-key",
    "origin",        "expect",         "content-encoding",  "last-event-id",
    "sec-fetch-site"};

Fault check_field(std::string_view line, Fields& fields) {
  if (line.front() == ' ' || line.front() == '\t')
    return bad("a header continues on a second line; write it on one line");
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return bad("a header line has no colon");
  const std::string_view name = line.substr(0, colon);
  if (!is_token(name)) return bad("a header name contains characters that are not allowed");
  const std::string_view value = trimmed(line.substr(colon + 1), " \t");
  if (!std::all_of(value.begin(), value.end(), is_value_char))
    return bad("a header value contains control characters");
  std::string lower = to_lower(name);
  if (std::find(kOnce.begin(), kOnce.end(), lower) != kOnce.end() &&
      std::find(fields.seen.begin(), fields.seen.end(), lower) != fields.seen.end())
    return bad(fmt::format("the header {} occurs twice", lower));
  if (fields.seen.size() == kMostFields)
    return bad(fmt::format("there are more than {} headers", kMostFields));
  if (lower == "host") fields.host = value;
  if (lower == "content-length") fields.length = value;
  if (lower == "transfer-encoding") fields.coding = value;
  fields.seen.push_back(std::move(lower));
  return std::nullopt;
}

Fault check_framing(const Fields& fields, bool is_http_1_0) {
  if (!fields.host) return bad("there is no Host header");
  if (fields.coding && is_http_1_0) return bad("Transfer-Encoding is not allowed in HTTP/1.0");
  if (fields.coding && to_lower(*fields.coding) != "chunked")
    return bad("the only Transfer-Encoding supported is 'chunked'");
  if (fields.coding && fields.length)
    return bad("Transfer-Encoding and Content-Length cannot be combined");
  if (!fields.length) return std::nullopt;
  const std::string_view length = *fields.length;
  const bool is_number =
      !length.empty() && length.size() <= 18 &&
      std::all_of(length.begin(), length.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return bad("Content-Length is not a number of bytes");
  return std::nullopt;
}

}  // namespace

std::string to_lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char);
}

std::optional<Problem> check_head(std::string_view raw) {
  if (raw.size() < 4 || raw.substr(raw.size() - 4) != "\r\n\r\n")
    return bad("the head of the request does not end with an empty line");
  raw.remove_suffix(2);
  bool is_http_1_0 = false, is_first = true;
  Fields fields;
  while (!raw.empty()) {
    const std::size_t end = raw.find("\r\n");
    const std::string_view line = raw.substr(0, end);  // there is one: raw ends with it
    raw.remove_prefix(end + 2);
    if (line.find_first_of(std::string_view("\r\n\0", 3)) != std::string_view::npos)
      return bad("the head contains a bare line ending or a zero byte");
    if (line.empty()) return bad("the head contains an empty line before its end");
    const Fault fault =
        is_first ? check_request_line(line, is_http_1_0) : check_field(line, fields);
    if (fault) return fault;
    is_first = false;
  }
  return check_framing(fields, is_http_1_0);
}

}  // namespace popcut::daemon::http
