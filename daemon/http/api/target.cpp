// SPDX-License-Identifier: MIT
#include "daemon/http/api/target.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/text/utf8.hpp"

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
      return refuse(ProblemKind::BadRequest, "a part of the path holds a slash");
    if (*segment == "." || *segment == "..")
      return refuse(ProblemKind::BadRequest, "the path has '.' or '..' in it; write it out");
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
    if (name->empty()) return refuse(ProblemKind::BadRequest, "the query has a value with no name");
    if (std::any_of(out.begin(), out.end(), [&](const auto& had) { return had.first == *name; }))
      return refuse(ProblemKind::BadRequest, fmt::format("the query names '{}' twice", *name));
    out.emplace_back(std::move(*name), std::move(*value));
    if (end == std::string_view::npos) break;
    query.remove_prefix(end + 1);
    if (query.empty()) return refuse(ProblemKind::BadRequest, "the query ends with '&'");
  }
  return out;
}

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
                  "the path or query is not UTF-8, or holds control characters");
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
      return refuse(ProblemKind::BadRequest, "the path holds control characters");
  Target out{std::move(*segments), {}};
  if (mark == std::string_view::npos) return out;
  auto query = read_query(target.substr(mark + 1));
  if (!query) return tl::unexpected<Problem>(query.error());
  out.query = std::move(*query);
  return out;
}

}  // namespace popcut::daemon::http
