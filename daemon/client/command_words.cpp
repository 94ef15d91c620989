// SPDX-License-Identifier: MIT
#include "daemon/client/command_words.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/plan/plan_options.hpp"

namespace popcut::client {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

constexpr std::array<Words, 32> kOptions{{
    {"/before", "--before"},
    {"/blank", "--blank"},
    {"/cards", "--cards"},
    {"/copies", "--copies"},
    {"/design", "INPUT"},
    {"/device", "--device"},
    {"/from_path", "--from"},
    {"/front", "--front"},
    {"/good", "RESULT"},
    {"/i_accept_double_cut", "--accept-double-cut"},
    {"/job", "JOB"},
    {"/lifetime_s", "--days"},
    {"/machine", "--machine"},
    {"/material", "--material"},
    {"/name", "--name"},
    {"/note", "--note"},
    {"/plan_again", "--plan-again"},
    {"/priority", "--priority"},
    {"/reason", "--reason"},
    {"/registration", "--registration"},
    {"/role", "--role"},
    {"/sheet", "SHEET"},
    {"/site", "--site"},
    {"/skip_in_doubt", "--skip-in-doubt"},
    {"/style", "--style"},
    {"?after", "--after"},
    {"?by", "--by"},
    {"?from", "--from"},
    {"?limit", "--limit"},
    {"?name", "--name"},
    {"?state", "--state"},
    {"?to", "--to"},
}};

constexpr std::array<Words, 4> kCommands{{
    {"confirm-result", "confirm"},
    {"resume-from", "resume --from"},
    {"retry-sheet", "retry"},
    {"skip-sheet", "skip"},
}};

// Longer ones before those that they contain.
constexpr std::array<Words, 9> kPhrases{{
    {"registration \"re-registered\"", "--registration re-registered"},
    {"i_accept_double_cut", "--accept-double-cut"},
    {"accept_warnings", "--accept-warnings"},
    {"needs plan_again: true", "needs --plan-again"},
    {"skip_in_doubt", "--skip-in-doubt"},
    // The whole commands stand behind, in what is possible now.
    {" with retry-sheet", ""},
    {" with the action enable", ""},
    {"name the device that holds the sheet", "name the device that holds the sheet with --device"},
    {"from_path", "--from"},
}};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// "`mat`" of an option is "--mat".
void replace_plan_options(std::string& text) {
  for (const PlanOption& option : plan_option_table())
    replace_all(text, fmt::format("`{}`", option.name), fmt::format("--{}", option.name));
  replace_all(text, "`up`", "--up");  // of a search
}

}  // namespace

std::string option_for(std::string_view pointer) {
  constexpr std::string_view kPlan = "/options/";
  if (pointer.substr(0, kPlan.size()) == kPlan)
    return "--" + std::string(pointer.substr(kPlan.size()));
  for (const auto& [known, option] : kOptions)
    if (pointer == known) return std::string(option);
  return {};
}

std::string command_for(std::string_view action) {
  for (const auto& [known, command] : kCommands)
    if (action == known) return std::string(command);
  return std::string(action);
}

std::string meaning_of(const nlohmann::json& way) {
  if (!way.is_object() || way.value("action", "") != "resume-from") return {};
  const nlohmann::json body = way.value("body", nlohmann::json::object());
  const bool skips = body.value("skip_in_doubt", false);
  const bool again = body.value("i_accept_double_cut", false);
  if (skips && again) return "skips some of what is in doubt, cuts the rest again";
  if (skips) return "skips what is in doubt";
  return again ? "cuts again what may be cut already" : "";
}

std::string command_line_for(const nlohmann::json& way, const std::string& asked_about) {
  if (!way.is_object()) return {};
  const std::string action = way.value("action", ""), device = way.value("device", "");
  if (!device.empty()) return fmt::format("popcut devices {} {}", action, quoted(device));
  const std::string job = way.value("job", asked_about);
  if (job.empty()) return {};
  const nlohmann::json body = way.value("body", nlohmann::json::object());
  const std::string command = action == "resume-from" ? "resume" : command_for(action);
  std::string line = fmt::format("popcut {} {}", command, job);
  const auto number = [&](const char* name) { return body.value(name, std::int64_t{0}); };
  // 'popcut start' cuts the sheet that was armed.
  if (body.contains("sheet") && action != "start") line += fmt::format(" {}", number("sheet"));
  if (body.contains("good")) line += body.value("good", false) ? " good" : " bad";
  if (number("blank") > 1) line += fmt::format(" --blank {}", number("blank"));
  if (body.contains("device")) line += " --device " + quoted(body.value("device", ""));
  if (body.contains("site")) line += " --site " + quoted(body.value("site", ""));
  if (body.contains("from_path")) line += fmt::format(" --from {}", number("from_path"));
  if (body.value("registration", "") == "re-registered") line += " --registration re-registered";
  if (body.value("skip_in_doubt", false)) line += " --skip-in-doubt";
  if (body.value("i_accept_double_cut", false)) line += " --accept-double-cut";
  if (body.contains("accept_warnings")) line += " --accept-warnings";
  if (body.value("plan_again", false)) line += " --plan-again";
  return line;
}

std::string in_command_words(std::string text) {
  replace_plan_options(text);
  for (const auto& [from, to] : kPhrases) replace_all(text, from, to);
  for (const auto& [from, to] : kCommands) replace_all(text, from, to);
  constexpr std::string_view kMeant = "did you mean ";
  const std::size_t at = text.find(kMeant);
  if (at == std::string::npos) return text;
  const std::size_t begin = at + kMeant.size(), end = text.find('?', begin);
  if (end == std::string::npos) return text;
  const std::string option = option_for(std::string_view(text).substr(begin, end - begin));
  if (!option.empty()) text.replace(begin, end - begin, option);
  return text;
}

Error on_command_line(Error error) {
  constexpr std::array<std::string_view, 5> kBeside{"/machine", "/material", "/cards", "/front",
                                                    "/style"};
  if (error.place.starts_with("/options/") ||
      std::find(kBeside.begin(), kBeside.end(), error.place) != kBeside.end())
    error.place = option_for(error.place);
  replace_plan_options(error.detail);
  return error;
}

std::string quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.,:/@%+=";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace popcut::client
