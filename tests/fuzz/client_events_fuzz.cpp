// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/client/sse_reader.hpp"

using namespace popcut;

namespace {

constexpr std::size_t kMost = 256;

std::string read_all(std::string_view bytes, std::size_t step) {
  client::SseReader reader(kMost);
  std::string seen;
  for (std::size_t at = 0; at < bytes.size() && !reader.broken(); at += step)
    for (const client::SseEvent& event : reader.feed(bytes.substr(at, step))) {
      if (event.data.size() > kMost || event.kind.size() > kMost) std::abort();
      seen += event.kind + '|' + event.data + '|' + event.id + '\n';
    }
  return seen + (reader.broken() ? "broken" : reader.last_id());
}

}  // namespace

// A stream of events: however it is cut, the same events are read, and none is larger than allowed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (read_all(bytes, size + 1) != read_all(bytes, 1)) std::abort();
  return 0;
}
