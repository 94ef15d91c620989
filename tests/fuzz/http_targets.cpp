// SPDX-License-Identifier: MIT
// What clients send to popcutd.
#include <algorithm>
#include <string>
#include <vector>

#include "core/text/utf8.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/routes.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/http/front_door.hpp"
#include "daemon/http/wire.hpp"
#include "tests/fuzz/targets.hpp"

namespace popcut::fuzzing {
namespace {

using namespace popcut::daemon;

int depth_of(const nlohmann::json& value) {
  int deepest = 0;
  if (!value.is_structured()) return 0;
  for (const nlohmann::json& inner : value) deepest = std::max(deepest, depth_of(inner));
  return deepest + 1;
}

/// A body is refused with a reason, or is a value that may be copied and written, and whose members
/// can be read whatever they are.
void http_json(std::string_view text) {
  const auto body = http::parse_body(text, 32);
  if (!accepted(body)) return;
  demand(depth_of(*body) <= 32);
  const nlohmann::json copy = *body;
  demand(http::parse_body(copy.dump(), 32).value() == copy);
  FieldReader fields(*body, "", http::body_notation());
  for (const char* name : {"design", "name", "note"})
    static_cast<void>(
        fields.optional_text(name, popcut::TextRule{0, 120, popcut::TextRule::Controls::Lines}));
  static_cast<void>(fields.optional_integer("copies", 1, 1000));
  static_cast<void>(fields.optional_boolean("good"));
  static_cast<void>(fields.optional_word("registration", {"kept", "re-registered"}));
  static_cast<void>(
      fields.optional_texts("tags", 20, popcut::TextRule{1, 40, popcut::TextRule::Controls::None}));
  static_cast<void>(http::read_options(fields, "options"));
  fields.need("design", "is needed");
  static_cast<void>(fields.finish());
  for (const FieldFault& fault : fields.faults())
    demand(!fault.code.empty() && !fault.detail.empty());
}

/// No part of a path that is accepted has a slash, a control character or only dots in it; the id
/// of a device may have slashes.
void http_target(std::string_view text) {
  const auto target = http::read_target(text);
  if (!accepted(target)) return;
  const auto& parts = target->segments;
  const bool is_device = parts.size() > 2 && parts[0] == "v1" && parts[1] == "devices";
  for (const std::string& segment : parts) {
    demand(segment.find_first_of(std::string_view("\\\0\r\n", 4)) == std::string::npos);
    const bool may_have = is_device && &segment == &parts[2];
    demand(may_have || segment.find('/') == std::string::npos);
    demand(segment != "." && segment != ".." && is_utf8(segment));
  }
  for (const auto& [name, value] : target->query)
    demand(!name.empty() && value.find('\0') == std::string::npos);
  const http::Match match = http::find_route(http::Method::Get, target->segments);
  demand(match.route == nullptr || !match.allowed.empty());
}

/// A cursor has one spelling; moments of the query are read or not.
void http_cursor(std::string_view text) {
  if (const auto place = http::decode_cursor(text)) demand(http::encode_cursor(*place) == text);
  static_cast<void>(http::time_from(text));
  static_cast<void>(http::path_number(std::string(text)));
}

/// What a connection sends, cut in pieces of `step` bytes: all that was read of it, and whether it
/// was refused.
std::string read_requests(std::string_view bytes, std::size_t step) {
  http::RequestReader reader(1024);
  std::string seen, part;
  const http::RequestReader::Sink sink = [&](std::string_view piece) {
    part += piece;
    return std::optional<Problem>{};
  };
  const auto go_on = [&]() -> bool {
    while (true) {
      const auto head = reader.read_head();
      if (!head) return false;
      if (!*head) return true;
      const http::RequestHead& now = reader.head();
      demand(now.header("host") && now.target.front() == '/');
      demand(!now.is_chunked || !now.content_length);
      const auto body = reader.read_body(4096, sink);
      if (!body) return false;
      if (!*body) return true;
      seen += part + '|' + now.target + '|';  // what is not whole depends on how it was cut
      part.clear();
      std::string media;
      static_cast<void>(http::check_media(now, media));
      static_cast<void>(http::bearer_of(now));
      reader.next();
    }
  };
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    reader.append(bytes.substr(at, step));
    if (!go_on()) return seen + "refused";
  }
  return seen;
}

/// However the bytes are cut, the same requests are read or refused.
void http_raw(std::string_view bytes) {
  bytes = bytes.substr(0, 4096);
  demand(read_requests(bytes, bytes.size() + 1) == read_requests(bytes, 3));
}

/// Host, a line end, Origin: only the names of this daemon pass, in upper or lower case.
void http_names(std::string_view bytes) {
  const std::size_t line = std::min(bytes.find('\n'), bytes.size());
  http::RequestHead head;
  head.method = http::Method::Post;
  head.target = "/v1/jobs";
  head.headers = {{"host", std::string(bytes.substr(0, line))},
                  {"origin", std::string(bytes.substr(std::min(line + 1, bytes.size())))}};
  http::Peer peer;
  peer.address = "127.0.0.1";
  peer.port = 8631;
  const http::Names names{{"cutter.lab:8631"}, {"https://cutter.lab"}};
  const std::string host(*head.header("host")), origin(*head.header("origin"));
  if (!http::check_host(head, peer, names))
    for (const char c : host)
      demand(static_cast<unsigned char>(c) > 0x20 && c != '/' && c != '@' && c != ',');
  if (!http::check_origin(head, peer, names))
    demand(origin.empty() || origin.find("localhost") != origin.npos ||
           origin.find("127.0.0.1") != origin.npos || origin.find("[::1]") != origin.npos ||
           origin == "https://cutter.lab");
}

constexpr Target kTargets[] = {{"http_json", http_json},
                               {"http_target", http_target},
                               {"http_cursor", http_cursor},
                               {"http_raw", http_raw},
                               {"http_names", http_names}};

}  // namespace

std::span<const Target> http_targets() { return kTargets; }

}  // namespace popcut::fuzzing
