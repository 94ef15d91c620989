// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut {

/// A shared library that is loaded when it is first needed, not when the program starts. Derive a
/// table of its functions from it, one line each, under the names of its header:
///
///     struct Drawing : LateLibrary {
///       Drawing() : LateLibrary("libcairo.so.2", "libcairo2") {}
///       decltype(&::cairo_create) cairo_create = function("cairo_create");
///     };
///
/// The library stays loaded until the program ends.
class LateLibrary {
 public:
  LateLibrary(const LateLibrary&) = delete;
  LateLibrary& operator=(const LateLibrary&) = delete;

  /// Empty if all functions of the table were found; else why not, and the Debian package to
  /// install. Then no function may be called.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 protected:
  /// @param file     "libcairo.so.2"
  /// @param package  of Debian, for `fault`
  LateLibrary(const char* file, const char* package);
  ~LateLibrary() = default;

  /// An address that becomes a pointer to a function of any type.
  class Address {
   public:
    explicit Address(void* address) : address_(address) {}
    template <typename Function>
    operator Function*() const {  // NOLINT(google-explicit-constructor): the table reads plainly
      return reinterpret_cast<Function*>(address_);
    }

   private:
    void* address_;
  };
  /// A function of the library, or of one that it needs.
  [[nodiscard]] Address function(const char* name);

 private:
  void note_fault();
  void* library_{};
  std::string file_, package_, fault_;
};

}  // namespace popcut
