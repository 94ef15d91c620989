// SPDX-License-Identifier: MIT
#include "daemon/http/api/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <type_traits>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/model/fields.hpp"
#include "daemon/model/found_card_json.hpp"
#include "daemon/model/warnings.hpp"

namespace popcut::daemon::http {
namespace {

using nlohmann::ordered_json;

ordered_json text_or_null(const std::string& text) {
  return text.empty() ? ordered_json(nullptr) : ordered_json(text);
}

ordered_json time_or_null(const std::optional<TimeMs>& time) {
  return time ? ordered_json(rfc3339(*time)) : ordered_json(nullptr);
}

ordered_json ranges(const std::vector<PathRange>& all) {
  ordered_json out = ordered_json::array();
  for (const PathRange& range : all) out.push_back({range.first, range.last});
  return out;
}

JsonObject request_body(const ActionRequest& body) {
  JsonObject out;
  if (body.sheet) out.number("sheet", *body.sheet);
  if (body.blank) out.number("blank", *body.blank);
  if (!body.device.empty()) out.text("device", body.device);
  if (body.good) out.flag("good", *body.good);
  if (body.from_path) out.number("from_path", *body.from_path);
  if (!body.registration.empty()) out.text("registration", body.registration);
  if (body.skip_in_doubt) out.flag("skip_in_doubt", true);
  if (body.accept_double_cut) out.flag("i_accept_double_cut", true);
  if (!body.accept_warnings.empty()) out.texts("accept_warnings", body.accept_warnings);
  return out;
}

JsonObject request_body(const JobPatch& body) {
  JsonObject out;
  if (body.device) out.text("device", *body.device);
  if (body.site) out.text("site", *body.site);
  if (body.plan_again) out.flag("plan_again", true);
  return out;
}

JsonObject request_body(const QueueRequest& body) { return JsonObject().text("job", body.job); }

// A value as a member of JSON, by its type.
class MemberWriter {
 public:
  MemberWriter(JsonObject& out, FieldUse use) : out_(out), use_(use) {}
  void put(std::string_view name, const std::string& text) { out_.text_or_null(name, text); }
  void put(std::string_view name, int value) { put(name, std::int64_t{value}); }
  void put(std::string_view name, std::int64_t value) {
    if (use_.is_time)
      out_.text(name, rfc3339(value));
    else if (use_.zero_is_null && value == 0)
      out_.null(name);
    else
      out_.number(name, value);
  }
  void put(std::string_view name, double value) { out_.number(name, value); }
  void put(std::string_view name, bool value) { out_.flag(name, value); }
  void put(std::string_view name, const std::array<double, 2>& pair) { out_.pair(name, pair); }
  void put(std::string_view name, const std::optional<TimeMs>& time) {
    out_.text_or_null(name, time ? rfc3339(*time) : std::string());
  }
  void put(std::string_view name, JobState state) { out_.text(name, name_of(state)); }
  void put(std::string_view name, const std::vector<std::string>& texts) {
    out_.texts(name, texts);
  }
  void put(std::string_view name, const std::vector<Warning>& all) { out_.warnings(name, all); }
  // Only of a job that was asked for alone.
  void put(std::string_view name, const std::vector<NextAction>& all) {
    if (!all.empty()) out_.objects(name, json_of(all));
  }
  template <typename Value>
  void put(std::string_view name, const std::optional<Value>& value) {
    if (value)
      put(name, *value);
    else
      out_.null(name);
  }
  template <typename Value>
  void put(std::string_view name, const Value& value);

