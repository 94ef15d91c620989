// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/model/input_limits.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/previews/previewer.hpp"
#include "daemon/service/aside.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/service/service_thread.hpp"

namespace popcut::daemon {

/// Designs and what they refer to: files named by the digest of their bytes, and a row for each.
class DesignRepository : public Designs {
 public:
  /// @param previewer  may be null: then nothing is shown
  DesignRepository(ServiceStore& store, ServiceThread& thread, Planner& planner,
                   std::shared_ptr<Previewer> previewer, Aside& aside, std::shared_ptr<void> alive)
      : store_(store),
        thread_(thread),
        planner_(planner),
        previewer_(std::move(previewer)),
        aside_(aside),
        alive_(std::move(alive)) {}

  using Added = std::function<void(Answer<Design>)>;
  void add(const Principal& who, Upload upload, std::string media_type, std::string name,
           Added done) override;
  Answer<Asset> add_asset(const Principal& who, const Upload& upload) override;
  Page<Asset> assets(const PageRequest& request) override;
  Answer<void> remove_asset(const Principal& who, const std::string& id) override;
  Page<Design> list(const PageRequest& request) override;
  Answer<Design> find(const std::string& id) override;
  Answer<std::string> content(const std::string& id) override;
  /// As `find`, with its file and its assets in the state folder: of another node they are fetched.
  ///
  /// @retval Unavailable  they are on their way
  [[nodiscard]] Answer<Design> here(const std::string& id);
  Answer<void> remove(const Principal& who, const std::string& id) override;
  void preview(const std::string& id, std::function<void(Answer<std::string>)> done) override;
  CallOff show_spec(const Principal& who, const PreviewRequest& request, Shown done) override;
  CallOff place_spec(const Principal& who, const PreviewRequest& request, Shown done) override;
  CallOff lattice(const Principal& who, const std::string& id, Shown done) override;
  void picture(const Principal& who, const std::string& id, const std::string& name,
               Shown done) override;
  std::string material_mark(const std::string& id) override;
  CallOff file(const Principal& who, const std::string& id, const std::string& name, int part,
               Shown done) override;

  /// Has the previewer make the file `name`, and tells `done` what is in it.
  CallOff show(PreviewTask task, std::string name, Shown done);
  /// Where an asset is stored; of another node it is fetched.
  ///
  /// @retval NotFound     there is none
  /// @retval Unavailable  it is on its way
  [[nodiscard]] Answer<std::string> asset_place(const std::string& id);
  /// The planner's task for a stored design: its bytes, kind and assets.
  [[nodiscard]] PlanningTask task_for(const Design& design, PlanningTask::Kind kind);
  /// The material that a spec names; empty: none.
  [[nodiscard]] std::string own_material(const Design& design);
  /// The row of a material as JSON, of the usual one for an empty name; empty: there is none.
  std::function<std::string(const std::string& name)> material_row{};
  /// Called when a design is removed, in the same transaction.
  std::function<void(const std::string& design)> removed{};
  /// The same of an asset.
  std::function<void(const std::string& asset)> asset_removed{};

 private:
  void checked(const Principal& who, const Upload& upload, const std::string& media_type,
               const std::string& name, Result<PlanningOutcome> outcome, const Added& done);
  [[nodiscard]] Answer<Design> store(const Principal& who, const Upload& upload,
                                     const std::string& media_type, const std::string& name,
                                     const PlanningOutcome& outcome);
  [[nodiscard]] std::optional<Design> row(const std::string& id, std::string* media_type = nullptr);
  /// Some of the designs that refer to an asset.
  [[nodiscard]] std::vector<std::string> designs_with(const std::string& asset);
  /// None of them was removed while a design was looked at.
  [[nodiscard]] Answer<void> check_assets(const std::vector<std::string>& assets);
  /// The task of a spec that is not stored.
  [[nodiscard]] PreviewTask task_for(const Principal& who, const PreviewRequest& request,
                                     PlanningTask::Kind kind) const;
  [[nodiscard]] std::string row_of_material(const std::string& name) const;
  ServiceStore& store_;
  ServiceThread& thread_;
  Planner& planner_;
  std::shared_ptr<Previewer> previewer_;
  Aside& aside_;
  /// Where a picture of a design is kept.
  [[nodiscard]] std::string picture_place(const std::string& id, const std::string& name) const;
  void pictures_made(const std::string& id, const Answer<PlanningOutcome>& outcome);
  /// Reads what is kept, beside the service's thread.
  void read_aside(const std::string& place, Shown done);
  struct PictureWanted {
    std::string name;
    Shown done;
  };
  std::map<std::string, std::vector<PictureWanted>> drawing_{};  ///< who waits, by the design's id
  std::map<std::string, std::string> materials_{};               ///< what `own_material` has read
  std::shared_ptr<void> alive_;
};

/// Checks text from people: no control characters, and not longer than `limit`.
[[nodiscard]] Answer<void> check_text(const std::string& text, TextLimit limit,
                                      const std::string& pointer, bool lines_allowed = false);

}  // namespace popcut::daemon
