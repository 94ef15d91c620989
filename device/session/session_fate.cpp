// SPDX-License-Identifier: MIT
#include <algorithm>

#include "device/session/session.hpp"

namespace popcut {

std::string_view name_of(SessionPhase phase) {
  switch (phase) {
    case SessionPhase::Connecting:
      return "connecting";
    case SessionPhase::Settings:
      return "sending the settings";
    case SessionPhase::Searching:
      return "searching the marks";
    case SessionPhase::Cutting:
      return "cutting";
    case SessionPhase::Paused:
      return "paused on the panel";
    case SessionPhase::Held:
      return "held";
    case SessionPhase::Finishing:
      return "finishing";
    case SessionPhase::Parking:
      return "parking";
  }
  return "";
}

StrokeFate fate_of(ByteRange stroke, std::uint64_t ready_bytes, std::uint64_t good_bytes,
                   std::uint64_t accepted, std::uint64_t buffer_bytes) {
  if (stroke.begin >= std::min(accepted, stroke.end)) return StrokeFate::NotSent;
  const bool pushed_through = stroke.end + buffer_bytes <= good_bytes;
  return stroke.end <= ready_bytes || pushed_through ? StrokeFate::Certain : StrokeFate::InDoubt;
}

}  // namespace popcut
