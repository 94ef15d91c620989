// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace popcut {

/// What is wrong with one field of a document.
struct FieldFault {
  ErrorKind kind{ErrorKind::Malformed};
  std::string place;   ///< as the document's notation names it, usually a JSON pointer
  std::string code;    ///< for programs: "type", "range", "missing", "unknown_member", "word", ...
  std::string detail;  ///< "is 0; must be a whole number from 1 to 9"
  std::string got{};   ///< what stands there, as JSON, if it is short and cannot be a secret
};

/// How a document names its fields and what it calls its types. The base class is plain JSON.
class Notation {
 public:
  Notation() = default;
  virtual ~Notation() = default;
  Notation(const Notation&) = delete;
  Notation& operator=(const Notation&) = delete;

  /// The place of the field at `pointer`. @param is_key  the field's name is wrong, not its value
  [[nodiscard]] virtual std::string place(const std::string& pointer, bool is_key) const;
  /// How a message proposes the field `name` of the object at `pointer`: "did you mean NAME?".
  [[nodiscard]] virtual std::string proposed(const std::string& pointer,
                                             const std::string& name) const;
  /// "an object", for what stands at a field or must stand there.
  [[nodiscard]] virtual std::string object(const std::string& key) const;
  /// "a list of objects", for what must stand at a field.
  [[nodiscard]] virtual std::string objects(const std::string& key) const;
  /// Whether a whole number may be written with a fraction of zero (5.0).
  [[nodiscard]] virtual bool takes_whole_fractions() const { return true; }
};

/// What a text field may hold.
struct TextRule {
  enum class Controls { Any, Lines, None };
  std::size_t least{0};  ///< characters
  std::size_t most{std::numeric_limits<std::size_t>::max()};
  Controls controls{Controls::Any};  ///< control characters; Lines: line feeds and tabs only
};

/// "a number", "a list", ... for an error message.
[[nodiscard]] std::string json_type(const nlohmann::json& value);
/// "a list of 2", "-3", "a text", ...: the same with what can be said shortly of the value.
[[nodiscard]] std::string shown_type(const nlohmann::json& value);

/// A number with as few digits as say it exactly: six where they do ("0.1", "1e+06"), else as many
/// as it takes, so that a value beyond a limit never reads like the limit.
[[nodiscard]] std::string exact_number(double value);
/// "a number above 0 and at most 9", "a number from 0 to 9".
[[nodiscard]] std::string number_words(double low, double high, bool open_low);

/// Reads the fields of one object of a document. All faults are kept with their places; a field
/// with a fault reads as its fallback. `finish` adds the fields that nobody asked for and returns
/// the first fault of the document. Every field of a function without "optional" in its name must
/// be there, unless a fallback is given.
class FieldReader {
 public:
  /// A reader of the root of a document, or of an object that stands at `pointer` in it. `object`
  /// and `notation` live longer than this.
  explicit FieldReader(const nlohmann::json& object, std::string pointer = "",
                       const Notation& notation = plain_json());
  /// A reader of what stands `below` this object ("mats/0"); its faults are those of this document.
  [[nodiscard]] FieldReader nested(const nlohmann::json& object, const std::string& below) const;

  [[nodiscard]] bool has(const std::string& key) const;
  /// The value at `key`, or nullptr.
  const nlohmann::json* value(const std::string& key);

  /// A number from `low` to `high` (both included); `open_low` leaves `low` itself out.
  double number(const std::string& key, std::optional<double> fallback, double low, double high,
                bool open_low = false);
  int integer(const std::string& key, std::optional<int> fallback, int low, int high);
  std::optional<std::int64_t> optional_integer(const std::string& key, std::int64_t low,
                                               std::int64_t high);
  std::string text(const std::string& key, std::optional<std::string> fallback,
                   const TextRule& rule = {});
  std::optional<std::string> optional_text(const std::string& key, const TextRule& rule = {});
  bool boolean(const std::string& key, bool fallback);
  std::optional<bool> optional_boolean(const std::string& key);
  /// One of `words`; returns its index.
  std::size_t word(const std::string& key, std::optional<std::size_t> fallback,
                   const std::vector<std::string>& words);
  std::optional<std::size_t> optional_word(const std::string& key,
                                           const std::vector<std::string>& words);
  /// A list of at most `most` texts that each follow `rule`.
  std::optional<std::vector<std::string>> optional_texts(
      const std::string& key, std::size_t most = std::numeric_limits<std::size_t>::max(),
      const TextRule& rule = {});
  /// Exactly `count` numbers.
  std::vector<double> numbers(const std::string& key, std::size_t count);

