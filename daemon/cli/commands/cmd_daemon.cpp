// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/job_follow.hpp"
#include "daemon/client/api.hpp"
#include "daemon/store/restore.hpp"
#include "daemon/store/salvage.hpp"

namespace popcut::cli {
namespace daemon_command {
namespace {

using client::Api;
using Json = nlohmann::json;

// Events

constexpr std::int64_t kMostNumber = std::int64_t{1} << 40;  // as popcutd takes it

struct EventOptions {
  std::string job;
  std::optional<std::int64_t> after{};
  int limit{200};
  bool follow{false};
};

void print_event(const Json& event, const Globals& globals) {
  if (globals.json) return fmt::print("{}\n", json_line(event));
  Json rest = event;
  for (const char* key : {"seq", "time", "kind", "job", "state"}) rest.erase(key);
  fmt::print("{:>8}  {}  {:<8} {:<26} {:<12} {}\n",
             event.contains("seq") ? event["seq"].dump() : "", client::text_of(event, "time"),
             client::text_of(event, "kind"), client::text_of(event, "job"),
             client::text_of(event, "state"), rest.empty() ? "" : json_line(rest));
}

Result<void> follow_events(Api& api, const EventOptions& options, const Globals& globals) {
  const ViewEnd guard;
  if (auto there = api.get("/v1/meta", "events"); !there) return tl::unexpected(there.error());
  client::EventStream events(api.http(), "/v1/events");
  while (!ViewEnd::asked()) {
    const auto got = events.next(0.5);
    if (!got && got.error().kind != ErrorKind::DeviceGone) return tl::unexpected(got.error());
    if (!got) {
      ::usleep(500'000);
      continue;
    }
    for (const client::SseEvent& event : *got) {
      const auto parsed = parse_json(event.data, 32);
      Json json = parsed && parsed->is_object() ? *parsed : Json{{"data", event.data}};
      client::make_printable(json);
      if (!json.contains("kind")) json["kind"] = event.kind;
      if (options.job.empty() || json.value("job", Json()) == options.job)
        print_event(json, globals);
    }
    std::fflush(stdout);
  }
  return {};
}

/// Up to `limit` events after a number, or else those that came last, page by page.
Result<Json> wanted_events(Api& api, const EventOptions& options) {
  constexpr std::size_t kPage = 200;
  const auto limit = static_cast<std::size_t>(options.limit);
  const std::string base =
      options.job.empty() ? "/v1/events" : "/v1/jobs/" + options.job + "/events";
  std::int64_t after = options.after.value_or(0);
  if (!options.after && options.job.empty()) {
    const auto meta = api.get("/v1/meta", "events");
    if (!meta) return meta;
    const Json last = meta->value("last_event", Json(0));
    if (last.is_number_integer())
      after = std::max<std::int64_t>(0, last.get<std::int64_t>() - options.limit);
  }
  Json all{{"items", Json::array()}};
  Json& items = all["items"];
  while (true) {
    auto page = api.get(fmt::format("{}?after={}&limit={}", base, after, kPage), "events");
    if (!page) return page;
    const Json some = page->value("items", Json::array());
    for (const char* key : {"first_seq", "last_seq"}) all[key] = page->value(key, Json());
    for (const Json& event : some) {
      if (options.after && items.size() == limit) return all;
      items.push_back(event);
      if (items.size() > limit) items.erase(items.begin());
    }
    if (some.size() < kPage || !some.back().contains("seq")) return all;
    after = some.back()["seq"].get<std::int64_t>();
  }
}

Result<void> show_events(Api& api, EventOptions options, const Globals& globals) {
  if (!options.job.empty()) {
    const auto job = api.find_job(options.job);
    if (!job) return tl::unexpected(job.error());
    options.job = client::text_of(*job, "id");
  }
  if (options.follow) return follow_events(api, options, globals);
  const auto events = wanted_events(api, options);
  if (!events) return tl::unexpected(events.error());
  return answer(globals, *events, [&] {
    for (const Json& event : events->at("items")) print_event(event, globals);
    if (events->at("items").empty() && !globals.quiet)
      fmt::print(stderr, "no events{}\n", options.after ? " after that number" : "");
  });
}

constexpr const char* kEventsHelp =
    "List what happened in popcutd, event by event.\n\n"
    "  popcut events                         # the last 200 events\n"
    "  popcut events --follow                # new events as they happen; Ctrl-C stops it\n"
    "  popcut events --after 1200            # events after number 1200\n"
    "  popcut events --job 01JDX7 --json     # events of one job, as JSON";

void add_events(const Command& app, const Globals& globals, Run& run) {
  auto options = std::make_shared<EventOptions>();
  const Command command = app.add_command("events", kEventsHelp);
  whole_number(command.add_option("--after", options->after, "Only events after this number"), 0,
               kMostNumber)
      .value_text("SEQ");
  command.add_option("--job", options->job, "Only events of this job").value_text("JOB");
  whole_number(command.add_option("--limit", options->limit, "List at most this many events"), 1,
               1000)
      .value_text("N [200]");
  command.add_flag("--follow", options->follow, "Keep running and print new events");
  when_chosen(command, run, [options, &globals] {
    return with_popcutd([&](Api& api) { return show_events(api, *options, globals); });
  });
}

// Tokens

struct TokenOptions {
  std::string role, name, id;
  int days{0};
};

Result<void> create_token(const TokenOptions& options, const Globals& globals) {
  const auto ask = [&](Api& api) {
    Json body{{"name", options.name.empty() ? options.role : options.name}, {"role", options.role}};
    if (options.days > 0) body["lifetime_s"] = options.days * 86'400;
    api.http().set_tries(0);  // a second try would create a second token
    return api.post("/v1/tokens", body, "token");
  };
  return answer_of_popcutd(globals, ask, [&](const Json& token) {
    fmt::print("{}\n", client::text_of(token, "token"));
    if (!globals.quiet)
      fmt::print(stderr,
                 "popcut shows this token only once; set POPCUT_TOKEN to it (and POPCUT_URL for "
                 "popcutd on another computer)\n");
  });
}

/// Answers with a list of popcutd's: `tell(item)` prints a line for each item.
template <typename Tell>
Result<void> list_items(const char* target, const char* place, const Globals& globals,
                        const Tell& tell) {
  return answer_of_popcutd(
      globals, [&](Api& api) { return api.get(target, place); },
      [&](const Json& list) {
        if (!list.contains("items")) return;
        for (const Json& one : list["items"]) tell(one);
      });
}

Result<void> list_tokens(const Globals& globals) {
  return list_items("/v1/tokens", "tokens", globals, [](const Json& one) {
    const std::string expires = client::text_of(one, "expires");
    fmt::print("{}  {:<10} {:<24} created {}{}\n", client::text_of(one, "id"),
               client::text_of(one, "role"), shown_text(client::text_of(one, "name")),
               client::text_of(one, "created"), expires.empty() ? "" : ", expires " + expires);
  });
}

Result<void> list_sessions(const Globals& globals) {
  return list_items("/v1/sessions", "sessions", globals, [](const Json& one) {
    fmt::print("{}  {:<10} of {}, expires {}, ends {}\n", client::text_of(one, "id"),
               client::text_of(one, "role"), shown_text(client::text_of(one, "root")),
               client::text_of(one, "expires"), client::text_of(one, "ends"));
  });
}

/// A session, which needs no admin, or a token.
Result<void> delete_token(Api& api, const TokenOptions& options, const Globals& globals) {
  const std::string id = percent_encoded(options.id);
  auto gone = api.remove("/v1/sessions/" + id, "session " + options.id);
  if (!gone && gone.error().reason == ErrorReason::NotThere)
    gone = api.remove("/v1/tokens/" + id, "token " + options.id);
  if (!gone && gone.error().reason == ErrorReason::NotThere)
    return fail(gone.error().kind, gone.error().place,
                "there is no such token or session; 'popcut token list' and 'popcut token "
                "sessions' list them");
  if (gone && globals.json) print_json(Json{{"deleted", options.id}});
  return gone;
}

constexpr const char* kTokenHelp =
    "Manage access tokens for TCP; the unix socket needs none.\n\n"
    "  popcut token create --role operator --name workshop --days 30\n"
    "  popcut token list\n"
    "  popcut token sessions        # open pages, each with its token or user\n"
    "  popcut token delete 01JDX7KQ4M8ZB1Q2R3S4T5V6W7\n\n"
    "Roles: a viewer sees jobs. A submitter also queues designs. An operator also arms, starts "
    "and\n"
    "stops jobs. An admin may do everything.";

void add_token(const Command& app, const Globals& globals, Run& run) {
  auto options = std::make_shared<TokenOptions>();
  const Command command = app.add_command("token", kTokenHelp);
  command.needs_command(1, 1);
  const Command create =
      command.add_command("create", "Create a token and print it, once, on standard output");
  one_word(create.add_option("--role", options->role, "What the token allows"),
           {"viewer", "submitter", "operator", "admin"})
      .required();
  create.add_option("--name", options->name, "Who or what the token is for").value_text("TEXT");
  whole_number(create.add_option("--days", options->days, "Days until it expires"), 1, 3'660)
      .value_text("N [until deleted]");
  when_chosen(create, run, [options, &globals] { return create_token(*options, globals); });
  when_chosen(command.add_command("list", "List the tokens, without their secrets"), run,
              [&globals] { return list_tokens(globals); });
  when_chosen(command.add_command(
                  "sessions", "List the sessions of pages; each ends when its token or user does"),
              run, [&globals] { return list_sessions(globals); });
  const Command remove =
      command.add_command("delete", "Delete a token and its sessions, or end a session, at once");
  remove
      .add_option("ID", options->id,
                  "An ID that 'popcut token list' or 'popcut token sessions' shows")
      .required();
  when_chosen(remove, run, [options, &globals] {
    return with_popcutd([&](Api& api) { return delete_token(api, *options, globals); });
  });
}

// Usage

struct UsageOptions {
  std::string from, to, by{"owner"};
};

Result<void> show_usage(Api& api, const UsageOptions& options, const Globals& globals) {
  std::string target = "/v1/usage?by=" + options.by;
  if (!options.from.empty()) target += "&from=" + percent_encoded(options.from);
  if (!options.to.empty()) target += "&to=" + percent_encoded(options.to);
  if (globals.json) {
    const auto rows = api.get(target, "usage");
    if (!rows) return tl::unexpected(rows.error());
    print_json(*rows);
    return {};
  }
  const auto csv = api.get_text(target, "text/csv", "usage");
  if (!csv) return tl::unexpected(csv.error());
  fmt::print("{}", *csv);
  return {};
}

constexpr const char* kUsageHelp =
    "Print what was cut, as CSV: seconds of cutting, mm of cuts, sheets.\n\n"
    "  popcut usage --by owner --from 2026-11-01T00:00:00Z > november.csv";

void add_usage(const Command& app, const Globals& globals, Run& run) {
  auto options = std::make_shared<UsageOptions>();
  const Command command = app.add_command("usage", kUsageHelp);
  one_word(command.add_option("--by", options->by, "One row for each owner, device or material"),
           {"owner", "device", "material"}, "owner");
  command.add_option("--from", options->from, "Start of the period, as in 2026-11-01T00:00:00Z")
      .value_text("TIME");
  command.add_option("--to", options->to, "End of the period (exclusive)").value_text("TIME");
  when_chosen(command, run, [options, &globals] {
    return with_popcutd([&](Api& api) { return show_usage(api, *options, globals); });
  });
}

// The database

Result<void> database(const char* action, const Globals& globals) {
  const auto ask = [&](Api& api) {
    return api.post(fmt::format("/v1/db/actions/{}", action), Json::object(), "database");
  };
  return answer_of_popcutd(globals, ask, [](const Json& done) {
    for (const auto& [key, value] : done.items())
      fmt::print("{}: {}\n", key, value.is_string() ? value.get<std::string>() : json_line(value));
  });
}

Result<std::string> state_folder(const std::string& given) {
  std::string folder = given;
  if (folder.empty())
    folder = client::user_state_folder([](const char* name) { return std::getenv(name); });
  if (folder.empty())
    return fail(ErrorKind::Usage, "--state",
                "is missing; give the folder, as in --state /var/lib/popcut");
  return folder;
}

struct RestoreOptions {
  std::string copy, folder;
  bool older{false};
};

/// As `salvage_database`: popcutd must not run.
Result<void> restore_database(const RestoreOptions& options, const Globals& globals) {
  const auto folder = state_folder(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const auto done = daemon::restore(*folder, options.copy, options.older);
  if (!done) return fail(ErrorKind::Refused, "", message(done.error()));
  const Json document{{"jobs", done->copy.jobs},
                      {"last_event", done->copy.last_event},
                      {"original", done->original}};
  return answer(globals, document, [&] {
    if (globals.quiet) return;
    fmt::print("restored {}: {} jobs up to event {}\n", options.copy, done->copy.jobs,
               done->copy.last_event);
    if (!done->original.empty())
      fmt::print(stderr, "the database that was there is in {}\n", done->original);
    fmt::print(stderr, "start popcutd and check 'popcut jobs --all'\n");
  });
}

/// Opens the file itself, under the lock of the state folder: popcutd must not run.
Result<void> salvage_database(const std::string& given, const Globals& globals) {
  const auto folder = state_folder(given);
  if (!folder) return tl::unexpected(folder.error());
  const auto saved = daemon::salvage(*folder);
  if (!saved) return fail(ErrorKind::Refused, "", message(saved.error()));
  Json tables = Json::array();
  for (const auto& table : saved->tables) {
    tables.push_back({{"table", table.name},
                      {"rows", table.rows},
                      {"refused", table.refused},
                      {"whole", table.whole}});
    if (!globals.json && !globals.quiet)
      fmt::print("{:<14} {:>8} rows{}{}\n", table.name, table.rows,
                 table.refused > 0 ? fmt::format(", {} invalid", table.refused) : "",
                 table.whole ? "" : ", the rest is unreadable");
  }
  return answer(globals, Json{{"tables", tables}, {"original", saved->original}}, [&] {
    if (!globals.quiet)
      fmt::print(stderr,
                 "the damaged database is in {}; start popcutd and check 'popcut jobs --all'\n",
                 saved->original);
  });
}

constexpr const char* kDbHelp =
    "Back up, check or repair the database of popcutd.\n\n"
    "  popcut db backup       # copy it to popcutd's backup folder; print the path\n"
    "  popcut db check        # read every page and index\n"
    "  popcut db salvage      # if popcutd reports damage (exit code 78) and does not run: copy\n"
    "                         # what is readable to a new database; the damaged one is kept\n"
    "  popcut db restore /var/lib/popcut/backups/popcut-20261122T101500Z.db\n"
    "                         # put a copy in its place, while popcutd does not run";

void add_db(const Command& app, const Globals& globals, Run& run) {
  const Command command = app.add_command("db", kDbHelp);
  command.needs_command(1, 1);
  command
      .add_command("backup", "Copy the database while popcutd runs, and print the path of the copy")
      .on_choice([&globals, &run] { run = [&globals] { return database("backup", globals); }; });
  command.add_command("check", "Read the whole database and report damage")
      .on_choice([&globals, &run] { run = [&globals] { return database("check", globals); }; });
  auto folder = std::make_shared<std::string>();
  const Command salvage =
      command.add_command("salvage", "Copy what is readable of a damaged database to a new one");
  salvage.add_option("--state", *folder, "popcutd's state folder")
      .value_text("DIR [~/.local/state/popcut]");
  when_chosen(salvage, run, [folder, &globals] { return salvage_database(*folder, globals); });
  auto restoring = std::make_shared<RestoreOptions>();
  const Command restore =
      command.add_command("restore", "Replace the database by a copy, and keep the old one");
  restore.add_option("COPY", restoring->copy, "A copy that 'popcut db backup' made")
      .required()
      .value_text("COPY");
  restore.add_option("--state", restoring->folder, "popcutd's state folder")
      .value_text("DIR [~/.local/state/popcut]");
  restore.add_flag("--older", restoring->older,
                   "Restore even if the present database is whole and newer than the copy");
  when_chosen(restore, run,
              [restoring, &globals] { return restore_database(*restoring, globals); });
}

}  // namespace
}  // namespace daemon_command

void register_daemon(const Command& app, const Globals& globals, Run& run) {
  using namespace daemon_command;
  add_events(app, globals, run);
  add_token(app, globals, run);
  add_usage(app, globals, run);
  add_db(app, globals, run);
}

}  // namespace popcut::cli
