// SPDX-License-Identifier: MIT
#include "daemon/cli/input/book_input.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "core/text/json_text.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace book_input_parts {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBookFile = "book.json";
constexpr const char* kMark = "\"popcut_book\"";
constexpr std::uintmax_t kMostBytes = 256u << 20;

/// Where the file of a book lies.
fs::path file_of(const fs::path& path) {
  std::error_code none;
  return fs::is_directory(path, none) ? path / kBookFile : path;
}

/// Why a folder is no book, and which file of it to give.
std::string no_book(const fs::path& folder) {
  constexpr const char* kPattern = "pattern.fold";
  const auto is_file = [](const fs::path& path) {
    std::error_code none;
    return fs::is_regular_file(path, none);
  };
  if (is_file(folder / kPattern))
    return fmt::format(
        "is the folder of one card; give its pattern, {}, or the design (.json) that it is made "
        "from",
        (folder / kPattern).string());
  const fs::path card = folder / "card-01";
  if (is_file(card / kPattern))
    return fmt::format(
        "holds single cards, not a book; give the {0} of one of them, such as {1}/{0}, or its "
        "spec.json",
        kPattern, card.string());
  return fmt::format("is a folder without {}; give the folder of a book, or a pattern (.fold)",
                     kBookFile);
}

/// A name inside a folder.
bool is_plain_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
}

}  // namespace
}  // namespace book_input_parts

bool names_book(const std::string& file) {
  using namespace book_input_parts;
  std::error_code none;
  const fs::path path(file);
  if (fs::is_directory(path, none)) return true;
  if (path.extension() != ".json" || !fs::is_regular_file(path, none)) return false;
  std::string head(64, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find(kMark) != std::string::npos;
}

Result<BookInput> read_book(const std::string& file) {
  using namespace book_input_parts;
  const fs::path book = file_of(file);
  std::error_code none;
  if (!fs::exists(book, none)) return fail(ErrorKind::Malformed, file, no_book(fs::path(file)));
  const auto text = read_file(book, kMostBytes);
  if (!text) return tl::unexpected(text.error());
  const auto json = parse_json(*text);
  if (!json) return tl::unexpected(within(book.string(), json.error()));
  const auto wrong = [&](ErrorKind kind, const std::string& pointer, const std::string& what) {
    return fail(kind, fmt::format("{}: {}", book.string(), pointer), what);
  };
  if (!json->is_object() || json->value("popcut_book", nlohmann::json()) != 1)
    return wrong(ErrorKind::Malformed, "/popcut_book",
                 "is not 1; give the folder of a book that 'popcut design' wrote");
  const auto cards = json->find("card");
  if (cards == json->end() || !cards->is_array())
    return wrong(ErrorKind::Malformed, "/card", "is not a list of cards");
  if (cards->empty() || cards->size() > static_cast<std::size_t>(kMostCards))
    return wrong(ErrorKind::OutOfRange, "/card",
                 fmt::format("has {} cards; must have 1 to {}", cards->size(), kMostCards));
  BookInput out;
  if (const auto name = json->find("name"); name != json->end() && name->is_string())
    out.name = name->get<std::string>();
  for (std::size_t i = 0; i < cards->size(); ++i) {
    const nlohmann::json& card = (*cards)[i];
    const std::string pointer = fmt::format("/card/{}/folder", i);
    if (!card.is_object() || !card.contains("folder") || !card["folder"].is_string())
      return wrong(ErrorKind::Malformed, pointer, "is missing; must be the card's folder");
    const auto folder = card["folder"].get<std::string>();
    if (!is_plain_name(folder))
      return wrong(ErrorKind::OutOfRange, pointer,
                   "leads out of the book; must be the name of a folder beside book.json");
    out.cards.push_back({folder, (book.parent_path() / folder / "pattern.fold").string()});
  }
  return out;
}

}  // namespace popcut::cli
