// SPDX-License-Identifier: MIT
// Part of daemon/service/repositories/design_repository.hpp: the list of assets, and their removal.
#include <fmt/format.h>

#include "daemon/service/repositories/design_repository.hpp"

namespace popcut::daemon {
namespace {

constexpr int kNamedDesigns = 5;
// ?1 is a principal. If they own the row, it shows their name and time.
constexpr std::string_view kSelectAsset =
    "SELECT asset.id, coalesce(own.name, asset.name), coalesce(own.owner, asset.owner), bytes, "
    "coalesce(own.created, asset.created) FROM asset LEFT JOIN ownership AS own ON "
    "own.kind='asset' AND own.id=asset.id AND own.owner=?1 WHERE ";

Asset asset_of(const Rows& rows) {
  Asset asset{.is_new = false};
  rows.read(0, std::tie(asset.id, asset.name, asset.owner, asset.bytes, asset.created));
  return asset;
}

}  // namespace

DesignRepository::Referring DesignRepository::designs_with(const std::string& asset,
                                                           const std::string& owner) {
  return {
      all_of(store_.db().rows(
                 "SELECT design FROM asset_use WHERE asset=?1 AND (?2='' OR EXISTS (SELECT 1 FROM "
                 "ownership AS own WHERE own.kind='design' AND own.id=asset_use.design AND "
                 "own.owner=?2)) ORDER BY design LIMIT ?3",
                 asset, owner, kNamedDesigns),
             first_text),
      store_.db().number(
          "SELECT count(*) FROM asset_use WHERE asset=?1 AND (?2='' OR EXISTS (SELECT 1 FROM "
          "ownership AS own WHERE own.kind='design' AND own.id=asset_use.design AND own.owner=?2))",
          asset, owner)};
}

Page<Asset> DesignRepository::assets(const Principal& who, const PageRequest& request) {
  Page<Asset> page;
  page.items =
      all_of(store_.db().rows(fmt::format("{}asset.id>?2 ORDER BY asset.id LIMIT ?3", kSelectAsset),
                              who.name, request.cursor, request.limit + 1),
             asset_of);
  if (page.items.size() > static_cast<std::size_t>(request.limit)) {
    page.items.pop_back();
    page.next_cursor = page.items.back().id;
  }
  for (Asset& asset : page.items) {
    Referring designs = designs_with(asset.id);
    asset.designs = std::move(designs.some);
    asset.designs_total = designs.all;
  }
  return page;
}

std::optional<Asset> DesignRepository::asset_row(const std::string& id, const std::string& owner) {
  return first_of(store_.db().rows(fmt::format("{}asset.id=?2", kSelectAsset), owner, id),
                  asset_of);
}

bool DesignRepository::add_asset_owner(const Principal& who, const std::string& id,
                                       const std::string& name) {
  owners_.hold(Owned::Asset, id);
  return owners_.add(Owned::Asset, id, {who.name, name, store_.now()});
}

Answer<void> DesignRepository::check_assets(const std::vector<std::string>& assets) {
  for (const std::string& asset : assets)
    if (store_.db().number("SELECT EXISTS(SELECT 1 FROM asset WHERE id=?)", asset) == 0)
      return refuse(
          ProblemKind::Validation,
          fmt::format("the asset {} was removed meanwhile; upload it to /v1/assets again, "
                      "then the design",
                      asset));
  return {};
}

Answer<std::string> DesignRepository::asset_path(const std::string& id) {
  if (store_.db().number("SELECT EXISTS(SELECT 1 FROM asset WHERE id=?)", id) == 0)
    return refuse(ProblemKind::NotFound, fmt::format("there is no asset {:?}", id));
  if (const auto brought = store_.fetch_file("assets/" + id); !brought)
    return tl::unexpected(brought.error());
  return store_.folder().at("assets/" + id);
}

Answer<void> DesignRepository::check_designs(const std::string& asset, const std::string& owner) {
  const Referring designs = designs_with(asset, owner);
  if (designs.some.empty()) return {};
  const bool one = designs.all == 1;
  std::string which = fmt::format("{}", fmt::join(designs.some, ", "));
  if (designs.all > kNamedDesigns)
    which += fmt::format(" and {} more", designs.all - kNamedDesigns);
  return refuse(ProblemKind::StateConflict,
                fmt::format("{} {} to this asset; delete {} first", which, one ? "refers" : "refer",
                            one ? "that design" : "those designs"));
}

Answer<void> DesignRepository::remove_asset(const Principal& who, const std::string& id) {
  return store_.change([&]() -> Answer<void> {
    owners_.hold(Owned::Asset, id);
    if (!asset_row(id, who.name))
      return refuse(ProblemKind::NotFound, fmt::format("there is no asset {:?}", id));
    const bool is_mine = owners_.has(Owned::Asset, id, who.name);
    if (!is_mine && who.role < Role::Operator)
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's asset");
    if (const auto free = check_designs(id, is_mine ? who.name : ""); !free) return free;
    if (is_mine)
      owners_.remove(Owned::Asset, id, who.name);
    else
      owners_.remove_all(Owned::Asset, id);
    if (const auto other = owners_.first(Owned::Asset, id)) {
      store_.db().run("UPDATE asset SET owner=?, name=?, created=? WHERE id=?", other->owner,
                      other->name, other->created, id);
    } else {
      if (const auto free = check_designs(id, ""); !free) return free;
      store_.db().run("DELETE FROM asset WHERE id=?", id);
      store_.files().forget("assets/" + id);
      store_.after_commit([this, id] { side_thread_.remove(store_.folder().at("assets/" + id)); });
    }
    store_.audit(who.name, "delete-asset", id, "");
    if (asset_owner_removed) asset_owner_removed(id);
    return {};
  });
}

}  // namespace popcut::daemon
