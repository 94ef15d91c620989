// SPDX-License-Identifier: MIT
#include "daemon/http/api/target.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace popcut::daemon::http {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// The code point at `i` and its length; length 0: not UTF-8.
struct CodePoint {
  std::uint32_t value{};
  std::size_t length{};
};

CodePoint code_point(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return k < text.size() ? std::uint32_t{static_cast<unsigned char>(text[k])} : 0u;
  };
  const std::uint32_t first = byte(i);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return {};
  std::uint32_t value = first & (0xFFu >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0u) != 0x80u) return {};
    value = value << 6 | (byte(i + k) & 0x3Fu);
  }
  const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
  if (overlong || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return {};
  return {value, length};
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

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = code_point(text, i).length;
    if (length == 0) return false;
    i += length;
  }
  return true;
}

bool has_controls(std::string_view text, bool lines) {
  for (std::size_t i = 0; i < text.size();) {
    const CodePoint point = code_point(text, i);
    if (point.length == 0) return true;
    const std::uint32_t c = point.value;
    const bool is_line = lines && (c == '\n' || c == '\t');
    if ((c < 0x20 && !is_line) || (c >= 0x7F && c < 0xA0)) return true;
    // Marks that turn the direction of text, and the line separators.
    if (c == 0x2028 || c == 0x2029 || (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069))
      return true;
    i += point.length;
  }
  return false;
}

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

}  // namespace popcut::daemon::http
