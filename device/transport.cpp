// SPDX-License-Identifier: MIT
#include "device/transport.hpp"

namespace popcut {

Transport::~Transport() = default;

}  // namespace popcut
