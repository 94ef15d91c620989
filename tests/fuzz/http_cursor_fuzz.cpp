// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/target.hpp"

using namespace popcut::daemon;

// A cursor has one spelling; moments of the query are read or not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto place = http::decode_cursor(text); place && http::encode_cursor(*place) != text)
    std::abort();
  static_cast<void>(http::time_from(text));
  static_cast<void>(http::path_number(std::string(text)));
  return 0;
}
