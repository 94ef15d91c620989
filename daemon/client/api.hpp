// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "daemon/client/http_client.hpp"
#include "daemon/client/problem_line.hpp"

namespace popcut::client {

/// popcutd's resources as JSON, for the commands.
class Api {
 public:
  using Json = nlohmann::json;

  /// @retval Usage  POPCUT_URL is no address
  [[nodiscard]] static Result<Api> from_environment();
  explicit Api(HttpClient client) : http_(std::move(client)) {}

  /// GET; `place` is what errors are about.
  [[nodiscard]] Result<Json> get(const std::string& target, const std::string& place);
  [[nodiscard]] Result<std::string> get_text(const std::string& target, const std::string& accept,
                                             const std::string& place);
  /// POST of JSON. If `rev` is 0 or more: only if the resource has that revision.
  [[nodiscard]] Result<Json> post(const std::string& target, const Json& body,
                                  const std::string& place, std::int64_t rev = -1);
  /// POST of a file as it is.
  [[nodiscard]] Result<Json> upload(const std::string& target, const std::string& bytes,
                                    const std::string& media_type, const std::string& place);
  [[nodiscard]] Result<void> remove(const std::string& target, const std::string& place);
  /// All items of a list, page by page, at most `most`.
  [[nodiscard]] Result<std::vector<Json>> list(const std::string& target, const std::string& place,
                                               std::size_t most = 100'000);

  /// The job that `word` names: an id or a unique prefix of one, in upper or lower case.
  ///
  /// @retval Usage    several jobs match
  /// @retval Refused  no job matches
  [[nodiscard]] Result<Json> find_job(const std::string& word);
  /// The only job for which `action` is possible now.
  ///
  /// @retval Refused  there is none
  /// @retval Usage    there are several
  [[nodiscard]] Result<Json> only_job_for(const std::string& action);
  /// Whether popcutd has a page (at "/").
  [[nodiscard]] Result<bool> has_page();
  /// Jobs that have not ended.
  [[nodiscard]] Result<std::vector<Json>> open_jobs();

  /// Does `action` to the job seen in `job`. If only its revision has changed since, and not what a
  /// person sees of it (state, sheet, blank, segment), the action is done anyway.
  [[nodiscard]] Result<Json> act(const Json& job, const std::string& action, const Json& body);
  /// Does `action` to a device ("enable", "disable", "reset", "test-cut") as it is now.
  [[nodiscard]] Result<Json> act_on_device(const std::string& id, const std::string& action,
                                           const Json& body);
  /// Changes members of the job seen in `job`.
  [[nodiscard]] Result<Json> patch(const Json& job, const Json& members);

  [[nodiscard]] HttpClient& http() { return http_; }

 private:
  [[nodiscard]] Result<Json> read(Result<HttpResponse> response, const std::string& place,
                                  Subject subject = Subject::CommandLine,
                                  const Json* sent = nullptr);
  HttpClient http_;
};

/// Makes all names and texts of an answer such that a terminal shows them (see `shown_text`), line
/// by line. popcutd may be another server, and who names a job is somebody else.
void make_printable(nlohmann::json& value);
/// The same of a text.
[[nodiscard]] std::string shown_lines(std::string_view text);
/// A text member, or an empty text.
[[nodiscard]] std::string text_of(const nlohmann::json& object, const char* key);
/// "rev", else 0.
[[nodiscard]] std::int64_t revision_of(const nlohmann::json& object);
}  // namespace popcut::client
