// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_binary.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <iterator>
#include <optional>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr std::string_view kSentinel{"AutoCAD Binary DXF\r\n\x1a\0", 22};

enum class ValueType : std::uint8_t { Text, Real, Byte, Int16, Int32, Int64, Chunk };

struct CodeRange {
  int first, last;
  ValueType type;
};

constexpr std::array<CodeRange, 32> kTypes{{
    {0, 9, ValueType::Text},        {10, 59, ValueType::Real},     {60, 79, ValueType::Int16},
    {90, 99, ValueType::Int32},     {100, 102, ValueType::Text},   {105, 105, ValueType::Text},
    {110, 149, ValueType::Real},    {160, 169, ValueType::Int64},  {170, 179, ValueType::Int16},
    {210, 239, ValueType::Real},    {270, 289, ValueType::Int16},  {290, 299, ValueType::Byte},
    {300, 309, ValueType::Text},    {310, 319, ValueType::Chunk},  {320, 369, ValueType::Text},
    {370, 389, ValueType::Int16},   {390, 399, ValueType::Text},   {400, 409, ValueType::Int16},
    {410, 419, ValueType::Text},    {420, 429, ValueType::Int32},  {430, 439, ValueType::Text},
    {440, 459, ValueType::Int32},   {460, 469, ValueType::Real},   {470, 481, ValueType::Text},
    {999, 999, ValueType::Text},    {1000, 1003, ValueType::Text}, {1004, 1004, ValueType::Chunk},
    {1005, 1009, ValueType::Text},  {1010, 1059, ValueType::Real}, {1060, 1070, ValueType::Int16},
    {1071, 1071, ValueType::Int32}, {-5, -1, ValueType::Text},
}};

std::optional<ValueType> type_of(int code) {
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(), [&](const CodeRange& range) {
    return code >= range.first && code <= range.last;
  });
  return found == kTypes.end() ? std::nullopt : std::optional(found->type);
}

/// Reads groups one after another and writes their text.
class BinaryReader {
 public:
  explicit BinaryReader(std::string_view bytes) : bytes_(bytes.substr(kSentinel.size())) {
    // The first group is 0 SECTION: its code has one byte if the name follows at once.
    wide_ = bytes_.size() > 1 && bytes_[1] == '\0';
  }

  Result<std::string> read(std::size_t most_bytes) {
    std::string text;
    while (!bytes_.empty()) {
      ++group_;
      const std::optional<int> code = read_code();
      if (!code) return cut_off();
      const std::optional<ValueType> type = type_of(*code);
      if (!type && objects_at_) {  // the drawing itself is complete
        text.resize(*objects_at_);
        break;
      }
      if (!type)
        return fail(ErrorKind::Malformed, place(),
                    fmt::format("the group code {} is none of DXF's; the file is damaged", *code));
      const std::size_t group_at = text.size();
      fmt::format_to(std::back_inserter(text), "{}\n", *code);
      const bool ends = *code == 0 && bytes_.substr(0, 4) == std::string_view("EOF\0", 4);
      const std::size_t value_at = text.size();
      if (!add_value(*type, text)) return cut_off();
      note_section(*code, std::string_view(text).substr(value_at), group_at);
      if (text.size() > most_bytes)
        return fail(
            ErrorKind::OutOfRange, place(),
            fmt::format("the drawing has more than {} bytes as text; split it", most_bytes));
      if (ends) break;  // what follows is padding
    }
    return text;
  }

 private:
  [[nodiscard]] std::string place() const { return fmt::format("group {}", group_); }
  [[nodiscard]] tl::unexpected<Error> cut_off() const {
    return fail(ErrorKind::Malformed, place(), "the file ends within it; is it complete?");
  }

  // Remembers where the section of objects begins. It holds nothing to cut, and programs write it
  // wrongly.
  void note_section(int code, std::string_view value, std::size_t group_at) {
    if (code == 0 && value == "SECTION\n") {
      section_at_ = group_at;
    } else if (code == 2 && section_at_) {
      objects_at_ = value == "OBJECTS\n" ? section_at_ : std::nullopt;
      section_at_.reset();
    }
  }

  /// `count` bytes as a little-endian number.
  std::optional<std::uint64_t> take(std::size_t count) {
    if (bytes_.size() < count) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t k = count; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes_[k]);
    bytes_.remove_prefix(count);
    return value;
  }

  std::optional<int> read_code() {
    if (wide_) {
      const auto code = take(2);
      return code ? std::optional<int>(static_cast<std::int16_t>(*code)) : std::nullopt;
    }
    const auto byte = take(1);
    if (!byte || *byte != 255) return byte ? std::optional<int>(*byte) : std::nullopt;
    const auto code = take(2);  // extended data
    return code ? std::optional<int>(static_cast<std::int16_t>(*code)) : std::nullopt;
  }

  bool add_value(ValueType type, std::string& text) {
    const auto number = [&](std::size_t count, auto as) {
      const auto value = take(count);
      if (value) fmt::format_to(std::back_inserter(text), "{}\n", as(*value));
      return value.has_value();
    };
    switch (type) {
      case ValueType::Real:
        return number(8, [](std::uint64_t v) { return std::bit_cast<double>(v); });
      case ValueType::Byte:
        return number(1, [](std::uint64_t v) { return v; });
      case ValueType::Int16:
        return number(2, [](std::uint64_t v) { return static_cast<std::int16_t>(v); });
      case ValueType::Int32:
        return number(4, [](std::uint64_t v) { return static_cast<std::int32_t>(v); });
      case ValueType::Int64:
        return number(8, [](std::uint64_t v) { return static_cast<std::int64_t>(v); });
      case ValueType::Chunk: {  // pictures and the like: nothing to cut
        const auto size = take(1);
        if (!size || bytes_.size() < *size) return false;
        bytes_.remove_prefix(*size);
        text += '\n';
        return true;
      }
      case ValueType::Text:
        break;
    }
    const std::size_t end = bytes_.find('\0');
    if (end == std::string_view::npos) return false;
    for (const char c : bytes_.substr(0, end)) text += c == '\n' || c == '\r' ? ' ' : c;
    text += '\n';
    bytes_.remove_prefix(end + 1);
    return true;
  }

  std::string_view bytes_;
  bool wide_{};
  std::size_t group_{};
  std::optional<std::size_t> section_at_, objects_at_;  // in the text
};

}  // namespace

bool is_binary_dxf(std::string_view bytes) { return bytes.starts_with(kSentinel.substr(0, 18)); }

Result<std::string> ascii_dxf(std::string_view bytes, std::size_t most_bytes) {
  if (!bytes.starts_with(kSentinel))
    return fail(ErrorKind::Malformed, "group 1",
                "the first line of a binary DXF is damaged; was it copied as text?");
  return BinaryReader(bytes).read(most_bytes);
}

}  // namespace popcut
