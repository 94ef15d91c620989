// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/design_repository.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"
#include "daemon/store/plan_table.hpp"

namespace popcut::daemon {
namespace {

// ?1 is a principal. If they own the row, it shows their name and time.
constexpr std::string_view kSelectDesign =
    "SELECT design.id, coalesce(own.name, design.name), design.kind, coalesce(own.owner, "
    "design.owner), bytes, coalesce(own.created, design.created), assets, media_type FROM design "
    "LEFT JOIN ownership AS own ON own.kind='design' AND own.id=design.id AND own.owner=?1 WHERE ";
// The material of a longer spec is not read; the request must name it.
constexpr std::uint64_t kSpecBytes = 1u << 20;
constexpr std::uint64_t kNewSpecBytes = 64u << 10;  // the same while a spec is being uploaded
constexpr std::size_t kMostKept = 1000;             // materials of designs, in memory
constexpr std::size_t kLongestMaterial = 200;       // bytes of a name, in a table of users, too
constexpr std::string_view kPreview = "preview.svg";

Design design_of(const Rows& rows) {
  Design design;
  rows.read(
      0, std::tie(design.id, design.name, design.kind, design.owner, design.bytes, design.created));
  design.assets = list_from_json(rows.text(6));
  design.is_new = false;
  return design;
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

const std::string* file_of(const PlanningOutcome& outcome, std::string_view name) {
  for (const PlanningFile& file : outcome.files)
    if (file.name == name) return &file.bytes;
  return nullptr;
}

// The names of assets anywhere in a file: "sha256-" and 64 digits.
std::set<std::string> digests_in(const std::string& path, std::uint64_t limit) {
  constexpr std::string_view kBegin = "sha256-";
  constexpr std::size_t kDigits = 64;
  std::set<std::string> all;
  const std::string text = read_whole(path, limit).value_or("");
  for (std::size_t at = text.find(kBegin); at != std::string::npos;
       at = text.find(kBegin, at + 1)) {
    const std::string name = text.substr(at, kBegin.size() + kDigits);
    const bool is_whole =
        name.size() == kBegin.size() + kDigits &&
        name.find_first_not_of("0123456789abcdef", kBegin.size()) == std::string::npos;
    if (is_whole) all.insert(name);
  }
  return all;
}

// Runs on a thread of the planner, because a preview is large and is synced to the disk. It is no
// fault if a preview is missing, because it can be drawn again, or if its design is missing,
// because the same bytes always give the same preview.
void keep_preview(Result<PlanningOutcome>& outcome, const std::string& place) {
  if (!outcome) return;
  if (const std::string* const preview = file_of(*outcome, kPreview))
    (void)write_file(place, *preview);
  outcome->files.clear();
  outcome->files.shrink_to_fit();
}

// The text at "/material" of a spec. The spec is not kept while it is read, because a hostile one
// may hold a million values. A name that is longer than any material's is cut, because names are
// kept in memory and repeated in errors.
std::string material_in(const std::string& text) {
  using Json = nlohmann::json;
  std::optional<std::string> found;
  bool is_next = false;
  const auto take = [&](int depth, Json::parse_event_t event, const Json& value) {
    const bool is_material = std::exchange(is_next, false);
    if (event == Json::parse_event_t::key)
      is_next = depth == 1 && value == "material";
    else if (event == Json::parse_event_t::value && is_material && !found && value.is_string())
      found = utf8_start(value.get_ref<const std::string&>(), kLongestMaterial);
    return event == Json::parse_event_t::object_start && depth == 0;
  };
  (void)Json::parse(text, take, false);
  return found.value_or("");
}

}  // namespace

Answer<void> check_text(const std::string& text, TextLimit limit, const std::string& pointer,
                        bool lines_allowed) {
  const auto wrong = [&](const char* code, std::string advice) {
    return refuse_value(pointer, code, std::move(advice), pointer + " is not valid");
  };
  if (code_points(text) > limit.characters)
    return wrong("range", fmt::format("must have at most {} characters", limit.characters));
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const bool c1 =
        c == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (lines_allowed && c == '\n') continue;
    if (c < 0x20 || c == 0x7F || c1) return wrong("format", "must not contain control characters");
  }
  return {};
}

std::optional<Design> DesignRepository::row(const std::string& id, std::string* media_type,
                                            const std::string& owner) {
  Rows rows = store_.db().rows(fmt::format("{}design.id=?2", kSelectDesign), owner, id);
  if (!rows.next()) return std::nullopt;
  if (media_type != nullptr) *media_type = rows.text(7);
  return design_of(rows);
}

bool DesignRepository::add_owner(const Principal& who, const Design& design,
                                 const std::string& name) {
  owners_.hold(Owned::Design, design.id);
  if (!owners_.add(Owned::Design, design.id, {who.name, name, store_.now()})) return false;
  for (const std::string& asset : design.assets)
    add_asset_owner(
        who, asset,
        first_of(store_.db().rows("SELECT name FROM asset WHERE id=?", asset), first_text)
            .value_or(""));
  return true;
}

// If `who` does not own the design and sent another media type, the bytes are checked like a new
// design.
Answer<std::optional<Design>> DesignRepository::known(const Principal& who, const Upload& upload,
                                                      const std::string& media_type,
                                                      const std::string& name) {
  const std::string id = "sha256-" + upload.sha256;
  using Known = Answer<std::optional<Design>>;
  std::string type;
  const Answer<std::optional<Design>> there =
      store_.read([&]() -> Known { return row(id, &type, who.name); });
  if (!there || !*there) return there;
  if (store_
          .read([&]() -> Known {
            return owners_.has(Owned::Design, id, who.name) ? *there : std::nullopt;
          })
          .value_or(std::nullopt))
    return there;
  if (type != media_type) return std::nullopt;
  return store_.change([&]() -> Known {
    const std::optional<Design> design = row(id);
    if (!design) return std::nullopt;
    const bool is_new = add_owner(who, *design, name);
    if (is_new) store_.audit(who.name, "add-design", id, name);
    if (is_new) store_.emit("notice", "", JsonObject().text("design", id).text("what", "added"));
    std::optional<Design> owned = row(id, nullptr, who.name);
    owned->is_new = is_new;
    return owned;
  });
}

void DesignRepository::add(const Principal& who, Upload upload, std::string media_type,
                           std::string name, Added done) {
  const auto give_up = [&](Problem problem) {
    remove_tree(upload.path);
    done(tl::unexpected(std::move(problem)));
  };
  if (who.role < Role::Submitter)
    return give_up({ProblemKind::Forbidden, "uploading a design requires the role submitter"});
  if (const auto fine = check_text(name, kNameLimit, "?name"); !fine) return give_up(fine.error());
  if (const auto room = store_.accepts_work(); !room) return give_up(room.error());
  const Answer<std::optional<Design>> before = known(who, upload, media_type, name);
  if (!before) return give_up(before.error());
  if (before->has_value()) {
    remove_tree(upload.path);
    return done(**before);
  }
  // Its assets may have been uploaded at another node.
  if (store_.in_fleet() && upload.bytes <= kNewSpecBytes)
    for (const std::string& asset : digests_in(upload.path, kNewSpecBytes))
      if (const auto here = store_.fetch_file("assets/" + asset); !here)
        return give_up(here.error());
  PlanningTask task;
  task.kind = PlanningTask::Kind::Check;
  task.who = who.name;
  task.design_path = upload.path;
  task.media_type = media_type;
  task.assets_folder = store_.folder().at("assets");
  if (media_type.find("json") != std::string::npos && upload.bytes <= kNewSpecBytes)
    task.material_json =
        row_of_material(material_in(read_whole(upload.path, kNewSpecBytes).value_or("")));
  const std::string preview = store_.folder().at("previews/sha256-" + upload.sha256 + ".svg");
  planner_.start(
      std::move(task), [this, post = post_, files = &store_.files(), who, upload, media_type, name,
                        preview, done = std::move(done)](Result<PlanningOutcome> outcome) {
        keep_preview(outcome, preview);
        // Share the file before the design has a row, so that each node that sees the design can
        // fetch it.
        if (outcome)
          if (const Result<void> kept = files->keep("designs/sha256-" + upload.sha256, upload.path);
              !kept)
            outcome = tl::unexpected(kept.error());
        post([this, who, upload, media_type, name, done,
              held = std::make_shared<Result<PlanningOutcome>>(std::move(outcome))] {
          upload_checked(who, upload, media_type, name, std::move(*held), done);
        });
      });
}

void DesignRepository::upload_checked(const Principal& who, const Upload& upload,
                                      const std::string& media_type, const std::string& name,
                                      Result<PlanningOutcome> outcome, const Added& done) {
  name_turn("design checked");
  if (!outcome) {
    remove_tree(upload.path);
    return done(tl::unexpected(problem_from(outcome.error())));
  }
  Answer<Design> design = store(who, upload, media_type, name, *outcome);
  remove_tree(upload.path);
  done(std::move(design));
}

Answer<Design> DesignRepository::store(const Principal& who, const Upload& upload,
                                       const std::string& media_type, const std::string& name,
                                       const PlanningOutcome& outcome) {
  const std::string id = "sha256-" + upload.sha256;
  return store_.change([&]() -> Answer<Design> {
    // Another upload of the same bytes may have been faster.
    if (const auto before = row(id)) {
      const bool is_new = add_owner(who, *before, name);
      Design owned = *row(id, nullptr, who.name);
      owned.is_new = is_new;
      return owned;
    }
    if (const auto there = check_assets(outcome.assets); !there)
      return tl::unexpected(there.error());
    Design design{.id = id,
                  .name = name,
                  .kind = outcome.design_kind,
                  .owner = who.name,
                  .bytes = upload.bytes,
                  .created = store_.now(),
                  .assets = outcome.assets};
    const std::string place = store_.folder().at("designs/" + id);
    if (!exists(upload.path) && exists(place)) {
      // The transaction runs a second time: the first one moved the file.
    } else if (const Result<void> kept = keep_file(upload.path, place); !kept) {
      return tl::unexpected(store_.file_problem(kept.error()));
    }
    store_.db().insert("design(id, name, kind, owner, bytes, created, assets, media_type)", id,
                       name, design.kind, design.owner, design.bytes, design.created,
                       json_list(design.assets), media_type);
    add_owner(who, design, name);
    store_.audit(who.name, "add-design", id, name);
    store_.emit("notice", "", JsonObject().text("design", id).text("what", "added"));
    return design;
  });
}

Answer<Asset> DesignRepository::add_asset(const Principal& who, const Upload& upload) {
  const std::string id = "sha256-" + upload.sha256;
  Answer<Asset> added = store_.change([&]() -> Answer<Asset> {
    if (who.role < Role::Submitter)
      return refuse(ProblemKind::Forbidden, "uploading an asset requires the role submitter");
    if (const auto fine = check_text(upload.name, kNameLimit, "?name"); !fine)
      return tl::unexpected(fine.error());
    owners_.hold(Owned::Asset, id);
    if (asset_row(id, who.name)) {
      const bool is_new = add_asset_owner(who, id, upload.name);
      if (is_new) store_.audit(who.name, "add-asset", id, "");
      Asset owned = *asset_row(id, who.name);
      owned.is_new = is_new;
      return owned;
    }
    if (const auto room = store_.accepts_work(); !room) return tl::unexpected(room.error());
    const std::string place = store_.folder().at("assets/" + id);
    if (!exists(upload.path) && exists(place)) {
      // The transaction runs a second time: the first one moved the file.
    } else if (const Result<void> kept = keep_file(upload.path, place); !kept) {
      return tl::unexpected(store_.file_problem(kept.error()));
    }
    const Asset asset{.id = id,
                      .name = upload.name,
                      .owner = who.name,
                      .bytes = upload.bytes,
                      .created = store_.now()};
    store_.db().insert("asset(id, bytes, created, name, owner)", id, asset.bytes, asset.created,
                       asset.name, asset.owner);
    add_asset_owner(who, id, asset.name);
    if (!store_.files().keep_small("assets/" + id))
      store_.after_commit([this, id] {
        side_thread_.run([files = &store_.files(), id] { (void)files->keep("assets/" + id); });
      });
    store_.audit(who.name, "add-asset", id, "");
    return asset;
  });
  remove_tree(upload.path);
  return added;
}

Page<Design> DesignRepository::list(const Principal& who, const PageRequest& request) {
  Page<Design> page;
  page.items = all_of(
      store_.db().rows(fmt::format("{}design.id>?2 ORDER BY design.id LIMIT ?3", kSelectDesign),
                       who.name, request.cursor, request.limit + 1),
      design_of);
  if (page.items.size() > static_cast<std::size_t>(request.limit)) {
    page.items.pop_back();
    page.next_cursor = page.items.back().id;
  }
  return page;
}

Answer<Design> DesignRepository::find(const Principal& who, const std::string& id) {
  return store_.read([&]() -> Answer<Design> {
    if (const auto found = row(id, nullptr, who.name)) return *found;
    return refuse(ProblemKind::NotFound, fmt::format("there is no design {:?}", id));
  });
}

Answer<Design> DesignRepository::find(const std::string& id) { return find(Principal{}, id); }

Answer<std::string> DesignRepository::content(const std::string& id) {
  const Answer<Design> design = find_and_fetch(id);
  if (!design) return tl::unexpected(design.error());
  return store_.folder().at("designs/" + design->id);
}

Answer<Design> DesignRepository::find_and_fetch(const std::string& id) {
  Answer<Design> design = find(id);
  if (!design) return design;
  if (const auto brought = store_.fetch_file("designs/" + id); !brought)
    return tl::unexpected(brought.error());
  for (const std::string& asset : design->assets)
    if (const auto brought = store_.fetch_file("assets/" + asset); !brought)
      return tl::unexpected(brought.error());
  return design;
}

Answer<void> DesignRepository::check_jobs(const std::string& design, const std::string& owner) {
  const auto used =
      first_of(store_.db().rows(
                   "SELECT id FROM job WHERE design=?1 AND (owner=?2 OR ?2='') AND state NOT IN "
                   "('done', 'failed', 'cancelled') LIMIT 1",
                   design, owner),
               first_text);
  if (!used) return {};
  return refuse(ProblemKind::StateConflict,
                fmt::format("job {} uses this design; finish or cancel the job first", *used));
}

Answer<void> DesignRepository::remove(const Principal& who, const std::string& id) {
  return store_.change([&]() -> Answer<void> {
    owners_.hold(Owned::Design, id);
    const Answer<Design> design = find(who, id);
    if (!design) return tl::unexpected(design.error());
    const bool is_mine = owners_.has(Owned::Design, id, who.name);
    if (!is_mine && who.role < Role::Operator)
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's design");
    if (const auto free = check_jobs(id, is_mine ? who.name : ""); !free) return free;
    if (is_mine)
      owners_.remove(Owned::Design, id, who.name);
    else
      owners_.remove_all(Owned::Design, id);
    if (const auto other = owners_.first(Owned::Design, id)) {
      store_.db().run("UPDATE design SET owner=?, name=?, created=? WHERE id=?", other->owner,
                      other->name, other->created, id);
    } else {
      if (const auto free = check_jobs(id, ""); !free) return free;
      delete_design(id);
    }
    store_.audit(who.name, "delete-design", id, design->name);
    if (owner_removed) owner_removed(id);
    return {};
  });
}

void DesignRepository::delete_design(const std::string& id) {
  store_.db().run("DELETE FROM design WHERE id=?", id);
  store_.files().forget("designs/" + id);
  store_.after_commit([this, id] {
    side_thread_.remove(store_.folder().at("designs/" + id));
    side_thread_.remove(store_.folder().at("previews/" + id + ".svg"));
    for (const char* const name : kPictures) side_thread_.remove(picture_path(id, name));
  });
}

PlanningTask DesignRepository::task_for(const Design& design, PlanningTask::Kind kind) {
  PlanningTask task;
  task.kind = kind;
  task.design_path = store_.folder().at("designs/" + design.id);
  task.design_kind = design.kind;
  (void)row(design.id, &task.media_type);
  if (design.kind == "spec") task.material_json = row_of_material(material_in_spec(design));
  // The planner reports a missing asset, with its place in the spec.
  for (const std::string& asset : design.assets)
    if (std::string place = store_.folder().at("assets/" + asset); exists(place))
      task.asset_paths[asset] = std::move(place);
  return task;
}

std::string DesignRepository::material_in_spec(const Design& design) {
  if (design.kind != "spec" || design.bytes > kSpecBytes) return {};
  if (const auto known = materials_.find(design.id); known != materials_.end())
    return known->second;
  if (materials_.size() >= kMostKept) materials_.clear();
  const auto text = read_whole(store_.folder().at("designs/" + design.id), kSpecBytes);
  if (!text) return {};  // it may be readable the next time
  return materials_[design.id] = material_in(*text);
}

std::string DesignRepository::row_of_material(const std::string& name) const {
  return material_row ? material_row(name) : std::string();
}

void DesignRepository::preview(const Principal& who, const std::string& id,
                               std::function<void(Answer<std::string>)> done) {
  const Answer<Design> design = find_and_fetch(id);
  if (!design) return done(tl::unexpected(design.error()));
  const std::string place = store_.folder().at("previews/" + id + ".svg");
  std::error_code ignored;
  if (const auto bytes = std::filesystem::file_size(place, ignored); !ignored && bytes > 0) {
    return read_on_side_thread(place, std::move(done));
  }
  PlanningTask task = task_for(*design, PlanningTask::Kind::Check);
  task.who = who.name;
  planner_.start(std::move(task), [post = post_, place,
                                   done = std::move(done)](Result<PlanningOutcome> outcome) {
    Answer<std::string> svg = refuse(ProblemKind::NotFound, "this design has no preview");
    if (!outcome)
      svg = tl::unexpected(problem_from(outcome.error()));
    else if (const std::string* bytes = file_of(*outcome, kPreview))
      svg = *bytes;
    if (svg) (void)write_file(place, *svg);
    post([svg = std::move(svg), done]() mutable { done(std::move(svg)); });
  });
}

}  // namespace popcut::daemon
