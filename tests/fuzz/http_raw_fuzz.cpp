// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "daemon/http/front_door.hpp"
#include "daemon/http/wire.hpp"

using namespace popcut::daemon;

namespace {

// What a connection sends, cut in pieces of `step` bytes: all that was read of it, and whether it
// was refused.
std::string read_all(std::string_view bytes, std::size_t step) {
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
      if (!now.header("host") || now.target.front() != '/') std::abort();
      if (now.is_chunked && now.content_length) std::abort();
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

}  // namespace

// However the bytes are cut, the same requests are read or refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data),
                               std::min<std::size_t>(size, 4096));
  const std::string whole = read_all(bytes, bytes.size() + 1);
  const std::string pieces = read_all(bytes, 3);
  if (whole != pieces) std::abort();
  return 0;
}
