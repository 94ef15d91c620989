// SPDX-License-Identifier: MIT
// Part of daemon/service/repositories/design_repository.hpp: the list of assets, and their removal.
#include <fmt/format.h>

#include "daemon/service/repositories/design_repository.hpp"

namespace popcut::daemon {
namespace {

constexpr int kNamedDesigns = 5;

}  // namespace

std::vector<std::string> DesignRepository::designs_with(const std::string& asset) {
  return all_of(
      store_.db().rows("SELECT design FROM asset_use WHERE asset=? ORDER BY design LIMIT ?", asset,
                       kNamedDesigns),
      first_text);
}

Page<Asset> DesignRepository::assets(const PageRequest& request) {
  Page<Asset> page;
  page.items = all_of(
      store_.db().rows("SELECT id, name, owner, bytes, created FROM asset "
                       "WHERE id>? ORDER BY id LIMIT ?",
                       request.cursor, request.limit + 1),
      [](const Rows& rows) {
        Asset asset{.is_new = false};
        rows.read(0, std::tie(asset.id, asset.name, asset.owner, asset.bytes, asset.created));
        return asset;
      });
  if (page.items.size() > static_cast<std::size_t>(request.limit)) {
    page.items.pop_back();
    page.next_cursor = page.items.back().id;
  }
  for (Asset& asset : page.items) {
    asset.designs = designs_with(asset.id);
    asset.designs_total =
        store_.db().number("SELECT count(*) FROM asset_use WHERE asset=?", asset.id);
  }
  return page;
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

Answer<std::string> DesignRepository::asset_place(const std::string& id) {
  if (store_.db().number("SELECT EXISTS(SELECT 1 FROM asset WHERE id=?)", id) == 0)
    return refuse(ProblemKind::NotFound, fmt::format("there is no asset {:?}", id));
  if (const auto brought = store_.bring("assets/" + id); !brought)
    return tl::unexpected(brought.error());
  return store_.folder().at("assets/" + id);
}

Answer<void> DesignRepository::remove_asset(const Principal& who, const std::string& id) {
  return store_.change([&]() -> Answer<void> {
    const std::optional<std::string> owner =
        first_of(store_.db().rows("SELECT owner FROM asset WHERE id=?", id), first_text);
    if (!owner) return refuse(ProblemKind::NotFound, fmt::format("there is no asset {:?}", id));
    if (who.role < Role::Operator && *owner != who.name)
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's asset");
    if (const auto designs = designs_with(id); !designs.empty()) {
      const std::int64_t all =
          store_.db().number("SELECT count(*) FROM asset_use WHERE asset=?", id);
      const bool one = all == 1;
      std::string which = fmt::format("{}", fmt::join(designs, ", "));
      if (all > kNamedDesigns) which += fmt::format(" and {} more", all - kNamedDesigns);
      return refuse(ProblemKind::StateConflict,
                    fmt::format("{} {} to this asset; delete {} first", which,
                                one ? "refers" : "refer", one ? "that design" : "those designs"));
    }
    store_.db().run("DELETE FROM asset WHERE id=?", id);
    store_.files().forget("assets/" + id);
    store_.audit(who.name, "delete-asset", id, "");
    if (asset_removed) asset_removed(id);
    store_.after_commit([this, id] { remove_tree(store_.folder().at("assets/" + id)); });
    return {};
  });
}

}  // namespace popcut::daemon
