// SPDX-License-Identifier: MIT
#include "core/text/file_kind.hpp"

#include <array>

#include "core/text/words.hpp"

namespace popcut {
namespace {

using namespace std::string_view_literals;

struct Head {
  std::string_view bytes;
  std::string_view kind;
  std::size_t at{};
};

constexpr std::array kHeads{Head{"\x89PNG\r\n"sv, "a PNG picture"},
                            Head{"\xFF\xD8\xFF"sv, "a JPEG picture"},
                            Head{"GIF8"sv, "a GIF picture"},
                            Head{"WEBP"sv, "a WebP picture", 8},
                            Head{"ftypheic"sv, "a HEIC picture", 4},
                            Head{"ftypavif"sv, "an AVIF picture", 4},
                            Head{"II*\0"sv, "a TIFF picture"},
                            Head{"MM\0*"sv, "a TIFF picture"},
                            Head{"%PDF-"sv, "a PDF document"},
                            Head{"%!PS"sv, "a PostScript document"},
                            Head{"PK\x03\x04"sv, "a ZIP archive, or a 3MF model, which is one"},
                            Head{"\x1F\x8B\x08"sv, "a gzip archive"},
                            Head{"7z\xBC\xAF\x27\x1C"sv, "a 7z archive"},
                            Head{"Rar!\x1A"sv, "a RAR archive"},
                            Head{"ply\n"sv, "a PLY model"},
                            Head{"ply\r\n"sv, "a PLY model"},
                            Head{"ISO-10303-21;"sv, "a STEP model"},
                            Head{"Kaydara FBX Binary"sv, "an FBX model"},
                            Head{"BLENDER"sv, "a Blender file"},
                            Head{"\x7F"
                                 "ELF"sv,
                                 "a program"}};

/// Of a text in angle brackets.
std::string_view marked_up(std::string_view text) {
  const auto has = [&](std::string_view word) { return text.find(word) != text.npos; };
  if (has("<svg")) return "an SVG drawing";
  if (has("<html") || has("<HTML") || has("<!DOCTYPE html") || has("<!doctype html"))
    return "a web page (HTML)";
  if (has("<COLLADA")) return "a COLLADA model";
  return "an XML text";
}

}  // namespace

std::string_view foreign_kind(std::string_view bytes) {
  for (const Head& head : kHeads)
    if (bytes.size() >= head.at && bytes.substr(head.at, head.bytes.size()) == head.bytes)
      return head.kind;
  constexpr std::size_t kLooked = 4096;
  std::string_view text = bytes.substr(0, kLooked);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text = trimmed(text, " \t\r\n");
  return text.starts_with('<') ? marked_up(text) : std::string_view();
}

}  // namespace popcut
