// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace popcut::cli {

/// Jobs of popcutd as text for a person. All functions take a job as the API gives it and stand any
/// JSON object.

/// The beginning of the job's id, enough to type.
[[nodiscard]] std::string short_id(const nlohmann::json& job);
/// Its name, or the beginning of its id.
[[nodiscard]] std::string job_title(const nlohmann::json& job);
/// Until the current sheet is cut, the longer estimate.
[[nodiscard]] double seconds_left(const nlohmann::json& job);
/// "cutting, sheet 1 of 3, path 210 of 362, on sim:cameo3"
[[nodiscard]] std::string job_summary(const nlohmann::json& job);
/// What waits for a person, each line with the command to type; none if nothing does.
[[nodiscard]] std::vector<std::string> waiting_for(const nlohmann::json& job);
/// What `waiting_for` says with an arrow before each thing, and the ways to choose from below it.
[[nodiscard]] std::vector<std::string> waiting_lines(const std::vector<std::string>& waits,
                                                     std::size_t indent);
/// 0 to 1, of the current sheet; below 0 where nothing is being cut.
[[nodiscard]] double part_done(const nlohmann::json& job);
[[nodiscard]] bool has_ended(const nlohmann::json& job);

struct ViewStyle {
  std::size_t width{120};  ///< columns; longer lines go on in the next one
  bool colour{false};
};
/// The live view: a line a job, below it what it waits for. Jobs of a running knife first, then
/// those that wait for a person, then the queue; among themselves in the order that is given.
[[nodiscard]] std::vector<std::string> jobs_view(const std::vector<nlohmann::json>& jobs,
                                                 const ViewStyle& style);
/// One job in full: `key: value` lines; with the ledger of its sheet, what became of its paths.
[[nodiscard]] std::vector<std::string> job_details(
    const nlohmann::json& job, const std::vector<nlohmann::json>& sheets,
    const std::optional<nlohmann::json>& ledger = std::nullopt);

}  // namespace popcut::cli