  /// The same of a value that stands `below` this object ("widths_mm/2").
  std::optional<double> number_at(const std::string& below, const nlohmann::json& value, double low,
                                  double high, bool open_low);
  std::optional<std::int64_t> integer_at(const std::string& below, const nlohmann::json& value,
                                         std::int64_t low, std::int64_t high);
  std::optional<std::string> text_at(const std::string& below, const nlohmann::json& value,
                                     const TextRule& rule);
  std::optional<bool> boolean_at(const std::string& below, const nlohmann::json& value);
  std::optional<std::size_t> word_at(const std::string& below, const nlohmann::json& value,
                                     const std::vector<std::string>& words);

  /// The object at `key`, whose fields `read` takes from a reader of it.
  template <std::invocable<FieldReader&> Read>
  void object(const std::string& key, Read read) {
    if (const nlohmann::json* found = require(key, notation().object(key)))
      read_nested(*found, key, read);
  }
  template <std::invocable<FieldReader&> Read>
  void optional_object(const std::string& key, Read read) {
    if (const nlohmann::json* found = value(key)) read_nested(*found, key, read);
  }
  /// The list of at most `most` objects at `key`, each taken by `read`.
  template <std::invocable<FieldReader&> Read>
  void objects(const std::string& key, Read read,
               std::size_t most = std::numeric_limits<std::size_t>::max()) {
    if (require(key, notation().objects(key))) optional_objects(key, read, most);
  }
  template <std::invocable<FieldReader&> Read>
  void optional_objects(const std::string& key, Read read,
                        std::size_t most = std::numeric_limits<std::size_t>::max()) {
    const nlohmann::json* list = list_of_objects(key, most);
    if (list == nullptr) return;
    for (std::size_t k = 0; k < list->size(); ++k)
      read_nested((*list)[k], key + "/" + std::to_string(k), read);
  }

  /// A fault of the field `key`, or, with "mats/0" as `key`, of what stands below it.
  void refuse(const std::string& key, ErrorKind kind, std::string detail,
              std::string code = "value");
  /// A fault of the object itself.
  void refuse(ErrorKind kind, std::string detail, std::string code = "value");
  /// A fault that another reader found.
  void refuse(const Error& error);
  /// A fault if there is no field `key`: "is missing; " and `what`.
  void need(const std::string& key, const std::string& what);

  [[nodiscard]] std::string pointer(const std::string& key) const;
  /// All faults of the document so far, at most 32.
  [[nodiscard]] const std::vector<FieldFault>& faults() const { return document_->faults; }
  /// The first fault of the document. The fields that nobody asked for are faults too.
  [[nodiscard]] Result<void> finish();

 private:
  struct Document {
    const Notation& notation;
    std::vector<FieldFault> faults{};
  };
  FieldReader(const nlohmann::json& object, std::string pointer,
              std::shared_ptr<Document> document);
  static const Notation& plain_json();
  [[nodiscard]] const Notation& notation() const { return document_->notation; }
  const nlohmann::json* require(const std::string& key, const std::string& what);
  const nlohmann::json* list_of_objects(const std::string& key, std::size_t most);
  template <typename Read>
  void read_nested(const nlohmann::json& found, const std::string& below, Read& read) {
    FieldReader inner = nested(found, below);
    if (!found.is_object()) return;
    read(inner);
    static_cast<void>(inner.finish());
  }
  [[nodiscard]] std::string place_of(const std::string& below) const;
  [[nodiscard]] std::string type_of(const nlohmann::json& value) const;
  void wrong_type(const std::string& below, const nlohmann::json& found, const std::string& what);
  void add(FieldFault fault);

  const nlohmann::json* object_;
  std::string pointer_;
  std::shared_ptr<Document> document_;
  std::vector<std::string> asked_;
};

}  // namespace popcut
