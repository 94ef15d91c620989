// SPDX-License-Identifier: MIT
#include "daemon/client/problem_line.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "daemon/client/api.hpp"
#include "daemon/client/command_words.hpp"

namespace popcut::client {
namespace {

using Json = nlohmann::json;

std::string kind_of(const Json& problem) {
  const std::string type = text_of(problem, "type");
  return type.substr(type.rfind('/') + 1);
}

std::string allowed(const Json& problem) {
  std::string words;
  const auto list = problem.find("allowed_actions");
  if (list == problem.end() || !list->is_array()) return {};
  for (const Json& one : *list)
    if (one.is_string()) words += (words.empty() ? "" : ", ") + command_for(one.get<std::string>());
  return words;
}

/// The commands that would do now, as they are typed; empty: popcutd offers none.
std::string commands(const Json& problem) {
  const auto ways = problem.find("ways");
  if (ways == problem.end() || !ways->is_array()) return {};
  // "/v1/jobs/01J.../actions/arm"
  const std::string path = text_of(problem, "instance");
  constexpr std::string_view kJobs = "/v1/jobs/";
  if (path.rfind(kJobs, 0) != 0) return {};
  const std::string job = path.substr(kJobs.size(), path.find('/', kJobs.size()) - kJobs.size());
  std::string all;
  for (const Json& way : *ways)
    if (const std::string line = command_line_for(way, job); !line.empty())
      all += (all.empty() ? "" : ", or ") + line;
  return all.empty() ? all : "; possible now: " + all;
}

/// What was given at `pointer`: as popcutd repeats it, else as it was sent; "" if neither has it.
std::string given(const Json& fault, const std::string& pointer, const Json* sent) {
  constexpr std::size_t kMostShown = 60;
  Json value = fault.value("got", Json());
  try {
    if (value.is_null() && sent != nullptr && pointer.starts_with('/'))
      value = sent->at(Json::json_pointer(pointer));
  } catch (const Json::exception&) {  // it was not sent
  }
  const std::string text =
      value.is_null() ? "" : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= kMostShown ? text : "";
}

/// A value that was wrong on the command line. What an input holds, or what cannot be made of it,
/// stays what it is.
Error of_option(const Error& error, const std::string& option, const std::string& value) {
  const bool is_wrong_value = option != "INPUT" && error.kind != ErrorKind::Infeasible;
  const bool shown = value.empty() || error.detail.find(value) != std::string::npos;
  return {is_wrong_value ? ErrorKind::Usage : error.kind, option,
          shown ? error.detail : fmt::format("is {}; {}", value, error.detail)};
}

Error invalid(const Json& problem, const std::string& place, const std::string& detail,
              Subject subject, const Json* sent) {
  Error error{ErrorKind::OutOfRange, place, detail};
  const auto list = problem.find("errors");
  if (list == problem.end() || !list->is_array() || list->empty() || !list->front().is_object())
    return error;
  const Json& first = list->front();
  const std::string pointer = text_of(first, "pointer");
  const std::string code = text_of(first, "code");
  if (code == "infeasible") error.kind = ErrorKind::Infeasible;
  if (code == "malformed") error.kind = ErrorKind::Malformed;
  if (!text_of(first, "detail").empty()) error.detail = text_of(first, "detail");
  if (list->size() > 1) error.detail += fmt::format(" (and {} more)", list->size() - 1);
  if (subject == Subject::CommandLine || pointer.rfind('?', 0) == 0) {
    error.detail = in_command_words(error.detail);
    if (const std::string option = option_for(pointer); !option.empty()) {
      error = of_option(error, option, given(first, pointer, sent));
      error.detail += commands(problem);
      return error;
    }
  }
  return pointer.empty() ? error : within(place, {error.kind, pointer, error.detail});
}

Error conflict(const Json& problem, const std::string& place, std::string detail) {
  const std::string state = text_of(problem, "state");
  const std::string words = allowed(problem);
  detail = in_command_words(detail);
  if (!state.empty() && detail.find(state) == std::string::npos)
    detail += fmt::format("; it is {}", state);
  if (const std::string lines = commands(problem); !lines.empty())
    detail += lines;
  else if (!words.empty())
    detail += fmt::format("; possible now: {}", words);
  return {ErrorKind::Refused, place, detail};
}

}  // namespace

Error error_from(const HttpResponse& response, const std::string& place, Subject subject,
                 const Json* sent) {
  const auto parsed = parse_json(response.body, 32);
  if (!parsed || !parsed->is_object())
    return {ErrorKind::Refused, place,
            fmt::format("popcutd answered {} without a reason; see its log", response.status)};
  const Json& problem = *parsed;
  const std::string kind = kind_of(problem);
  std::string detail = text_of(problem, "detail");
  if (detail.empty()) detail = text_of(problem, "title");
  if (response.status == 401) {
    const bool missing = detail.find("a token is required") != std::string::npos;
    return {ErrorKind::Refused, place,
            (missing ? "popcutd requires a token" : detail) +
                "; set POPCUT_TOKEN ('popcut token create --role operator' creates one, on the "
                "computer where popcutd runs)"};
  }
  if (kind == "validation") return invalid(problem, place, detail, subject, sent);
  if (kind == "malformed-json") return {ErrorKind::Malformed, place, detail};
  if (kind == "too-large" || kind == "unsupported-media")
    return {ErrorKind::OutOfRange, place, detail};
  if (kind == "state-conflict" || kind == "stale") return conflict(problem, place, detail);
  if (kind == "device-absent") detail += commands(problem);
  return {ErrorKind::Refused, place,
          subject == Subject::CommandLine ? in_command_words(detail) : detail,
          kind == "not-found" ? ErrorReason::NotThere : ErrorReason::None};
}

}  // namespace popcut::client
