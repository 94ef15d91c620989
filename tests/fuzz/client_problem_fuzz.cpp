// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/client/address.hpp"
#include "daemon/client/problem_line.hpp"

using namespace popcut;

// What a server answers that may not be popcutd: status, a line end, the body. And the address that
// a person typed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t line = std::min(bytes.find('\n'), bytes.size());
  client::HttpResponse response;
  response.status = std::atoi(std::string(bytes.substr(0, std::min<std::size_t>(line, 3))).c_str());
  response.body = bytes.substr(std::min(line + 1, bytes.size()));
  const nlohmann::json sent{{"design", "x"}, {"options", {{"order", "keep"}}}};
  for (const client::Subject subject : {client::Subject::CommandLine, client::Subject::File}) {
    const Error error = client::error_from(response, "sphere.json", subject, &sent);
    if (message(error).empty()) std::abort();
    for (const char c : message(error))
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) std::abort();
  }
  if (const auto address = client::parse_address(bytes.substr(0, line)); !address)
    if (address.error().detail.empty()) std::abort();
  return 0;
}
