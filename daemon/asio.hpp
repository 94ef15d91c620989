// SPDX-License-Identifier: MIT
#pragma once

// Boost 1.74 uses std::exchange in its coroutines without including <utility>.
#include <utility>

#include <boost/asio.hpp>