 private:
  JsonObject& out_;
  FieldUse use_;
};

// All fields that the API shows, in its order.
template <typename Value>
JsonObject object_of(const Value& value) {
  JsonObject out;
  list_fields(&value, [&](std::string_view name, auto member, FieldUse use = {}) {
    if (!use.is_hidden) MemberWriter(out, use).put(name, value.*member);
  });
  return out;
}

template <typename Value>
void MemberWriter::put(std::string_view name, const Value& value) {
  out_.object(name, object_of(value));
}

JsonObject links_of(const Job& job) {
  const std::string self = "/v1/jobs/" + job.id;
  JsonObject out;
  out.text("self", self);
  out.text("sheets", self + "/sheets");
  out.text("events", self + "/events");
  out.text_or_null("design", job.design.empty() ? "" : "/v1/designs/" + job.design);
  out.text_or_null("plan", job.plan.empty() ? "" : "/v1/plans/" + job.plan);
  return out;
}

}  // namespace

std::string rfc3339(TimeMs time) {
  std::int64_t ms = time % 1000;
  std::int64_t seconds = time / 1000;
  if (ms < 0) ms += 1000, --seconds;
  const std::time_t clock = seconds;
  std::tm utc{};
  if (gmtime_r(&clock, &utc) == nullptr) return "1970-01-01T00:00:00.000Z";
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900,
                     utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, ms);
}

ordered_json to_json(const Asset& asset) {
  return {{"id", asset.id},
          {"name", asset.name},
          {"owner", text_or_null(asset.owner)},
          {"bytes", asset.bytes},
          {"created", rfc3339(asset.created)}};
}

ordered_json listed_json(const Asset& asset) {
  ordered_json out = to_json(asset);
  out["designs"] = asset.designs;
  out["designs_total"] = asset.designs_total;
  return out;
}

ordered_json to_json(const Design& design) {
  const std::string self = "/v1/designs/" + design.id;
  return {{"id", design.id},
          {"name", design.name},
          {"kind", design.kind},
          {"owner", text_or_null(design.owner)},
          {"bytes", design.bytes},
          {"created", rfc3339(design.created)},
          {"assets", design.assets},
          {"links",
           {{"self", self}, {"content", self + "/content"}, {"preview", self + "/preview.svg"}}}};
}

ordered_json to_json(const SheetPlan& sheet) {
  ordered_json out;
  list_fields(&sheet,
              [&]<typename Member>(const char* name, Member SheetPlan::*member, FieldUse use = {}) {
                if (use.is_hidden) return;
                if constexpr (std::is_same_v<Member, std::string>)
                  out[name] = text_or_null(sheet.*member);
                else
                  out[name] = sheet.*member;
              });
  return out;
}

namespace {

ordered_json handwork_json(const Handwork& work) {
  ordered_json out;
  list_fields(&work, [&](const char* name, auto member) { out[name] = work.*member; });
  return out;
}

}  // namespace

ordered_json to_json(const PlanRecord& plan) {
  ordered_json sheets = ordered_json::array();
  for (const SheetPlan& sheet : plan.sheets) sheets.push_back(to_json(sheet));
  return {{"id", plan.id},
          {"design", plan.design},
          {"material", text_or_null(plan.material)},
          {"machine", text_or_null(plan.machine)},
          {"state", name_of(plan.state)},
          {"sha256", text_or_null(plan.sha256)},
          {"sheets", std::move(sheets)},
          {"sheets_total", plan.sheets_total},
          {"paths", plan.paths},
          {"length_mm", plan.length_mm},
          {"est_s", plan.est_s},
          {"handwork", plan.handwork ? handwork_json(*plan.handwork) : ordered_json()},
          {"warnings", ordered_json::parse(warnings_json(plan.warnings), nullptr, false)},
          {"error", text_or_null(plan.error)},
          {"created", rfc3339(plan.created)},
          {"links", {{"self", "/v1/plans/" + plan.id}, {"design", "/v1/designs/" + plan.design}}}};
}

namespace {

constexpr std::array<std::string_view, 3> kSearchStates{"pending", "found", "failed"};

ordered_json card_json(const FoundCardRecord& card, std::size_t number, const std::string& self) {
  const std::string own = fmt::format("{}/cards/{}", self, number);
  ordered_json out{{"card", number}};
  out.update(figures_json(card));
  if (!card.page_mm) out["page_mm"] = nullptr;
  out["tabs"] = card.tabs;
  out["warnings"] = ordered_json::parse(warnings_json(card.warnings), nullptr, false);
  out["spec"] = ordered_json::parse(card.spec, nullptr, false);
  out["links"] = {
      {"picture", own + ".png"}, {"lattice", own + "/lattice"}, {"design", own + "/design"}};
  return out;
}

}  // namespace

