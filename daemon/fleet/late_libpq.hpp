// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut::daemon {

/// libpq brings 25 libraries, for LDAP and Kerberos, that take a quarter of the start of popcut.
/// Only a fleet needs them. So popcut has functions of libpq's names in it, and loads the real ones
/// for the first connection.
///
/// @return why libpq cannot be loaded, and the package to install; empty: it is loaded, and its
///         functions may be called
[[nodiscard]] std::string libpq_fault();

}  // namespace popcut::daemon
