// SPDX-License-Identifier: MIT
#include "device/port/transport.hpp"

namespace popcut {

Transport::~Transport() = default;

}  // namespace popcut
