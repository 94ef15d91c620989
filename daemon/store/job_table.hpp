// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// How far a job at the end of the queue is from the one before it, so that others fit in between.
inline constexpr std::int64_t kPositionStep = std::int64_t{1} << 20;

/// Where a job stands in the queue, for the next page.
struct QueuePlace {
  int priority{};
  std::int64_t position{};
  std::string id;
};
/// "-3.1048576.01J...": text that `queue_place_from` reads.
[[nodiscard]] std::string text_of(const QueuePlace& place);
/// Nothing for a text that `text_of` did not give.
[[nodiscard]] std::optional<QueuePlace> queue_place_from(const std::string& text);

/// The statements over `job`. All throw StoreFault.
class JobTable {
 public:
  explicit JobTable(Database& database) : db_(database) {}

  void insert(const JobRow& row);
  /// Writes all that may change, with the next revision.
  void update(JobRow& row);
  [[nodiscard]] std::optional<JobRow> find(std::string_view id);
  /// Up to `limit` jobs with ids above `after` (below it, newest first), in their order. It looks
  /// at a bounded number of rows, however many there are: `looked_to` is the id up to which it has
  /// found all, or empty if it has found `limit`, or there are no more.
  [[nodiscard]] std::vector<JobRow> list(const JobFilter& filter, const std::string& after,
                                         int limit, std::string& looked_to);
  /// A part of the queue.
  struct QueueSlice {
    std::vector<JobRow> jobs{};
    std::optional<QueuePlace> last{};  ///< the last that was looked at, in it or not
    bool is_end{false};
  };
  /// Jobs that are not ended, in the order of the queue: of all devices if `device` is empty, else
  /// those that are bound to it or to none; behind `after`, if it is given. Looks at up to `most`.
  [[nodiscard]] QueueSlice queue(const std::string& device, const std::optional<QueuePlace>& after,
                                 int most);
  /// Those whose plan is awaited.
  [[nodiscard]] std::vector<JobRow> waiting_for(const std::string& plan, JobState state, int limit);
  /// The armed, cutting or paused job of a device.
  [[nodiscard]] std::optional<JobRow> on_device(const std::string& device);
  [[nodiscard]] std::int64_t last_position();
  [[nodiscard]] std::int64_t count(JobState state);
  [[nodiscard]] std::int64_t open_count();
  [[nodiscard]] std::int64_t open_count_of(const std::string& owner);
  /// A position before `next` and behind the job that is before it, without `moved`. Where the two
  /// have none between them, some of those that follow are moved on; nothing if there would have to
  /// be too many. In a transaction.
  [[nodiscard]] std::optional<std::int64_t> make_room(const JobRow& next, const std::string& moved);

 private:
  Database& db_;
};

}  // namespace popcut::daemon
