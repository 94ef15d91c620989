// SPDX-License-Identifier: MIT
#include "daemon/cli/view/job_view.hpp"

#include <pwd.h>
#include <sys/types.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/hands/folding.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/help/terminal_text.hpp"
#include "daemon/client/command_words.hpp"

namespace popcut::cli {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kShortId = 12;
constexpr const char* kWarning = "warning: ";
constexpr std::size_t kMostJobsShown = 200;

std::string shown_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  const bool is_text = found != object.end() && found->is_string();
  return is_text ? shown_text(found->get<std::string>()) : std::string();
}

// Why a plan was refused names options of requests.
std::string reason_of(const Json& job) { return client::in_command_words(shown_of(job, "reason")); }

std::int64_t whole_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

const Json& part_of(const Json& object, const char* key) {
  static const Json kNothing = Json::object();
  const auto found = object.find(key);
  return found != object.end() && found->is_object() ? *found : kNothing;
}

bool may(const Json& job, const char* action) {
  const auto list = job.find("actions");
  return list != job.end() && list->is_array() &&
         std::find(list->begin(), list->end(), Json(action)) != list->end();
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string sheet_text(const Json& job) {
  const std::int64_t sheet = whole_of(job, "sheet"), total = whole_of(job, "sheets_total");
  if (sheet > 0) return fmt::format("sheet {} of {}", sheet, total);
  return total > 0 ? fmt::format("{} sheet{}", total, total == 1 ? "" : "s") : std::string();
}

bool is_held(const Json& job) {
  const auto held = job.find("held");
  return held != job.end() && *held == true;
}

bool is(const Json& job, const char* state) { return shown_of(job, "state") == state; }

std::string path_text(const Json& job) {
  const Json& progress = part_of(job, "progress");
  const std::int64_t total = whole_of(progress, "paths_total");
  if (total == 0) return {};
  // What was sent is at most a window ahead of the knife; what is certain may lag by a whole
  // buffer.
  return fmt::format("path {} of {}", whole_of(progress, "paths_sent"), total);
}

std::string doubt_text(const Json& job) {
  const Json& progress = part_of(job, "progress");
  const std::int64_t certain = whole_of(progress, "paths_certain");
  const std::int64_t sent = whole_of(progress, "paths_sent");
  if (sent <= certain) return fmt::format("{} paths are cut, no path is in doubt", certain);
  return fmt::format("{} paths are certainly cut, {} more are in doubt", certain, sent - certain);
}

/// Whether the sheet can be complete: where popcutd says its ways, as they say. Else by the
/// figures; they are of the whole job, so they decide only for a job of one sheet.
bool may_be_whole(const Json& job) {
  if (const auto ways = job.find("ways"); ways != job.end() && ways->is_array() && !ways->empty())
    return std::any_of(ways->begin(), ways->end(), [](const Json& way) {
      return way.is_object() && shown_of(way, "action") == "confirm-result";
    });
  const Json& progress = part_of(job, "progress");
  return whole_of(job, "sheets_total") != 1 ||
         whole_of(progress, "paths_sent") >= whole_of(progress, "paths_total");
}

std::string with_comment(const std::string& command, const std::string& comment) {
  return fmt::format("  {:<41}{}# {}", command, command.size() < 41 ? "" : "   ", comment);
}

/// The ways that popcutd offers, where it does: of one job.
std::vector<Json> ways_of(const Json& job, bool of_device) {
  std::vector<Json> fitting;
  const auto ways = job.find("ways");
  if (ways == job.end() || !ways->is_array()) return fitting;
  for (const Json& way : *ways)
    if (way.is_object() &&
        (of_device ? way.contains("device") : shown_of(way, "action") == "resume-from"))
      fitting.push_back(way);
  return fitting;
}

/// The whole commands that go on with its sheet. A list of jobs does not have them; then the
/// command that shows them.
std::vector<std::string> resume_commands(const Json& job) {
  const std::string id = short_id(job);
  std::vector<std::string> lines;
  for (const Json& way : ways_of(job, false)) {
    const std::string meaning = client::meaning_of(way);
    lines.push_back(with_comment(client::command_line_for(way, id),
                                 "continue this sheet" + (meaning.empty() ? "" : ", " + meaning)));
  }
  if (lines.empty() && may(job, "resume-from"))
    lines.push_back(with_comment("popcut jobs " + id, "shows how to continue this sheet"));
  return lines;
}

/// What makes its cutter usable again.
std::vector<std::string> cure_commands(const Json& job) {
  std::vector<std::string> lines;
  for (const Json& way : ways_of(job, true))
    lines.push_back(
        with_comment(client::command_line_for(way, short_id(job)), "once the cause is fixed"));
  if (lines.empty() && shown_of(part_of(job, "attention"), "kind") == "device_fault" &&
      is(job, "ready"))
    lines.push_back(
        with_comment("popcut devices reset " + shown_of(job, "device"), "once the cause is fixed"));
  return lines;
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

void interrupted_ways(const Json& job, std::vector<std::string>& lines) {
  const std::string id = short_id(job);
  const std::int64_t sheet = whole_of(job, "sheet");
  const std::string reason = shown_of(job, "reason");
  lines.push_back(fmt::format("sheet {} was interrupted{}{}; {}. Look at it, then choose:", sheet,
                              reason.empty() ? "" : " by ", reason, doubt_text(job)));
  const auto add = [&](const char* action, const std::string& command, const char* what) {
    if (may(job, action)) lines.push_back(with_comment(command, what));
  };
  append(lines, cure_commands(job));
  add("retry-sheet", fmt::format("popcut retry {} {}", id, sheet), "cut it again on a new sheet");
  append(lines, resume_commands(job));
  if (may_be_whole(job))
    add("confirm-result", fmt::format("popcut confirm {} {} good", id, sheet),
        "the sheet is complete");
  add("cancel", fmt::format("popcut cancel {}", id), "cancel the job");
}

int rank(const Json& job) {
  if (is(job, "cutting") || is(job, "paused")) return 0;
  if (is(job, "interrupted") || is(job, "armed")) return 1;
  if (is(job, "ready")) return 2;
  return has_ended(job) ? 4 : 3;
}

/// "0..117, 130..140" of a ledger.
std::string ranges_of(const Json& ledger, const char* key) {
  constexpr std::size_t kMost = 8;
  std::string text;
  const auto found = ledger.find(key);
  if (found == ledger.end() || !found->is_array()) return text;
  for (std::size_t i = 0; i < found->size(); ++i) {
    const Json& range = (*found)[i];
    if (!range.is_array() || range.size() != 2) continue;
    if (i == kMost) return text + fmt::format(" and {} more", found->size() - kMost);
    text += fmt::format("{}{}..{}", text.empty() ? "" : ", ", range[0].dump(), range[1].dump());
  }
  return text;
}

std::string bar(double part) {
  constexpr int kCells = 16;
  const int full = static_cast<int>(std::clamp(part, 0.0, 1.0) * kCells);
  return fmt::format("[{}{}]", std::string(static_cast<std::size_t>(full), '#'),
                     std::string(static_cast<std::size_t>(kCells - full), '.'));
}

/// The columns of a job's line, widest first: with a bar, without it, and close together.
std::vector<std::string> view_line(const Json& job, std::size_t width) {
  constexpr std::size_t kNarrow = 72;
  const double part = part_done(job);
  std::string far, rest;
  if (part >= 0) far = fmt::format("{:3.0f} %  {} left", 100 * part, clock_text(seconds_left(job)));
  if (!shown_of(job, "device").empty()) rest += "  on " + shown_of(job, "device");
  if (!has_ended(job) && !shown_of(job, "site").empty()) rest += "  at " + shown_of(job, "site");
  if (const std::int64_t priority = whole_of(job, "priority"); priority != 0 && !has_ended(job))
    rest += fmt::format("  priority {}", priority);
  if (is_held(job)) rest += "  held";
  if (has_ended(job) && !shown_of(job, "reason").empty()) rest += "  " + reason_of(job);
  const std::string name = shown_of(job, "name"), state = shown_of(job, "state");
  if (width < kNarrow) {
    std::string close = short_id(job);
    for (const std::string& word : {fitted(name, 20), state, sheet_text(job), far})
      if (!word.empty()) close += "  " + word;
    return wrapped(close + rest, width, 2);
  }
  const std::string begin =
      fmt::format("{}  {} {} {}", padded(short_id(job), kShortId), padded(name, 20),
                  padded(state, 12), padded(sheet_text(job), 14));
  std::string line = begin + (part >= 0 ? fmt::format(" {} {}", bar(part), far) : "") + rest;
  if (columns_of(line) > width) line = begin + (part >= 0 ? " " + far : "") + rest;
  line.resize(line.find_last_not_of(' ') + 1);
  return wrapped(line, width, kShortId + 2);
}

/// Of a job that has ended no sheet is still waiting or being cut.
std::string sheet_state(const Json& job, const Json& sheet) {
  const std::string state = shown_of(sheet, "state");
  if (!has_ended(job) || state == "done" || state == "skipped") return state;
  const bool begun = state == "cutting" || state == "interrupted";
  return begun ? "not finished" : "not cut";
}

/// A sheet of which the ledger has paths that were not sent cannot be confirmed as whole.
Json as_sent(const Json& job, const std::optional<Json>& ledger) {
  Json same = job;
  const auto actions = same.find("actions");
  if (ledger && !ranges_of(*ledger, "not_sent").empty() && actions != same.end() &&
      actions->is_array())
    actions->erase(std::remove(actions->begin(), actions->end(), "confirm-result"), actions->end());
  return same;
}

std::string without_comment(std::string wait) {
  wait.resize(std::min(wait.find(" # "), wait.size()));
  wait.resize(wait.find_last_not_of(' ') + 1);
  return wait;
}

/// A command and the comment behind it in a line each, where both have no room in one.
std::vector<std::string> comment_apart(const std::string& wait, std::size_t width) {
  const std::size_t comment = wait.find(" # ");
  if (columns_of(wait) <= width || comment == std::string::npos) return {wait};
  const std::size_t indent = wait.find_first_not_of(' ');
  return {without_comment(wait), std::string(indent + 2, ' ') + wait.substr(comment + 1)};
}

}  // namespace

std::string short_id(const Json& job) { return shown_of(job, "id").substr(0, kShortId); }

std::string job_title(const Json& job) {
  const std::string name = shown_of(job, "name");
  return name.empty() ? short_id(job) : name;
}

bool has_ended(const Json& job) {
  return is(job, "done") || is(job, "failed") || is(job, "cancelled");
}

double part_done(const Json& job) {
  const Json& progress = part_of(job, "progress");
  const std::int64_t total = whole_of(progress, "paths_total");
  if (total <= 0 || !(is(job, "cutting") || is(job, "paused"))) return -1;
  return static_cast<double>(whole_of(progress, "paths_sent")) / static_cast<double>(total);
}

double seconds_left(const Json& job) {
  const Json& est = part_of(job, "est");
  const auto range = est.find("remaining_s");
  if (range == est.end() || !range->is_array() || range->size() != 2) return 0;
  return (*range)[1].is_number() ? (*range)[1].get<double>() : 0;
}

std::string job_summary(const Json& job) {
  std::string line = shown_of(job, "state");
  const auto add = [&](const std::string& more) {
    if (!more.empty()) line += ", " + more;
  };
  const std::string reason = reason_of(job);
  if (reason.rfind(line + " ", 0) == 0)
    line = reason;  // "cancelled by anna"
  else
    add(reason);
  if (is_held(job)) add("held");
  if (!has_ended(job)) add(sheet_text(job));
  if (part_done(job) >= 0) add(path_text(job));
  if (!has_ended(job) && !shown_of(job, "device").empty()) add("on " + shown_of(job, "device"));
  if (!has_ended(job) && !shown_of(job, "site").empty()) add("at " + shown_of(job, "site"));
  return line;
}

std::string load_text(const Json& job) {
  const Json& load = part_of(job, "load");
  if (load.empty()) return {};
  const auto mm = [&](const char* key) {
    const auto found = load.find(key);
    return found != load.end() && found->is_number() ? found->get<double>() : 0.0;
  };
  const std::string mat = shown_of(load, "mat"), side = shown_of(load, "side");
  return fmt::format("{}, {:.5g} mm across the {} x {:.5g} mm{}{}", shown_of(load, "material"),
                     mm("width_mm"), shown_of(load, "machine"), mm("length_mm"),
                     mat.empty() ? "" : fmt::format(", mat {}", mat),
                     side.empty() ? "" : fmt::format(", {} side up", side));
}

std::string folding_text(const Json& job) {
  const Json& work = part_of(job, "handwork");
  const auto number = [&](const char* key) {
    const auto found = work.find(key);
    return found != work.end() && found->is_number() ? found->get<double>() : 0.0;
  };
  const std::int64_t folds = whole_of(work, "folds");
  if (folds <= 0) return {};
  return hands::handwork_words({.folds = static_cast<std::size_t>(folds),
                                .shortest_mm = number("shortest_fold_mm"),
                                .time_s = number("fold_s"),
                                .label = shown_of(work, "label")});
}

std::vector<std::string> warning_lines(const Json& job) {
  std::vector<std::string> lines;
  if (const auto all = job.find("warnings"); all != job.end() && all->is_array())
    for (const Json& one : *all) {
      if (!one.is_object()) continue;
      lines.push_back(client::in_command_words(shown_of(one, "message")));
      if (shown_of(one, "code") == "cutter_chosen")
        lines.back() += fmt::format(": popcut change {} --device ID --plan-again", short_id(job));
    }
  return lines;
}

std::vector<std::string> unaccepted_warnings(const Json& job) {
  std::vector<std::string> lines;
  const auto codes = job.find("unaccepted_warnings"), all = job.find("warnings");
  if (codes == job.end() || !codes->is_array() || all == job.end() || !all->is_array())
    return lines;
  for (const Json& one : *all) {
    if (!one.is_object() || one.value("spoils", Json()) != true) continue;
    if (std::find(codes->begin(), codes->end(), one.value("code", Json())) != codes->end())
      lines.push_back(client::in_command_words(shown_of(one, "message")));
  }
  return lines;
}

std::vector<std::string> waiting_for(const Json& job) {
  std::vector<std::string> lines;
  if (is(job, "ready") && may(job, "arm"))
    for (const std::string& warning : unaccepted_warnings(job)) lines.push_back(kWarning + warning);
  const std::string id = short_id(job);
  const std::int64_t sheet = whole_of(job, "sheet"), total = whole_of(job, "sheets_total");
  const Json& attention = part_of(job, "attention");
  const std::string kind = shown_of(attention, "kind"), text = shown_of(attention, "text");
  const std::string device = shown_of(job, "device"), site = shown_of(job, "site");
  const std::string into = !device.empty() ? " into " + device : !site.empty() ? " at " + site : "";
  if (is(job, "interrupted")) {
    interrupted_ways(job, lines);
  } else if (is(job, "armed")) {
    lines.push_back(fmt::format("armed: popcut start {}   (within 10 minutes)", id));
    if (const std::string load = load_text(job); !load.empty())
      lines.push_back(fmt::format("  in {}: {}", device, load));
  } else if (is(job, "paused")) {
    // One whose cancel is under way is not to be resumed.
    if (may(job, "resume"))
      lines.push_back(fmt::format("paused with the tool up: popcut resume {}", id));
  } else if (kind == "confirm_result") {
    lines.push_back(
        fmt::format("look at sheet {}: popcut confirm {} {} good   (or bad)", sheet, id, sheet));
  } else if (is(job, "ready") && !may(job, "arm") && may(job, "resume-from")) {
    lines.push_back(text);
    append(lines, resume_commands(job));
    lines.push_back(
        with_comment(fmt::format("popcut retry {} {}", id, sheet), "cut it again on a new sheet"));
  } else if (is(job, "ready") && may(job, "arm")) {
    append(lines, cure_commands(job));
    const std::int64_t blank = whole_of(job, "blank");
    if (whole_of(job, "segment") > 1 && kind == "load_sheet")
      lines.push_back(fmt::format("{}: popcut arm {} {}", text, id, sheet));
    else
      lines.push_back(fmt::format("load sheet {} of {}{}{}: popcut arm {} {}", sheet, total, into,
                                  blank > 1 ? fmt::format(", blank {}", blank) : "", id, sheet));
    const std::string load = load_text(job);
    if (!load.empty() && whole_of(job, "segment") <= 1) lines.push_back("  " + load);
  }
  if (is_held(job) && !has_ended(job)) lines.push_back(fmt::format("held: popcut release {}", id));
  const bool said =
      kind.empty() || kind == "load_sheet" || kind == "confirm_result" || text.empty();
  if (!said) lines.insert(lines.begin(), text);
  return lines;
}

std::vector<std::string> waiting_lines(const std::vector<std::string>& waits, std::size_t indent) {
  std::vector<std::string> lines;
  lines.reserve(waits.size());
  for (const std::string& wait : waits)
    lines.push_back(std::string(indent, ' ') + (wait.front() == ' ' ? "   " : "-> ") + wait);
  return lines;
}

std::vector<std::string> jobs_view(const std::vector<Json>& jobs, const ViewStyle& style) {
  std::vector<const Json*> order;
  for (const Json& job : jobs)
    if (job.is_object()) order.push_back(&job);
  std::stable_sort(order.begin(), order.end(),
                   [](const Json* a, const Json* b) { return rank(*a) < rank(*b); });
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < std::min(order.size(), kMostJobsShown); ++k) {
    for (std::string& line : view_line(*order[k], style.width)) lines.push_back(std::move(line));
    const bool narrow = style.width < 60;
    for (std::string& wait : waiting_lines(waiting_for(*order[k]), narrow ? 0 : 4)) {
      if (narrow) wait = without_comment(std::move(wait));
      for (const std::string& part : comment_apart(wait, style.width))
        for (const std::string& line : wrapped(part, style.width, narrow ? 2 : 7))
          lines.push_back(style.colour ? "\x1b[1m" + line + "\x1b[0m" : line);
    }
  }
  if (order.size() > kMostJobsShown)
    lines.push_back(fmt::format("and {} more", order.size() - kMostJobsShown));
  return lines;
}

