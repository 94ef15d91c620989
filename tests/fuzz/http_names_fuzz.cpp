// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/http/front_door.hpp"

using namespace popcut::daemon;

// Host, a line end, Origin: nothing passes but the names of this daemon, in whatever case.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
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
  const auto ends_as_ours = [](std::string_view name) {
    for (const char c : name)
      if (static_cast<unsigned char>(c) <= 0x20 || c == '/' || c == '@' || c == ',') return false;
    return true;
  };
  const std::string host(*head.header("host")), origin(*head.header("origin"));
  if (!http::check_host(head, peer, names) && !ends_as_ours(host)) std::abort();
  if (!http::check_origin(head, peer, names) && !origin.empty() &&
      origin.find("localhost") == origin.npos && origin.find("127.0.0.1") == origin.npos &&
      origin.find("[::1]") == origin.npos && origin != "https://cutter.lab")
    std::abort();
  return 0;
}
