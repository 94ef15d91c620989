// SPDX-License-Identifier: MIT
#include "core/model/gltf_scene.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/geometry/vec.hpp"
#include "core/model/gltf_materials.hpp"
#include "core/model/gltf_numbers.hpp"

namespace popcut::model_readers {
namespace {

using Matrix = Eigen::Matrix4d;

/// Parts of the scene that are visited at most: a few bytes can draw a part many times.
constexpr std::size_t kMostParts = 250'000;
/// Numbers that are added up at most, to move vertices: a few bytes can name a target or a joint
/// many times.
constexpr std::size_t kMostMoves = 500'000'000;
/// Values that sparse accessors replace at most: a few bytes can stand in many of them.
constexpr std::size_t kMostReplaced = 50'000'000;

Matrix matrix_of(const Eigen::Vector3d& move, const Eigen::Vector4d& turn,
                 const Eigen::Vector3d& scale) {
  Matrix out = Matrix::Identity();
  out.topLeftCorner<3, 3>() =
      Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]).normalized().toRotationMatrix() *
      scale.asDiagonal();
  out.topRightCorner<3, 1>() = move;
  return out;
}

Matrix matrix_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Matrix>(node.matrix.data());
  Eigen::Vector3d move = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  Eigen::Vector4d turn(0, 0, 0, 1);
  if (node.translation.size() == 3)
    move = Eigen::Map<const Eigen::Vector3d>(node.translation.data());
  if (node.scale.size() == 3) scale = Eigen::Map<const Eigen::Vector3d>(node.scale.data());
  if (node.rotation.size() == 4) turn = Eigen::Map<const Eigen::Vector4d>(node.rotation.data());
  return matrix_of(move, turn, scale);
}

/// What an extension says of a node; none if it says nothing.
const tinygltf::Value* extension_of(const tinygltf::Node& node, const char* name) {
  const auto found = node.extensions.find(name);
  return found == node.extensions.end() ? nullptr : &found->second;
}

bool is_visible(const tinygltf::Node& node) {
  const tinygltf::Value* const said = extension_of(node, "KHR_node_visibility");
  return said == nullptr || !said->Has("visible") || !said->Get("visible").IsBool() ||
         said->Get("visible").Get<bool>();
}

/// The three vertices of triangle `k` of a primitive, counted in its list of vertices
/// (glTF 2.0, 3.7.2.1).
std::array<std::size_t, 3> triangle_of(int mode, std::size_t k) {
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) return {k, k + 1 + k % 2, k + 2 - k % 2};
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {k + 1, k + 2, 0};
  return {3 * k, 3 * k + 1, 3 * k + 2};
}

/// Moves the vertices of a skinned mesh: a sum over joints, weighted.
struct Skin {
  std::vector<Matrix> joints;  ///< of a vertex at rest to the scene
  std::vector<GltfNumbers> indices, weights;
};

/// Moves the vertices of a mesh toward a target.
struct Morph {
  double weight{};
  GltfNumbers move;
};

class SceneReader {
 public:
  SceneReader(const std::string& name, const tinygltf::Model& file, const ModelOptions& options)
      : name_(name), file_(file), options_(options), materials_(name, file, options, model_) {}

