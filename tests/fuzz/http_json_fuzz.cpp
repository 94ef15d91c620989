// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/http/api/json_body.hpp"

using namespace popcut::daemon;

namespace {

int depth_of(const nlohmann::json& value) {
  int deepest = 0;
  if (!value.is_structured()) return 0;
  for (const nlohmann::json& inner : value) deepest = std::max(deepest, depth_of(inner));
  return deepest + 1;
}

}  // namespace

// A body is refused with a reason, or is a value that may be copied and written, and whose members
// can be asked for whatever they are.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto body = http::parse_body(text, 32);
  if (!body) {
    if (body.error().detail.empty()) std::abort();
    return 0;
  }
  if (depth_of(*body) > 32) std::abort();
  const nlohmann::json copy = *body;
  if (http::parse_body(copy.dump(), 32).value() != copy) std::abort();
  std::vector<RequestFault> faults;
  http::Members members(*body, faults);
  for (const char* name : {"design", "name", "note"})
    static_cast<void>(members.text(name, 120, true));
  static_cast<void>(members.integer("copies", 1, 1000));
  static_cast<void>(members.boolean("good"));
  static_cast<void>(members.word("registration", {"kept", "re-registered"}));
  static_cast<void>(members.texts("tags", 20, 40));
  static_cast<void>(members.options("options"));
  members.require("design", "is needed");
  members.finish();
  for (const RequestFault& fault : faults)
    if (fault.code.empty() || fault.detail.empty()) std::abort();
  return 0;
}
