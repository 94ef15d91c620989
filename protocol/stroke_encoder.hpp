// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"
#include "protocol/page_map.hpp"

namespace popcut {

/// A point on the machine's grid: whole units, or hundredths of them.
struct GridPoint {
  std::int64_t a{};
  std::int64_t b{};
  friend constexpr bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// A stroke's tool, with force and speed in the machine's steps. None: it has no such setting.
struct StrokeSteps {
  int tool{1};
  std::optional<std::int64_t> force;
  std::optional<std::int64_t> speed;
};

/// What encoding has in common in both languages: setup, search for marks, strokes, trailer, and
/// the byte range of each. A language writes the bytes.
class StrokeEncoder {
 public:
  StrokeEncoder(const StrokeEncoder&) = delete;
  StrokeEncoder& operator=(const StrokeEncoder&) = delete;
  /// The whole program; its errors are those of `encode`.
  [[nodiscard]] Result<EncodedProgram> run();

 protected:
  /// Nothing longer was ever observed: drivers split their writes there, and small machines have
  /// small buffers.
  static constexpr std::size_t kMaxCommandBytes = 1023;

  /// @param feed_out_mm     see `JobOptions`
  /// @param per_unit        grid lines per machine unit: 1, or 100 for two decimals
  /// @param bytes_per_point estimate, to reserve memory
  StrokeEncoder(const Toolpath& toolpath, const Machine& machine, const PageMap& map,
                std::optional<double> feed_out_mm, int per_unit = 1,
                std::size_t bytes_per_point = 12);
  ~StrokeEncoder() = default;

  [[nodiscard]] virtual Result<void> check_job() const { return {}; }
  /// Writes the setup with the first stroke's settings and lists its blocks.
  virtual void write_setup(const StrokeSteps& first) = 0;
  virtual void write_search() {}
  /// Checks the points of stroke `index`, in `line_`.
  [[nodiscard]] virtual Result<void> check_line(std::size_t /*index*/) const { return {}; }
  /// Writes the settings that differ from those sent last.
  virtual void write_changes(const StrokeSteps& steps) = 0;
  /// Writes a move to the first point of `line_` and draws through the others.
  virtual void write_line() = 0;
  virtual void write_trailer() = 0;
  /// Moves to `point`, tool up, where the next job may begin.
  virtual void write_feed_out(GridPoint point) = 0;

  /// Appends "a,b".
  void append_point(GridPoint point);

  const Toolpath& toolpath_;
  const Machine& machine_;
  EncodedProgram program_;
  std::vector<GridPoint> line_;  ///< the stroke being written, without repeated points

 private:
  [[nodiscard]] Result<StrokeSteps> steps_of(std::size_t index) const;
  [[nodiscard]] Result<void> put_on_grid(std::size_t index);
  [[nodiscard]] Result<void> write_stroke(std::size_t index);

  const PageMap map_;
  std::optional<double> feed_out_mm_;
  std::int64_t farthest_feed_{};  ///< of all points, on the grid
  int per_unit_;
  std::size_t bytes_per_point_;
};

/// The place of stroke `index` in error messages.
[[nodiscard]] std::string stroke_place(std::size_t index);

/// Appends `value / per_unit` in decimal: whole numbers plain, others with two decimals.
void append_number(std::string& text, std::int64_t value, int per_unit = 1);

}  // namespace popcut
