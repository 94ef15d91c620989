// SPDX-License-Identifier: MIT
#include "daemon/http/api/target.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "daemon/digest/digest.hpp"

namespace popcut::daemon::http {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

Answer<std::vector<std::string>> read_path(std::string_view path) {
  std::vector<std::string> segments;
  path.remove_prefix(1);
  while (true) {
    const std::size_t slash = path.find('/');
    Answer<std::string> segment = percent_decoded(path.substr(0, slash));
    if (!segment) return tl::unexpected<Problem>(segment.error());
    // "serial:/dev/ttyUSB0" is the id of a device; no file is ever named by that part.
    const bool is_device = segments.size() == 2 && segments[0] == "v1" && segments[1] == "devices";
    if (segment->find_first_of(is_device ? "\\" : "/\\") != std::string::npos)
      return refuse(ProblemKind::BadRequest, "a path segment contains an encoded slash");
    if (*segment == "." || *segment == "..")
      return refuse(ProblemKind::BadRequest, "the path contains '.' or '..'; write the full path");
    segments.push_back(std::move(*segment));
    if (slash == std::string_view::npos) return segments;
    path.remove_prefix(slash + 1);
  }
}

Answer<std::vector<std::pair<std::string, std::string>>> read_query(std::string_view query) {
  std::vector<std::pair<std::string, std::string>> out;
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view part = query.substr(0, end);
    const std::size_t equals = part.find('=');
    Answer<std::string> name = percent_decoded(part.substr(0, equals));
    if (!name) return tl::unexpected<Problem>(name.error());
    Answer<std::string> value = percent_decoded(
        equals == std::string_view::npos ? std::string_view() : part.substr(equals + 1));
    if (!value) return tl::unexpected<Problem>(value.error());
    if (name->empty())
      return refuse(ProblemKind::BadRequest, "the query contains a value without a name");
    if (std::any_of(out.begin(), out.end(), [&](const auto& had) { return had.first == *name; }))
      return refuse(ProblemKind::BadRequest, fmt::format("the query contains '{}' twice", *name));
    out.emplace_back(std::move(*name), std::move(*value));
    if (end == std::string_view::npos) break;
    query.remove_prefix(end + 1);
    if (query.empty()) return refuse(ProblemKind::BadRequest, "the query ends with '&'");
  }
  return out;
}

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr char kVersion = '1';
constexpr std::size_t kLongest = 300;

}  // namespace

Answer<std::string> percent_decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_value(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_value(text[i + 2]) : -1;
    if (high < 0 || low < 0)
      return refuse(ProblemKind::BadRequest, "a '%' in the path is not followed by two hex digits");
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  if (!is_utf8(out) || has_controls(out, true))
    return refuse(ProblemKind::BadRequest,
                  "the path or query is not UTF-8, or contains control characters");
  return out;
}

Answer<Target> read_target(std::string_view target) {
  if (target.empty() || target.front() != '/')
    return refuse(ProblemKind::BadRequest, "the path does not start with a slash");
  const std::size_t mark = target.find('?');
  Answer<std::vector<std::string>> segments = read_path(target.substr(0, mark));
  if (!segments) return tl::unexpected<Problem>(segments.error());
  for (const std::string& segment : *segments)
    if (has_controls(segment))
      return refuse(ProblemKind::BadRequest, "the path contains control characters");
  Target out{std::move(*segments), {}};
  if (mark == std::string_view::npos) return out;
  auto query = read_query(target.substr(mark + 1));
  if (!query) return tl::unexpected<Problem>(query.error());
  out.query = std::move(*query);
  return out;
}

std::string encode_cursor(std::string_view place) {
  return base64url(kVersion + std::string(place));
}

std::optional<std::string> decode_cursor(std::string_view cursor) {
  if (cursor.empty() || cursor.size() > kLongest) return std::nullopt;
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : cursor) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>(bits >> count & 0xFFu);
    bits &= (1u << count) - 1;
  }
  const bool is_plain =
      std::all_of(out.begin(), out.end(), [](char c) { return c > ' ' && c < '\x7F'; });
  if (out.size() < 2 || out.front() != kVersion || !is_plain) return std::nullopt;
  out.erase(0, 1);
  if (encode_cursor(out) != cursor) return std::nullopt;  // one spelling only
  return out;
}

}  // namespace popcut::daemon::http
