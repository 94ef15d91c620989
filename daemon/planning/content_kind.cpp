// SPDX-License-Identifier: MIT
#include "daemon/planning/content_kind.hpp"

#include <cstddef>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::planning {
namespace {

/// Looks at the keys of the outermost object until one tells; never keeps a value.
class TopKeys : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::optional<InputKind> kind;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kDeepest; }
  bool end_object() override { return --depth_ >= 0; }
  bool start_array(std::size_t) override { return ++depth_ <= kDeepest; }
  bool end_array() override { return --depth_ >= 0; }
  bool key(string_t& name) override {
    if (depth_ != 1) return true;
    if (name == "popcut") kind = InputKind::Spec;
    if (name == "file_spec" || name == "vertices_coords") kind = InputKind::Fold;
    return !kind;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  static constexpr int kDeepest = 64;
  int depth_{0};
};

}  // namespace

Result<InputKind> kind_of_content(std::string_view text) {
  constexpr const char* kRight =
      "is neither a design spec (JSON with \"popcut\"), nor a FOLD (\"file_spec\"), SVG or DXF "
      "file";
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return fail(ErrorKind::Malformed, "", "is empty");
  if (text[first] == '<') return InputKind::Svg;
  if (text[first] >= '0' && text[first] <= '9') return InputKind::Dxf;
  if (text[first] != '{') return fail(ErrorKind::Malformed, "", kRight);
  TopKeys keys;
  nlohmann::json::sax_parse(text.begin(), text.end(), &keys);
  if (keys.kind) return *keys.kind;
  if (const auto whole = parse_json(text); !whole) return tl::unexpected(whole.error());
  return fail(ErrorKind::Malformed, "", kRight);
}

std::string_view name_of(InputKind kind) {
  switch (kind) {
    case InputKind::Spec:
      return "spec";
    case InputKind::Fold:
      return "fold";
    case InputKind::Svg:
      return "svg";
    case InputKind::Dxf:
      return "dxf";
  }
  return "";
}

Result<InputKind> input_kind_from(std::string_view name) {
  for (const InputKind kind : {InputKind::Spec, InputKind::Fold, InputKind::Svg, InputKind::Dxf})
    if (name_of(kind) == name) return kind;
  return fail(ErrorKind::OutOfRange, "/design_kind",
              fmt::format("is \"{}\"; spec, fold, svg or dxf is needed", name.substr(0, 40)));
}

}  // namespace popcut::planning
