// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string_view>

#include "tests/fuzz/program_checks.hpp"
#include "tests/support/other_replies.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace popcut;
  const std::string_view reply(reinterpret_cast<const char*>(data), size);
  const DeviceStatus status = parse_status(reply);
  fuzzing::demand(!name_of(status).empty());
  // Only one character, blanks around it, may ever mean ready.
  if (status == DeviceStatus::Ready)
    fuzzing::demand(reply.find_first_not_of(" 0\x03") == std::string_view::npos);
  if (const auto identity = parse_identity(reply))
    fuzzing::demand(!identity->model.empty() && identity->model.size() <= 64);
  for (const bool lawful : {parse_pair(reply).has_value(), parse_number(reply).has_value(),
                            parse_position(reply).has_value(), parse_tools(reply).has_value()})
    if (lawful) fuzzing::demand(size <= 64);
  if (const auto tools = parse_tools(reply))
    for (const int code : *tools) fuzzing::demand(!tool_name(code).empty());
  return 0;
}