ordered_json listed_json(const SearchRecord& search) {
  return {{"id", search.id},
          {"model", search.request.model},
          {"name", search.request.name},
          {"owner", text_or_null(search.owner)},
          {"state", kSearchStates[static_cast<std::size_t>(search.state)]},
          {"machine", text_or_null(search.request.machine)},
          {"material", text_or_null(search.request.material)},
          {"error", text_or_null(search.error)},
          {"created", rfc3339(search.created)},
          {"links", {{"self", "/v1/searches/" + search.id}}}};
}

ordered_json to_json(const SearchRecord& search) {
  const std::string self = "/v1/searches/" + search.id;
  const CardSearchRequest& request = search.request;
  const SearchFront& front = search.front;
  ordered_json cards = ordered_json::array();
  for (const FoundCardRecord& card : front.cards)
    cards.push_back(card_json(card, cards.size() + 1, self));
  ordered_json progress;
  if (!search.doing.empty())
    progress = {{"doing", search.doing},
                {"share", search.share ? ordered_json(*search.share) : ordered_json(nullptr)}};
  ordered_json tried;
  if (search.state == SearchState::Found)
    tried = {{"designed", front.designed},
             {"planned", front.planned},
             {"verified", front.verified},
             {"mat_mm", front.mat_mm},
             {"seen_share", front.seen_share}};
  return {{"id", search.id},
          {"model", request.model},
          {"name", request.name},
          {"owner", text_or_null(search.owner)},
          {"state", kSearchStates[static_cast<std::size_t>(search.state)]},
          {"machine", text_or_null(request.machine)},
          {"material", text_or_null(request.material)},
          {"mat", text_or_null(request.mat)},
          {"max_minutes", request.max_minutes},
          {"style", request.style},
          {"up", request.up},
          {"front", request.front},
          {"marks", request.marks},
          {"book", request.cards > 1 ? ordered_json{{"cards", request.cards}} : ordered_json()},
          {"max_folds", request.max_folds > 0 ? ordered_json(request.max_folds) : ordered_json()},
          {"min_fold_mm", request.min_fold_mm},
          {"label", request.label},
          {"plain", request.plain},
          {"effort", request.effort},
          {"seed", request.seed},
          {"progress", std::move(progress)},
          {"cards", std::move(cards)},
          {"recommended", front.recommended > 0 ? ordered_json(front.recommended) : ordered_json()},
          {"better_front", text_or_null(front.better_front)},
          {"tried", std::move(tried)},
          {"notes", front.notes},
          {"error", text_or_null(search.error)},
          {"created", rfc3339(search.created)},
          {"links", {{"self", self}}}};
}

JsonObject body_of(const NextAction& action) {
  return std::visit([](const auto& body) { return request_body(body); }, action.body);
}

JsonObject json_of(const NextAction& action) {
  JsonObject out;
  out.text("action", action.action);
  out.object("body", body_of(action));
  if (!action.device.empty()) out.text("device", action.device);
  if (!action.job.empty()) out.text("job", action.job);
  return out;
}

std::vector<JsonObject> json_of(const std::vector<NextAction>& actions) {
  std::vector<JsonObject> all;
  all.reserve(actions.size());
  for (const NextAction& action : actions) all.push_back(json_of(action));
  return all;
}

std::string job_text(const Job& job) {
  return object_of(job).object("links", links_of(job)).whole();
}

ordered_json to_json(const SheetRecord& sheet) {
  return {{"sheet", sheet.number},
          {"copy", sheet.copy},
          {"blank", sheet.blank},
          {"segment", sheet.segment},
          {"state", sheet.state},
          {"plan", to_json(sheet.plan)},
          {"started", time_or_null(sheet.started)},
          {"finished", time_or_null(sheet.finished)}};
}

