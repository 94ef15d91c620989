// SPDX-License-Identifier: MIT
#pragma once

// toml++ 3.3 asserts (or, with NDEBUG, assumes) that a key begins where a stray byte can stand; the
// code behind the assertion tells it as the error it is.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_cast<void>(0)
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::daemon {

/// Reads the keys of one TOML table, each error with its line and column. The first error wins and
/// is kept; the values of what is absent stay as they are. `finish` reports it, or a key that
/// nobody asked for.
class TomlFields {
 public:
  TomlFields(const toml::table& table, std::string path);

  void number(const char* key, double& value, double low, double high);
  template <typename Integer>
  void integer(const char* key, Integer& value, std::int64_t low, std::int64_t high) {
    auto wide = static_cast<std::int64_t>(value);
    whole(key, wide, low, high);
    value = static_cast<Integer>(wide);
  }
  void text(const char* key, std::string& value);
  void boolean(const char* key, bool& value);
  /// One of `words`.
  void word(const char* key, std::string& value, const std::vector<std::string>& words);
  void texts(const char* key, std::vector<std::string>& value);
  /// A table below this one, if it is there.
  void table(const char* key, const std::function<Result<void>(TomlFields&)>& read);
  /// Each table of an array of tables.
  void tables(const char* key, const std::function<Result<void>(TomlFields&)>& read);
  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }
  /// Keeps an error at `key` unless there is one already.
  void refuse(const char* key, ErrorKind kind, const std::string& detail);
  [[nodiscard]] Result<void> finish() const;

 private:
  const toml::node* ask(const char* key);
  void whole(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high);
  void wrong_type(const char* key, const toml::node& node, const char* wanted);
  [[nodiscard]] std::string place(const toml::node& node, const std::string& key) const;
  const toml::table& table_;
  std::string path_;
  std::vector<std::string> asked_;
  std::optional<Error> error_;
};

}  // namespace popcut::daemon
