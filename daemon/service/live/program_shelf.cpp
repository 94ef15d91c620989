// SPDX-License-Identifier: MIT
#include "daemon/service/live/program_shelf.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "daemon/digest/digest.hpp"

namespace popcut::daemon {
namespace {

// A file of this size is read and hashed in a few milliseconds.
constexpr std::uintmax_t kSmallBytes = 128u << 10;

Result<ProgramShelf::Program> read_whole_program(const ProgramShelf::Read& read,
                                                 const std::string& folder, int sheet) {
  Result<StoredProgram> stored = read(folder, sheet);
  if (!stored) return tl::unexpected(stored.error());
  std::string sha256 = sha256_hex(stored->program.bytes);
  return ProgramShelf::Program{std::move(*stored), std::move(sha256)};
}

// Whether both files that are read are small: the program and its index.
bool is_small(const std::string& folder, int sheet) {
  const std::string stem = fmt::format("{}/sheet-{:02}", folder, sheet);
  for (const char* ending : {".gpgl", ".hpgl", ".program.json"}) {
    std::error_code absent;
    const std::uintmax_t bytes = std::filesystem::file_size(stem + ending, absent);
    if (!absent && bytes > kSmallBytes) return false;
  }
  return true;
}

}  // namespace

void ProgramShelf::read_ahead(const std::string& job, const std::string& folder, int sheet) {
  shelf_.erase(job);
  if (is_small(folder, sheet)) return;
  auto place = std::make_shared<Place>();
  place->folder = folder;
  place->sheet = sheet;
  shelf_[job] = place;
  auto made = std::make_shared<Result<Program>>(place->program);
  side_thread_.run(
      [made, read = read_, folder, sheet] { *made = read_whole_program(read, folder, sheet); },
      [made, place] {
        place->program = std::move(*made);
        place->is_read = true;
      });
}

std::optional<Result<ProgramShelf::Program>> ProgramShelf::find(const std::string& job,
                                                                const std::string& folder,
                                                                int sheet) {
  const auto found = shelf_.find(job);
  const bool is_there =
      found != shelf_.end() && found->second->folder == folder && found->second->sheet == sheet;
  if (!is_there) {
    if (is_small(folder, sheet)) return read_whole_program(read_, folder, sheet);
    read_ahead(job, folder, sheet);
    return std::nullopt;
  }
  if (!found->second->is_read) return std::nullopt;
  return found->second->program;
}

}  // namespace popcut::daemon
