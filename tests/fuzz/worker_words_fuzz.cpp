// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/planning/program_file.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/planning/task_json.hpp"

using namespace popcut;

namespace {

void check_range(const ByteRange& range, std::size_t size) {
  if (range.begin > range.end || range.end > size) std::abort();
}

}  // namespace

// What comes back from a worker that a hostile design may have taken over, and what lies in the
// state folder: an index, a line's end, and the program it is for.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto outcome = planning::read_outcome(text)) {
    for (const auto& sheet : outcome->sheets)
      if (!(std::isfinite(sheet.cut_mm) && std::isfinite(sheet.seconds))) std::abort();
  } else if (outcome.error().detail.empty()) {
    std::abort();
  }
  if (planning::read_error(text).detail.empty()) std::abort();
  if (const auto task = planning::read_task(text); !task && task.error().detail.empty())
    std::abort();
  if (const auto front = planning::read_front(text)) {
    for (const auto& card : front->cards)
      if (!(std::isfinite(card.error) && std::isfinite(card.seconds))) std::abort();
    if (!planning::read_front(planning::front_text(*front))) std::abort();
  } else if (front.error().detail.empty()) {
    std::abort();
  }
  if (const auto words = planning::read_search_words(text); !words && words.error().detail.empty())
    std::abort();
  const std::size_t line = text.find('\n');
  if (line == text.npos) return 0;
  const auto program =
      planning::read_program(text.substr(0, line), std::string(text.substr(line + 1)));
  if (!program) {
    if (program.error().detail.empty()) std::abort();
    return 0;
  }
  const std::size_t bytes = program->bytes.size();
  for (const ByteRange& range : program->setup) check_range(range, bytes);
  for (const ByteRange& range : program->strokes) check_range(range, bytes);
  for (const ByteRange& range : {program->geometry, program->trailer, program->search})
    check_range(range, bytes);
  for (const std::uint32_t dot : program->dots)
    if (dot >= program->strokes.size()) std::abort();
  return 0;
}