  Result<Model> read() {
    if (options_.colours)
      if (auto done = materials_.read(); !done) return tl::unexpected(done.error());
    is_joint_.assign(file_.nodes.size(), false);
    for (const tinygltf::Skin& skin : file_.skins)
      for (const int joint : skin.joints)
        if (joint >= 0 && static_cast<std::size_t>(joint) < file_.nodes.size())
          is_joint_[static_cast<std::size_t>(joint)] = true;
    // Joints may come after what they move.
    if (!file_.skins.empty())
      if (auto done = visit_scene(false); !done) return tl::unexpected(done.error());
    if (auto done = visit_scene(true); !done) return tl::unexpected(done.error());
    if (model_.size() == 0)
      return fail(ErrorKind::Malformed, name_, "has no triangles; a mesh needs faces");
    if (!has_corner_colours_) model_.corner_colours.clear();
    return std::move(model_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> broken(const char* list, int index, const char* what) const {
    return fail(ErrorKind::Malformed, fmt::format("{}: /{}/{}", name_, list, index), what);
  }

  [[nodiscard]] tl::unexpected<Error> too_many_parts() const {
    return fail(
        ErrorKind::OutOfRange, name_,
        fmt::format("draws more than {} parts; join them, and save the model again", kMostParts));
  }

  [[nodiscard]] tl::unexpected<Error> empty_values(std::size_t count, std::size_t given) const {
    return fail(
        ErrorKind::Malformed, name_,
        fmt::format("announces {} values and gives {} of them; repair the model", count, given));
  }

  /// Visits all nodes of the scene: draws them, or keeps where the joints are.
  Result<void> visit_scene(bool draws) {
    visited_ = 0;
    draws_ = draws;
    const auto scene = static_cast<std::size_t>(std::max(file_.defaultScene, 0));
    if (scene >= file_.scenes.size()) return {};
    for (const int root : file_.scenes[scene].nodes)
      if (auto done = visit(root, Matrix::Identity(), true, 0); !done) return done;
    return {};
  }

  Result<void> visit(int index, const Matrix& above, bool visible, int depth) {
    constexpr int kDeepest = 256;  // a tree this deep goes round in a circle
    if (index < 0 || static_cast<std::size_t>(index) >= file_.nodes.size() || depth > kDeepest)
      return broken("nodes", index, "does not exist, or lies in itself; repair the model");
    // Each has one place, or some nodes that lie in two would be visited for ever.
    if (++visited_ > file_.nodes.size())
      return broken("nodes", index, "lies in two nodes; repair the model");
    const tinygltf::Node& node = file_.nodes[static_cast<std::size_t>(index)];
    const Matrix here = above * matrix_of(node);
    visible = visible && is_visible(node);
    if (!draws_ && is_joint_[static_cast<std::size_t>(index)]) joint_places_[index] = here;
    if (draws_ && visible && node.mesh >= 0)
      if (auto done = draw(node, here); !done) return done;
    for (const int child : node.children)
      if (auto done = visit(child, here, visible, depth + 1); !done) return done;
    return {};
  }

  Result<void> draw(const tinygltf::Node& node, const Matrix& here) {
    if (static_cast<std::size_t>(node.mesh) >= file_.meshes.size())
      return broken("meshes", node.mesh, "does not exist; repair the model");
    const tinygltf::Mesh& mesh = file_.meshes[static_cast<std::size_t>(node.mesh)];
    const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
    const auto places = places_of(node, here);
    if (!places) return tl::unexpected(places.error());
    for (const Matrix& place : *places)
      for (const tinygltf::Primitive& primitive : mesh.primitives) {
        if (++parts_ > kMostParts) return too_many_parts();
        if (auto done = add_primitive(primitive, node.skin, weights, place); !done) return done;
      }
    return {};
  }

  /// Where a node has its mesh: in one place, or in that of each instance.
  Result<std::vector<Matrix>> places_of(const tinygltf::Node& node, const Matrix& here) {
    const tinygltf::Value* const said = extension_of(node, "EXT_mesh_gpu_instancing");
    if (said == nullptr || !said->Has("attributes")) return std::vector{here};
    const tinygltf::Value& attributes = said->Get("attributes");
    std::optional<GltfNumbers> move, turn, scale;
    std::optional<std::size_t> count;
    std::size_t given = 0;
    for (const auto& [word, parts, numbers] :
         {std::tuple{"TRANSLATION", 3U, &move}, std::tuple{"ROTATION", 4U, &turn},
          std::tuple{"SCALE", 3U, &scale}}) {
      if (!attributes.Has(word)) continue;
      const auto found = numbers_of(attributes.Get(word).GetNumberAsInt(), parts);
      if (!found) return tl::unexpected(found.error());
      *numbers = *found;
      if (count.value_or(found->size()) != found->size())
        return broken("nodes", static_cast<int>(&node - file_.nodes.data()),
                      "has instances whose lists are not as long as each other; repair the model");
      count = found->size();
      given = std::max(given, found->given());
    }
    if (!count) return std::vector{here};
    if (*count > given) return empty_values(*count, given);
    if (*count > kMostParts) return too_many_parts();
    std::vector<Matrix> out;
    out.reserve(*count);
    for (std::size_t i = 0; i < *count; ++i) {
      Eigen::Vector3d to = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Ones();
      Eigen::Vector4d by(0, 0, 0, 1);
      for (std::size_t k = 0; k < 4; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        if (turn) by[row] = turn->get(i, k);
        if (k < 3 && move) to[row] = move->get(i, k);
        if (k < 3 && scale) size[row] = scale->get(i, k);
      }
      out.push_back(here * matrix_of(to, by, size));
    }
    return out;
  }

  Result<GltfNumbers> numbers_of(int accessor, std::size_t least_parts) {
    auto out = GltfNumbers::of(file_, accessor, least_parts, name_);
    if (!out || out->replaced() == 0 || !ordered_.insert(accessor).second) return out;
    replaced_ += out->replaced();
    if (replaced_ > kMostReplaced)
      return fail(ErrorKind::OutOfRange, name_,
                  fmt::format("has more than {} sparse values; save the model without them",
                              kMostReplaced));
    if (!out->is_in_order())
      return broken("accessors", accessor,
                    "has sparse indices that do not rise, or are too large; repair the model");
    return out;
  }

  /// The numbers that a primitive has for each of its vertices; none if it does not have them.
  Result<std::optional<GltfNumbers>> attribute(const std::map<std::string, int>& of,
                                               const std::string& word, std::size_t least_parts) {
    const auto found = of.find(word);
    if (found == of.end()) return std::optional<GltfNumbers>{};
    const auto numbers = numbers_of(found->second, least_parts);
    if (!numbers) return tl::unexpected(numbers.error());
    return std::optional(*numbers);
  }

  /// The triangles of a primitive; points and lines have no surface.
  Result<void> add_primitive(const tinygltf::Primitive& of, int skin,
                             const std::vector<double>& weights, const Matrix& here) {
    const int mode = of.mode < 0 ? TINYGLTF_MODE_TRIANGLES : of.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES) return {};
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
      return fail(ErrorKind::Malformed, name_,
                  fmt::format("has a primitive of mode {}, which glTF does not define", mode));
    if (of.extensions.contains("KHR_draco_mesh_compression"))
      return fail(ErrorKind::Malformed, name_,
                  "is compressed (KHR_draco_mesh_compression); save the model without compression");
    const auto places = attribute(of.attributes, "POSITION", 3);
    if (!places) return tl::unexpected(places.error());
    if (!*places) return {};
    std::optional<GltfNumbers> indices;
    if (of.indices >= 0) {
      const auto numbers = numbers_of(of.indices, 1);
      if (!numbers) return tl::unexpected(numbers.error());
      indices = *numbers;
    }
    const std::size_t vertices = indices ? indices->size() : (*places)->size();
    const std::size_t triangles =
        mode == TINYGLTF_MODE_TRIANGLES ? vertices / 3 : std::max<std::size_t>(vertices, 2) - 2;
    if (mode == TINYGLTF_MODE_TRIANGLES) model_.corners_left_over += vertices % 3;
    // Others have three corners in one place.
    if (!indices && triangles > 3 * (*places)->given())
      return empty_values(vertices, (*places)->given());
    if (triangles > kMaxTriangles - model_.size())
      return fail(ErrorKind::OutOfRange, name_,
                  fmt::format("has more than {} triangles; reduce the mesh", kMaxTriangles));
    const auto morphs = morphs_of(of, weights);
    if (!morphs) return tl::unexpected(morphs.error());
    const auto bones = skin < 0 ? Result<std::optional<Skin>>{} : skin_of(of, skin);
    if (!bones) return tl::unexpected(bones.error());
    const std::size_t each = morphs->size() + (*bones ? 4 * (*bones)->indices.size() : 0);
    moves_ += 3 * triangles * each + (*bones ? (*bones)->joints.size() : 0);
    if (moves_ > kMostMoves)
      return fail(ErrorKind::OutOfRange, name_,
                  "has too many joints and morph targets; apply them, and save the model again");
    Colours colours;
    if (options_.colours)
      if (auto done = find_colours(of, (*places)->size(), colours); !done) return done;
    for (std::size_t k = 0; k < triangles; ++k)
      for (const std::size_t corner : triangle_of(mode, k)) {
        const double named = indices ? indices->get(corner, 0) : static_cast<double>(corner);
        if (!(named >= 0 && named < static_cast<double>((*places)->size())))
          return fail(ErrorKind::Malformed, name_,
                      fmt::format("a triangle names vertex {} of {}; repair the model", named,
                                  (*places)->size()));
        const auto i = static_cast<std::size_t>(named);
        if (auto done = add_corner(i, **places, *morphs, *bones, here); !done) return done;
        if (options_.colours) add_colour(i, colours);
      }
    if (options_.colours)
      model_.material_of.insert(model_.material_of.end(), triangles, colours.material);
    return {};
  }

  /// Whether the positions of a target are all zero: it has an accessor without values.
  [[nodiscard]] bool moves_nothing(const std::map<std::string, int>& target) const {
    const auto found = target.find("POSITION");
    if (found == target.end()) return true;
    if (found->second < 0 || static_cast<std::size_t>(found->second) >= file_.accessors.size())
      return false;
    const auto& accessor = file_.accessors[static_cast<std::size_t>(found->second)];
    return accessor.bufferView < 0 && !accessor.sparse.isSparse && accessor.extensions.empty();
  }

  /// The targets of a primitive whose weight is not zero.
  Result<std::vector<Morph>> morphs_of(const tinygltf::Primitive& of,
                                       const std::vector<double>& weights) {
    if (std::any_of(weights.begin() + std::min(weights.size(), of.targets.size()), weights.end(),
                    [](double weight) { return weight != 0; }))
      return fail(ErrorKind::Malformed, name_,
                  fmt::format("has {} weights for {} morph targets; repair the model",
                              weights.size(), of.targets.size()));
    std::vector<Morph> out;
    for (std::size_t k = 0; k < of.targets.size() && k < weights.size(); ++k) {
      if (weights[k] == 0 || moves_nothing(of.targets[k])) continue;
      const auto move = attribute(of.targets[k], "POSITION", 3);
      if (!move) return tl::unexpected(move.error());
      if (*move) out.push_back({weights[k], **move});
    }
    return out;
  }

  /// How a skin moves the vertices of a primitive; none if the primitive does not say which joints.
  Result<std::optional<Skin>> skin_of(const tinygltf::Primitive& of, int index) {
    if (static_cast<std::size_t>(index) >= file_.skins.size())
      return broken("skins", index, "does not exist; repair the model");
    const tinygltf::Skin& skin = file_.skins[static_cast<std::size_t>(index)];
    Skin out;
    for (int set = 0; set < 8 && of.attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const auto indices = attribute(of.attributes, fmt::format("JOINTS_{}", set), 4);
      if (!indices) return tl::unexpected(indices.error());
      const auto weights = attribute(of.attributes, fmt::format("WEIGHTS_{}", set), 4);
      if (!weights) return tl::unexpected(weights.error());
      if (!*weights)
        return broken("skins", index,
                      "moves a mesh that has joints without weights; repair the model");
      out.indices.push_back(**indices), out.weights.push_back(**weights);
    }
    if (out.indices.empty()) return std::optional<Skin>{};
    std::optional<GltfNumbers> rest;
    if (skin.inverseBindMatrices >= 0) {
      const auto numbers = numbers_of(skin.inverseBindMatrices, 16);
      if (!numbers) return tl::unexpected(numbers.error());
      if (numbers->size() < skin.joints.size())
        return broken("skins", index, "has fewer matrices than joints; repair the model");
      rest = *numbers;
    }
    for (std::size_t k = 0; k < skin.joints.size(); ++k) {
      const auto place = joint_places_.find(skin.joints[k]);
      if (place == joint_places_.end())
        return broken("skins", index, "has a joint that is not in the scene; save the model again");
      Matrix back = Matrix::Identity();
      for (std::size_t i = 0; rest && i < 16; ++i) back.data()[i] = rest->get(k, i);
      out.joints.push_back(place->second * back);
    }
    return std::optional(std::move(out));
  }

  /// Where a skin moves a vertex. The place of the node itself does not count (glTF 2.0, 3.7.3.3).
  [[nodiscard]] std::optional<Matrix> moved_by(const Skin& skin, std::size_t vertex) const {
    Matrix out = Matrix::Zero();
    double sum = 0;
    for (std::size_t set = 0; set < skin.indices.size(); ++set)
      for (std::size_t k = 0; k < 4; ++k) {
        if (vertex >= skin.weights[set].size() || vertex >= skin.indices[set].size())
          return std::nullopt;
        const double weight = skin.weights[set].get(vertex, k);
        if (weight == 0) continue;
        const double joint = skin.indices[set].get(vertex, k);
        if (!(joint >= 0 && joint < static_cast<double>(skin.joints.size()))) return std::nullopt;
        out += weight * skin.joints[static_cast<std::size_t>(joint)];
        sum += weight;
      }
    if (!(sum > 0)) return std::nullopt;
    return out / sum;  // weights of a few bits each do not add up to one
  }

  Result<void> add_corner(std::size_t vertex, const GltfNumbers& places,
                          const std::vector<Morph>& morphs, const std::optional<Skin>& skin,
                          const Matrix& here) {
    Eigen::Vector4d at(places.get(vertex, 0), places.get(vertex, 1), places.get(vertex, 2), 1);
    for (const Morph& morph : morphs)
      for (std::size_t k = 0; k < 3 && vertex < morph.move.size(); ++k)
        at[static_cast<Eigen::Index>(k)] += morph.weight * morph.move.get(vertex, k);
    std::optional<Matrix> by = here;
    if (skin) by = moved_by(*skin, vertex);
    if (!by)
      return fail(
          ErrorKind::Malformed, name_,
          fmt::format(
              "vertex {} has no weight, or names a joint that does not exist; repair the model",
              vertex));
    at = *by * at;
    if (!at.allFinite())
      return fail(ErrorKind::OutOfRange, name_,
                  "has a corner that is not a finite number; repair the mesh");
    model_.corners.insert(model_.corners.end(), at.data(), at.data() + 3);
    return {};
  }

  /// What colours the corners of a primitive.
  struct Colours {
    std::uint32_t material{};
    const GltfPlaces* moved{};
    std::optional<GltfNumbers> picture_places, corner_colours;
  };

  /// The numbers that give colours to all `vertices` of a primitive; none if it does not have them.
  Result<std::optional<GltfNumbers>> colouring(const tinygltf::Primitive& of,
                                               const std::string& word, std::size_t least_parts,
                                               std::size_t vertices) {
    auto numbers = attribute(of.attributes, word, least_parts);
    if (numbers && *numbers && (*numbers)->size() < vertices)
      return fail(ErrorKind::Malformed, name_,
                  fmt::format("a mesh has {} values of {} for {} vertices; repair the model",
                              (*numbers)->size(), word, vertices));
    return numbers;
  }

  Result<void> find_colours(const tinygltf::Primitive& of, std::size_t vertices, Colours& out) {
    if (of.material >= 0) {
      const auto material = static_cast<std::size_t>(of.material);
      if (material >= file_.materials.size())
        return broken("materials", of.material, "does not exist; repair the model");
      out.moved = &materials_.places(material);
      out.material = static_cast<std::uint32_t>(material + 1);
      model_.uses_materials = true;
      if (model_.materials[out.material].picture >= 0) {
        const std::string word = fmt::format("TEXCOORD_{}", out.moved->set);
        const auto places = colouring(of, word, 2, vertices);
        if (!places) return tl::unexpected(places.error());
        if (!*places)
          return fail(ErrorKind::Malformed, fmt::format("{}: /materials/{}", name_, of.material),
                      fmt::format("has a picture whose places are {}, and a mesh lacks them; save "
                                  "the model with them, or without the picture",
                                  word));
        out.picture_places = *places;
      }
    }
    const auto colours = colouring(of, "COLOR_0", 3, vertices);
    if (!colours) return tl::unexpected(colours.error());
    out.corner_colours = *colours;
    has_corner_colours_ = has_corner_colours_ || out.corner_colours.has_value();
    return {};
  }

  void add_colour(std::size_t vertex, const Colours& of) {
    std::array<float, 2> place{};
    if (of.picture_places)
      place = of.moved->moved(of.picture_places->get(vertex, 0), of.picture_places->get(vertex, 1));
    model_.picture_places.push_back(place);
    ModelColour colour{1, 1, 1};
    if (of.corner_colours)
      for (std::size_t k = 0; k < 3; ++k)
        colour[k] = srgb_of_light(of.corner_colours->get(vertex, k));
    model_.corner_colours.push_back(colour);
  }

  const std::string& name_;
  const tinygltf::Model& file_;
  const ModelOptions& options_;
  Model model_;
  GltfMaterials materials_;
  std::vector<bool> is_joint_;          ///< of each node
  std::map<int, Matrix> joint_places_;  ///< of nodes that are joints
  std::set<int> ordered_;               ///< sparse accessors whose indices were looked at
  std::size_t visited_{}, parts_{}, moves_{}, replaced_{};
  bool draws_{false}, has_corner_colours_{false};
};

}  // namespace

Result<Model> read_gltf_scene(const std::string& name, const tinygltf::Model& file,
                              const ModelOptions& options) {
  return SceneReader(name, file, options).read();
}

}  // namespace popcut::model_readers
