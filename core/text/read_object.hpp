// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/text/json_fields.hpp"

namespace popcut {

/// The object at `key`, read by `read`; its faults become those of `fields`.
template <typename Value, typename Read>
void read_object(JsonFields& fields, const std::string& key, Value& out, Read read) {
  const nlohmann::json* object = fields.value(key);
  if (object == nullptr)
    return fields.add_error(ErrorKind::Malformed, fields.pointer(key),
                            "is missing; an object is needed");
  JsonFields inner(*object, fields.pointer(key));
  out = read(inner);
  if (const auto whole = inner.finish(); !whole)
    fields.add_error(whole.error().kind, whole.error().place, whole.error().detail);
}

}  // namespace popcut
