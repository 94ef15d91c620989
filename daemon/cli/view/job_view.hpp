// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace popcut::cli {

/// Jobs of popcutd as text for a person. All functions take a job as the API sends it, and accept
/// any JSON object.

/// What the current sheet needs: "paper-220, 304.8 mm across the cameo3 x 304.8 mm, mat 12x12,
/// pop-up side up"; empty: it is not planned yet.
[[nodiscard]] std::string load_text(const nlohmann::json& job);
/// "19 folds, the shortest 6 mm; about 10 minutes to fold (easy)"; empty where nothing is folded.
[[nodiscard]] std::string folding_text(const nlohmann::json& job);
/// The warnings of a job's plan.
[[nodiscard]] std::vector<std::string> warning_lines(const nlohmann::json& job);
/// The warnings of a job that say that its cut may be spoiled, and that nobody has accepted yet.
[[nodiscard]] std::vector<std::string> unaccepted_warnings(const nlohmann::json& job);

/// The beginning of the job's id, enough to type.
[[nodiscard]] std::string short_id(const nlohmann::json& job);
/// Its name, or the beginning of its id.
[[nodiscard]] std::string job_title(const nlohmann::json& job);
/// Seconds until the current sheet is cut, the longer estimate.
[[nodiscard]] double seconds_left(const nlohmann::json& job);
/// "cutting, sheet 1 of 3, path 210 of 362, on sim:cameo3"
[[nodiscard]] std::string job_summary(const nlohmann::json& job);
/// What a person has to do, each line with its command; empty if nothing.
[[nodiscard]] std::vector<std::string> waiting_for(const nlohmann::json& job);
/// The lines of `waiting_for`, each with an arrow; choices are indented below.
[[nodiscard]] std::vector<std::string> waiting_lines(const std::vector<std::string>& waits,
                                                     std::size_t indent);
/// 0 to 1, of the current sheet; below 0 where nothing is being cut.
[[nodiscard]] double part_done(const nlohmann::json& job);
[[nodiscard]] bool has_ended(const nlohmann::json& job);

struct ViewStyle {
  std::size_t width{120};  ///< columns; longer lines go on in the next one
  bool colour{false};
};
/// The live view: one line for each job, below it what the job waits for. Running jobs come first,
/// then those that wait for a person, then the queue; within each group the given order stays.
[[nodiscard]] std::vector<std::string> jobs_view(const std::vector<nlohmann::json>& jobs,
                                                 const ViewStyle& style);
/// One job in full, as `key value` lines; with the ledger of its sheet, the state of its paths.
/// Beyond `width` columns what explains a command stands in a line of its own.
[[nodiscard]] std::vector<std::string> job_details(
    const nlohmann::json& job, const std::vector<nlohmann::json>& sheets,
    const std::optional<nlohmann::json>& ledger = std::nullopt, std::size_t width = 1000);

/// A user of popcutd with a readable name: "anna (uid:1000)" for "uid:1000" if this computer has a
/// user with that number, else `principal` unchanged.
[[nodiscard]] std::string person_name(const std::string& principal);

}  // namespace popcut::cli
