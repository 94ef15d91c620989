// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "daemon/planning/search/card_search.hpp"

namespace popcut::planning {

// A search in steps, for who has several workers without shared memory: a task with `kMemoryFile`
// judges no candidate itself. It ends with `kWantedFile`: the candidates to be judged, then cards
// to be finished, and last those to be finished and drawn. Tasks with `kJudgeFile` take some of
// them each. They give `kJudgedFile`, or `kFinishedFile`, or both; and pictures and lattices of the
// cards, numbered from 1. The first task again, with a memory of all that, goes on from there,
// until it finds. Who judges what changes nothing of what is found.

/// Assets of a task of a search.
inline constexpr const char *kMemoryFile = "memory.json", *kJudgeFile = "judge.json";
/// Files of its outcome.
inline constexpr const char *kWantedFile = "wanted.json", *kJudgedFile = "judged.json",
                            *kFinishedFile = "finished.json";

/// {"ways": null or as in `wanted_text`, "cards": the items of `judged_text`, "finished" and
/// "drawn": those of `finished_text`}. Pictures and lattices of what is drawn come as assets, by
/// their numbers.
///
/// @retval Malformed  it is not of that form
[[nodiscard]] Result<SearchMemory> read_memory(std::string_view text);
/// {"ways": ..., "rough": ..., "doing": ..., "part": [from, to], "candidates": [...],
/// "finals": [...], "drawn": ...}; one of both lists is empty.
[[nodiscard]] std::string wanted_text(const WantedCards& wanted);
/// The same, with fewer candidates.
///
/// @retval Malformed  it is not of that form
[[nodiscard]] Result<WantedCards> read_wanted(std::string_view text);
/// A list of what became of candidates.
[[nodiscard]] std::string judged_text(const std::vector<JudgedCard>& cards);
/// A list of what became of cards, without their designs.
[[nodiscard]] std::string finished_text(const std::vector<FinishedCard>& cards);

}  // namespace popcut::planning