ordered_json to_json(const Ledger& ledger) {
  ordered_json attempts = ordered_json::array();
  for (const Attempt& attempt : ledger.attempts)
    attempts.push_back({{"id", attempt.id},
                        {"blank", attempt.blank},
                        {"segment", attempt.segment},
                        {"started", rfc3339(attempt.started)},
                        {"ended", time_or_null(attempt.ended)},
                        {"end_kind", text_or_null(attempt.end_kind)},
                        {"operator", text_or_null(attempt.operator_name)},
                        {"bytes_taken", attempt.bytes_taken}});
  return {{"sheet", ledger.sheet},
          {"blank", ledger.blank},
          {"segment", ledger.segment},
          {"certain_upto", ledger.certain_upto},
          {"certain", ranges(ledger.certain)},
          {"in_doubt", ranges(ledger.in_doubt)},
          {"not_sent", ranges(ledger.not_sent)},
          {"last_status", text_or_null(ledger.last_status)},
          {"attempts", std::move(attempts)}};
}

ordered_json to_json(const DeviceRecord& device) {
  ordered_json out{{"id", device.id},
                   {"rev", device.rev},
                   {"model", device.model},
                   {"title", device.title},
                   {"state", device.state},
                   {"reasons", device.reasons},
                   {"enabled", device.enabled},
                   {"simulated", device.simulated},
                   {"machine", text_or_null(device.machine)},
                   {"materials", device.materials},
                   {"width_mm", device.width_mm},
                   {"length_mm", device.length_mm},
                   {"firmware", text_or_null(device.firmware)},
                   {"job", text_or_null(device.job)},
                   {"sheets_done", device.sheets_done},
                   {"cut_mm", device.cut_mm}};
  if (!device.test_job.empty()) out["test_job"] = device.test_job;
  if (!device.node.empty()) out["node"] = device.node;
  if (!device.node_url.empty()) out["node_url"] = device.node_url;
  if (!device.site.empty()) out["site"] = device.site;
  return out;
}

ordered_json to_json(const MaterialRecord& material) {
  ordered_json row = ordered_json::parse(material.json, nullptr, false);
  return {{"id", material.id},
          {"rev", material.rev},
          {"built_in", material.built_in},
          {"material", row.is_discarded() ? ordered_json(nullptr) : std::move(row)}};
}

ordered_json to_json(const TokenRecord& token) {
  return {{"id", token.id},
          {"name", token.name},
          {"role", name_of(token.role)},
          {"created", rfc3339(token.created)},
          {"expires", time_or_null(token.expires)}};
}

ordered_json to_json(const SessionRecord& session) {
  return {{"id", session.id},
          {"root", session.root},
          {"via", text_or_null(session.via)},
          {"name", text_or_null(session.name)},
          {"role", name_of(session.role)},
          {"created", rfc3339(session.created)},
          {"expires", rfc3339(session.expires)},
          {"ends", rfc3339(session.ends)}};
}

ordered_json to_json(const NewToken& token) {
  ordered_json out = to_json(token.record);
  out["token"] = token.text;
  return out;
}

ordered_json to_json(const UsageRow& row) {
  return {
      {"key", row.key}, {"seconds", row.seconds}, {"cut_mm", row.cut_mm}, {"sheets", row.sheets}};
}

std::string event_json(const Event& event) {
  const std::string time = fmt::format("\"time\":\"{}\"}}", rfc3339(event.time));
  // "{...}" of the service: its last bracket makes place for the time.
  if (event.data.size() > 2 && event.data.back() == '}')
    return fmt::format("{},{}", std::string_view(event.data).substr(0, event.data.size() - 1),
                       time);
  const ordered_json head{{"seq", event.seq}, {"kind", event.kind}};
  std::string out = dump(head);
  out.back() = ',';
  return out + time;
}

std::string usage_csv(const std::vector<UsageRow>& rows, const std::string& by) {
  std::string out = fmt::format("{},seconds,cut_mm,sheets\r\n", by);
  for (const UsageRow& row : rows) {
    std::string key;
    // A cell that starts so is a formula to spreadsheets.
    if (!row.key.empty() && std::string_view("=+-@\t\r").find(row.key[0]) != std::string_view::npos)
      key += '\'';
    for (const char c : row.key) key += c == '"' ? std::string("\"\"") : std::string(1, c);
    out += fmt::format("\"{}\",{:.3f},{:.3f},{}\r\n", key, row.seconds, row.cut_mm, row.sheets);
  }
  return out;
}

std::string dump(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace popcut::daemon::http
