// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/rigid/motion.hpp"

namespace popcut::testing {

/// A GLB file read by its specification alone (Khronos, glTF 2.0), to see where its animation puts
/// things.
class GlbScene {
 public:
  explicit GlbScene(const std::string& bytes);

  [[nodiscard]] const nlohmann::json& json() const { return json_; }
  [[nodiscard]] std::size_t nodes() const { return json_["nodes"].size(); }
  /// Numbers of an accessor, `width` to an element.
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor) const;
  /// Length of the animation in s, 0 if there is none.
  [[nodiscard]] double seconds() const;
  /// The corners of a node's first primitive in the world, y up and metres, at a time.
  [[nodiscard]] std::vector<Vec3> places(std::size_t node, double at_s) const;
  /// Joints between a node and the root.
  [[nodiscard]] int depth(std::size_t node) const;

 private:
  struct Local {
    rigid::Motion motion;
    double scale{1};
  };
  [[nodiscard]] Local local(std::size_t node, double at_s) const;

  nlohmann::json json_;
  std::string binary_;
  std::vector<int> parent_;
};

}  // namespace popcut::testing
