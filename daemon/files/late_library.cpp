// SPDX-License-Identifier: MIT
#include "daemon/files/late_library.hpp"

#include <dlfcn.h>

#include <fmt/format.h>

namespace popcut {

LateLibrary::LateLibrary(const char* file, const char* package)
    : library_(::dlopen(file, RTLD_NOW | RTLD_LOCAL)), file_(file), package_(package) {
  if (library_ == nullptr) note_fault();
}

LateLibrary::Address LateLibrary::function(const char* name) {
  if (library_ == nullptr) return Address(nullptr);
  void* const address = ::dlsym(library_, name);
  if (address == nullptr && fault_.empty()) note_fault();
  return Address(address);
}

void LateLibrary::note_fault() {
  const char* const why = ::dlerror();
  fault_ = fmt::format("{} cannot be loaded ({}); install the Debian package {}", file_,
                       why != nullptr ? why : "no reason is given", package_);
}

}  // namespace popcut
