// SPDX-License-Identifier: MIT
#include "daemon/pictures/graphics.hpp"

namespace popcut::pictures {

const Graphics& graphics() {
  static const Graphics kGraphics;
  return kGraphics;
}

Result<void> load_graphics() {
  if (graphics().fault().empty()) return {};
  return fail(ErrorKind::Internal, "picture", "cannot be drawn: " + graphics().fault());
}

}  // namespace popcut::pictures
