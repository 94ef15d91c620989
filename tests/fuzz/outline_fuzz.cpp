// SPDX-License-Identifier: MIT
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/design/outline/bridges.hpp"
#include "core/design/outline/drawing_outline.hpp"
#include "core/design/outline/extrusion.hpp"
#include "core/design/outline/text_outline.hpp"

using namespace popcut;

namespace {

void check(const Result<std::vector<Area>>& areas) {
  if (!areas) {
    if (areas.error().detail.empty()) std::abort();
    return;
  }
  if (areas->empty()) std::abort();
  const auto solid = extruded(*areas, 5.0);
  if (solid.empty() || solid.size() % 9 != 0) std::abort();
  const auto joined = with_bridges(*areas, 2.0);
  if (joined ? joined->areas.empty() : joined.error().detail.empty()) std::abort();
}

/// The usual font with three bytes changed for each five of `changes`: a place, and what stands
/// there then.
std::string changed_font(std::string_view changes) {
  std::string font(usual_font());
  for (std::size_t k = 0; k + 4 < changes.size(); k += 5) {
    std::size_t place = 0;
    for (std::size_t i = 0; i < 2; ++i)
      place = 256 * place + static_cast<unsigned char>(changes[k + i]);
    for (std::size_t i = 0; i < 3; ++i) font[(place + i) % font.size()] = changes[k + 2 + i];
  }
  return font;
}

}  // namespace

// The first byte chooses what the rest is: a text, a drawing, or changes in a font.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 3) {
    case 0:
      check(text_areas(rest, usual_font(), 30.0));
      break;
    case 1:
      check(drawing_areas(rest, 40.0));
      break;
    default:
      check(text_areas("Pop\u00FC", changed_font(rest), 30.0));
  }
  return 0;
}