std::vector<std::string> job_details(const Json& job, const std::vector<Json>& sheets,
                                     const std::optional<Json>& ledger, std::size_t width) {
  std::vector<std::string> lines;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) lines.push_back(fmt::format("{:<10} {}", key, value));
  };
  add("job", shown_of(job, "id"));
  add("name", shown_of(job, "name"));
  add("state", job_summary(job));
  add("material", shown_of(job, "material"));
  add("site", shown_of(job, "site"));
  if (!has_ended(job)) add("sheet", load_text(job));
  add("by hand", folding_text(job));
  if (const std::int64_t priority = whole_of(job, "priority"); priority != 0)
    add("priority", fmt::format("{}", priority));
  add("note", shown_of(job, "note"));
  add("design", shown_of(job, "design"));
  add("plan", shown_of(job, "plan"));
  add("owner", shown_of(job, "owner"));
  add("operator", shown_of(job, "operator"));
  add("created", shown_of(job, "created"));
  add("started", shown_of(job, "started"));
  add("finished", shown_of(job, "finished"));
  for (const Json& sheet : sheets) {
    const Json& plan = part_of(sheet, "plan");
    const auto number = [&](const char* key) {
      const auto found = plan.find(key);
      return found != plan.end() && found->is_number() ? found->get<double>() : 0.0;
    };
    lines.push_back(
        fmt::format("sheet {:<4} {:<12} {:.0f} paths, {:.0f} mm cut, {:.0f} mm of folds, about {}",
                    whole_of(sheet, "sheet"), sheet_state(job, sheet), number("paths"),
                    number("cut_mm"), number("fold_mm"), clock_text(number("seconds"))));
  }
  for (const std::string& warning : warning_lines(job)) add("warning", warning);
  if (ledger)
    for (const auto& [key, what] :
         {std::pair{"certain", "certainly cut"}, std::pair{"in_doubt", "in doubt"},
          std::pair{"not_sent", "not sent"}})
      if (const std::string ranges = ranges_of(*ledger, key); !ranges.empty())
        lines.push_back(fmt::format("paths {:<14} {}", what, ranges));
  // Commands stay in one line, to be copied.
  std::vector<std::string> waits = waiting_for(as_sent(job, ledger));
  // They stand above already.
  std::erase_if(waits, [](const std::string& wait) { return wait.starts_with(kWarning); });
  for (const std::string& wait : waiting_lines(waits, 0))
    for (std::string& part : comment_apart(wait, width)) lines.push_back(std::move(part));
  return lines;
}

std::string person_name(const std::string& principal) {
  constexpr std::string_view kUser = "uid:";
  if (principal.rfind(kUser, 0) != 0) return principal;
  uid_t number = 0;
  const char* const end = principal.data() + principal.size();
  const auto read = std::from_chars(principal.data() + kUser.size(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return principal;
  passwd entry{}, *found = nullptr;
  std::vector<char> room(16 * 1024);
  if (::getpwuid_r(number, &entry, room.data(), room.size(), &found) != 0 || found == nullptr)
    return principal;
  return std::string(found->pw_name) + " (" + principal + ")";
}

}  // namespace popcut::cli
