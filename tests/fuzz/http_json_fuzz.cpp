// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/http/api/json_body.hpp"

using namespace popcut;
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
  FieldReader fields(*body, "", http::body_notation());
  for (const char* name : {"design", "name", "note"})
    static_cast<void>(fields.optional_text(name, http::lines_or_empty(120)));
  static_cast<void>(fields.optional_integer("copies", 1, 1000));
  static_cast<void>(fields.optional_boolean("good"));
  static_cast<void>(fields.optional_word("registration", {"kept", "re-registered"}));
  static_cast<void>(fields.optional_texts("tags", 20, http::line(40)));
  static_cast<void>(http::read_options(fields, "options"));
  fields.need("design", "is needed");
  static_cast<void>(fields.finish());
  for (const FieldFault& fault : fields.faults())
    if (fault.code.empty() || fault.detail.empty()) std::abort();
  return 0;
}
