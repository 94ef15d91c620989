// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/model/input_limits.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/previews/previewer.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/service/service_thread.hpp"
#include "daemon/service/side_thread.hpp"
#include "daemon/store/ownership_table.hpp"

namespace popcut::daemon {

/// The pictures of a design that are kept, see `Designs::picture`.
inline constexpr std::array<const char*, 2> kPictures{"deployed.svg", "pattern.svg"};

/// Designs and assets. Each has a row, owners (see `OwnershipTable`), and a file that is named by
/// the digest of its bytes.
class DesignRepository : public Designs {
 public:
  /// @param previewer  may be null; then there are no previews
  DesignRepository(ServiceStore& store, Poster post, Planner& planner,
                   std::shared_ptr<Previewer> previewer, SideThread& side_thread)
      : store_(store),
        post_(std::move(post)),
        planner_(planner),
        previewer_(std::move(previewer)),
        side_thread_(side_thread),
        owners_(store.db()) {}

  using Added = std::function<void(Answer<Design>)>;
  void add(const Principal& who, Upload upload, std::string media_type, std::string name,
           Added done) override;
  Answer<Asset> add_asset(const Principal& who, const Upload& upload) override;
  Page<Asset> assets(const Principal& who, const PageRequest& request) override;
  Answer<void> remove_asset(const Principal& who, const std::string& id) override;
  Page<Design> list(const Principal& who, const PageRequest& request) override;
  Answer<Design> find(const Principal& who, const std::string& id) override;
  /// The design with the name and time of its first owner.
  [[nodiscard]] Answer<Design> find(const std::string& id);
  Answer<std::string> content(const std::string& id) override;
  /// As `find`; also fetches its file and its assets into the state folder if another node has
  /// them.
  ///
  /// @retval Unavailable  they are still being fetched
  [[nodiscard]] Answer<Design> find_and_fetch(const std::string& id);
  Answer<void> remove(const Principal& who, const std::string& id) override;
  void preview(const Principal& who, const std::string& id,
               std::function<void(Answer<std::string>)> done) override;
  CancelView show_spec(const Principal& who, const PreviewRequest& request, OnView done) override;
  CancelView place_spec(const Principal& who, const PreviewRequest& request, OnView done) override;
  CancelView lattice(const Principal& who, const std::string& id,
                     const std::map<std::string, std::string>& reading, OnView done) override;
  void picture(const Principal& who, const std::string& id, const std::string& name,
               OnView done) override;
  std::string material_etag_suffix(const std::string& id) override;
  CancelView file(const Principal& who, const std::string& id, const std::string& name, int part,
                  OnView done) override;

  /// Starts a task of the previewer, and calls `done` with the content of the file `name` that the
  /// task makes.
  CancelView show(PreviewTask task, std::string name, OnView done);
  /// The path of an asset. Fetches it into the state folder if another node has it.
  ///
  /// @retval NotFound     there is no such asset
  /// @retval Unavailable  it is still being fetched
  [[nodiscard]] Answer<std::string> asset_path(const std::string& id);
  /// A task for a stored design, with its file, kind, material and assets.
  [[nodiscard]] PlanningTask task_for(const Design& design, PlanningTask::Kind kind);
  /// Makes `who` an owner of a design and of its assets, in a transaction. Returns true if `who`
  /// was not an owner before.
  bool add_owner(const Principal& who, const Design& design, const std::string& name);
  /// The same for an asset.
  bool add_asset_owner(const Principal& who, const std::string& id, const std::string& name);
  [[nodiscard]] OwnershipTable& owners() { return owners_; }
  /// The material that a spec names; empty if it names none. Reads the file the first time.
  [[nodiscard]] std::string material_in_spec(const Design& design);
  /// The row of a material as JSON; empty if there is no such material. An empty name means the
  /// default material.
  std::function<std::string(const std::string& name)> material_row{};
  /// Called in the transaction that removes a design, or one of its owners.
  std::function<void(const std::string& design)> owner_removed{};
  /// Called in the transaction that removes an asset, or one of its owners.
  std::function<void(const std::string& asset)> asset_owner_removed{};

 private:
  void upload_checked(const Principal& who, const Upload& upload, const std::string& media_type,
                      const std::string& name, Result<PlanningOutcome> outcome, const Added& done);
  [[nodiscard]] Answer<Design> store(const Principal& who, const Upload& upload,
                                     const std::string& media_type, const std::string& name,
                                     const PlanningOutcome& outcome);
  /// The row with `owner`'s own name and time, if they are an owner.
  [[nodiscard]] std::optional<Design> row(const std::string& id, std::string* media_type = nullptr,
                                          const std::string& owner = {});
  /// The design if these bytes are stored already and need no check. Makes `who` an owner of it.
  [[nodiscard]] Answer<std::optional<Design>> known(const Principal& who, const Upload& upload,
                                                    const std::string& media_type,
                                                    const std::string& name);
  /// Refuses if an unfinished job of `owner` uses the design; if `owner` is empty, a job of
  /// anybody.
  [[nodiscard]] Answer<void> check_jobs(const std::string& design, const std::string& owner);
  void delete_design(const std::string& id);
  /// The designs that refer to an asset: some of them, and how many there are.
  struct Referring {
    std::vector<std::string> some;
    std::int64_t all{};
  };
  /// @param owner  only those of this owner; empty: all
  [[nodiscard]] Referring designs_with(const std::string& asset, const std::string& owner = {});
  [[nodiscard]] Answer<void> check_designs(const std::string& asset, const std::string& owner);
  [[nodiscard]] std::optional<Asset> asset_row(const std::string& id, const std::string& owner);
  /// Refuses if an asset was removed while the design was checked.
  [[nodiscard]] Answer<void> check_assets(const std::vector<std::string>& assets);
  /// The task of a spec that is not stored.
  [[nodiscard]] PreviewTask task_for(const Principal& who, const PreviewRequest& request,
                                     PlanningTask::Kind kind) const;
  [[nodiscard]] std::string row_of_material(const std::string& name) const;
  ServiceStore& store_;
  Poster post_;
  Planner& planner_;
  std::shared_ptr<Previewer> previewer_;
  SideThread& side_thread_;
  OwnershipTable owners_;
  /// The path of a picture of a design.
  [[nodiscard]] std::string picture_path(const std::string& id, const std::string& name) const;
  void pictures_made(const std::string& id, const Answer<PlanningOutcome>& outcome);
  /// Reads a stored file on another thread.
  void read_on_side_thread(const std::string& place, OnView done);
  struct PictureRequest {
    std::string name;
    OnView done;
  };
  /// Requests that wait for the pictures of a design, by design.
  std::map<std::string, std::vector<PictureRequest>> picture_requests_{};
  std::map<std::string, std::string> materials_{};  ///< results of `material_in_spec`, by design
};

/// Checks text from people: no control characters, and not longer than `limit`.
[[nodiscard]] Answer<void> check_text(const std::string& text, TextLimit limit,
                                      const std::string& pointer, bool lines_allowed = false);

}  // namespace popcut::daemon
