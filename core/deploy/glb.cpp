// SPDX-License-Identifier: MIT
#include "core/deploy/glb.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/deploy/sheet_mesh.hpp"

namespace popcut {
namespace {

// Bytes of a GLB are little-endian, and so are the numbers that are copied into it.
static_assert(std::endian::native == std::endian::little);

enum Material : int { kFront, kBack };

/// The one buffer, with a view for each kind of content; equal contents are stored once.
class Store {
 public:
  explicit Store(tinygltf::Model& model) : model_(model) {
    parts_.resize(5);
    model.bufferViews.resize(parts_.size());
    for (auto& view : model.bufferViews) view.buffer = 0;
    model.bufferViews[kVectors].byteStride = 12;
    model.bufferViews[kVectors].target = TINYGLTF_TARGET_ARRAY_BUFFER;
    model.bufferViews[kIndices].target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    model.bufferViews[kPlaces].byteStride = 8;
    model.bufferViews[kPlaces].target = TINYGLTF_TARGET_ARRAY_BUFFER;
  }

  int vectors(const std::vector<Vec3>& places, bool with_bounds) {
    std::vector<float> numbers;
    for (const Vec3& p : places)
      for (const double value : p) numbers.push_back(static_cast<float>(value));
    return add(kVectors, numbers, places.size(), TINYGLTF_TYPE_VEC3, with_bounds);
  }
  int indices(const std::vector<std::uint32_t>& corners) {
    return add(kIndices, corners, corners.size(), TINYGLTF_TYPE_SCALAR, false);
  }
  /// Places in the picture.
  int places(const std::vector<float>& pairs) {
    return add(kPlaces, pairs, pairs.size() / 2, TINYGLTF_TYPE_VEC2, false);
  }
  /// The view of the picture's bytes.
  int picture(const std::string& bytes) {
    auto& to = parts_[kPicture];
    to.assign(bytes.begin(), bytes.end());
    return kPicture;
  }
  int track(const std::vector<float>& numbers, std::size_t keys, int type, bool with_bounds) {
    return add(kTracks, numbers, keys, type, with_bounds);
  }

  /// Puts the parts into the buffer, each at a multiple of four bytes. glTF has no empty views.
  void finish() {
    model_.buffers.emplace_back();
    auto& data = model_.buffers.front().data;
    std::vector<int> view_of(parts_.size(), -1);
    std::vector<tinygltf::BufferView> views;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i].empty()) continue;
      view_of[i] = static_cast<int>(views.size());
      views.push_back(model_.bufferViews[i]);
      views.back().byteOffset = data.size();
      views.back().byteLength = parts_[i].size();
      data.insert(data.end(), parts_[i].begin(), parts_[i].end());
      data.resize((data.size() + 3) / 4 * 4, 0);
    }
    model_.bufferViews = std::move(views);
    const auto moved = [&](int& view) { view = view_of[static_cast<std::size_t>(view)]; };
    for (auto& accessor : model_.accessors) moved(accessor.bufferView);
    for (auto& image : model_.images) moved(image.bufferView);
  }

 private:
  enum Part : int { kVectors, kIndices, kPlaces, kPicture, kTracks };

  template <typename Number>
  int add(Part part, const std::vector<Number>& numbers, std::size_t count, int type,
          bool with_bounds) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    const auto [known, fresh] = known_.try_emplace(
        {static_cast<int>(part), type, with_bounds ? 1 : 0, bytes}, model_.accessors.size());
    if (!fresh) return static_cast<int>(known->second);
    tinygltf::Accessor accessor;
    accessor.bufferView = part;
    accessor.byteOffset = parts_[part].size();
    accessor.componentType = std::is_same_v<Number, float> ? TINYGLTF_COMPONENT_TYPE_FLOAT
                                                           : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.count = count;
    accessor.type = type;
    if (with_bounds) bound(accessor, numbers);
    parts_[part].insert(parts_[part].end(), bytes.begin(), bytes.end());
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  template <typename Number>
  static void bound(tinygltf::Accessor& accessor, const std::vector<Number>& numbers) {
    const std::size_t width = numbers.size() / accessor.count;
    for (std::size_t c = 0; c < width; ++c) {
      Number low = numbers[c], high = numbers[c];
      for (std::size_t i = c; i < numbers.size(); i += width) {
        low = std::min(low, numbers[i]);
        high = std::max(high, numbers[i]);
      }
      accessor.minValues.push_back(static_cast<double>(low));
      accessor.maxValues.push_back(static_cast<double>(high));
    }
  }

  tinygltf::Model& model_;
  std::vector<std::vector<unsigned char>> parts_;
  std::map<std::tuple<int, int, int, std::string>, std::size_t> known_;
};

tinygltf::Material material(const char* name, const std::vector<double>& colour) {
  tinygltf::Material made;
  made.name = name;
  made.pbrMetallicRoughness.baseColorFactor = colour;
  made.pbrMetallicRoughness.metallicFactor = 0;
  made.pbrMetallicRoughness.roughnessFactor = 0.9;
  return made;
}

/// @param places  in the picture; below 0: none
tinygltf::Primitive primitive(int positions, int normals, int indices, Material of,
                              int places = -1) {
  tinygltf::Primitive made;
  made.attributes = {{"POSITION", positions}, {"NORMAL", normals}};
  if (places >= 0) made.attributes["TEXCOORD_0"] = places;
  made.indices = indices;
  made.material = of;
  made.mode = TINYGLTF_MODE_TRIANGLES;
  return made;
}

/// The paper of face `f` around its pivot.
class FacePaper {
 public:
  /// @param picture  null: none
  FacePaper(const FaceTriangles& faces, std::size_t f, const Vec3& pivot, double wall_mm,
            const GlbPicture* picture) {
    const std::uint32_t first = faces.first_corner[f];
    for (std::uint32_t i = first; i < faces.first_corner[f + 1]; ++i) {
      const Vec3& at = faces.corner[i];  // (u - wall, v, 0)
      corners_.emplace_back(at - pivot);
      if (picture == nullptr) continue;
      places_.push_back(static_cast<float>((at[1] - picture->left_mm) / picture->width_mm));
      places_.push_back(
          static_cast<float>((at[0] + wall_mm - picture->top_mm) / picture->height_mm));
    }
    for (std::uint32_t t = faces.first_triangle[f]; t < faces.first_triangle[f + 1]; ++t) {
      const auto& [a, b, c] = faces.triangle[t];
      front_.insert(front_.end(), {a - first, b - first, c - first});
      back_.insert(back_.end(), {a - first, c - first, b - first});
    }
  }

  [[nodiscard]] tinygltf::Mesh surface(Store& store) const {
    const int positions = store.vectors(corners_, true);
    tinygltf::Mesh mesh;
    mesh.primitives = {primitive(positions, same_normal(store, 1), store.indices(front_), kFront,
                                 places_in(store)),
                       primitive(positions, same_normal(store, -1), store.indices(back_), kBack)};
    return mesh;
  }

  [[nodiscard]] tinygltf::Mesh solid(Store& store, double thickness_mm) const {
    const Vec3 half{0, 0, thickness_mm / 2};
    std::vector<Vec3> top = corners_, low = corners_, low_normals(corners_.size(), Vec3{0, 0, -1});
    for (Vec3& p : top) p += half;
    for (Vec3& p : low) p -= half;
    std::vector<std::uint32_t> under = back_;
    for (std::size_t i = 0; i < corners_.size(); ++i) add_side(i, half, low, low_normals, under);
    tinygltf::Mesh mesh;
    mesh.primitives = {primitive(store.vectors(top, true), same_normal(store, 1),
                                 store.indices(front_), kFront, places_in(store)),
                       primitive(store.vectors(low, true), store.vectors(low_normals, false),
                                 store.indices(under), kBack)};
    return mesh;
  }

 private:
  [[nodiscard]] int places_in(Store& store) const {
    return places_.empty() ? -1 : store.places(places_);
  }
  [[nodiscard]] int same_normal(Store& store, double z) const {
    return store.vectors(std::vector<Vec3>(corners_.size(), Vec3{0, 0, z}), false);
  }

  /// The rim between corner i and the next one, with corners of its own for its normal.
  void add_side(std::size_t i, const Vec3& half, std::vector<Vec3>& at, std::vector<Vec3>& normals,
                std::vector<std::uint32_t>& indices) const {
    const Vec3 &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
    const Vec3 along = b - a;
    const Vec3 outward = (1 / norm(along)) * Vec3{along[1], -along[0], 0};
    const auto n = static_cast<std::uint32_t>(at.size());
    at.insert(at.end(), {a + half, a - half, b - half, b + half});
    normals.insert(normals.end(), 4, outward);
    indices.insert(indices.end(), {n, n + 1, n + 2, n, n + 2, n + 3});
  }

  std::vector<Vec3> corners_;
  std::vector<float> places_;
  std::vector<std::uint32_t> front_, back_;
};

std::string face_name(const Pattern& pattern, std::size_t f) {
  const auto face = pattern.face(f);
  bool same_x = !face.empty(), same_z = same_x;
  for (const std::uint32_t i : face) {
    same_x = same_x && pattern.vertices[i].x == pattern.vertices[face[0]].x;
    same_z = same_z && pattern.vertices[i].z == pattern.vertices[face[0]].z;
  }
  const char* kind = "face";
  if (same_x && !same_z) kind = pattern.vertices[face[0]].x == 0 ? "wall" : "upright";
  if (same_z && !same_x) kind = pattern.vertices[face[0]].z == 0 ? "ground" : "level";
  return fmt::format("{} {}", kind, f);
}

/// The nodes, their paper and their movement, of one pattern or several.
class Scene {
 public:
  explicit Scene(const GlbOptions& options) : options_(options), store_(model_) {
    model_.asset.version = "2.0";
    model_.asset.generator = options_.creator;
    model_.materials = {material("paper front", {0.96, 0.80, 0.52, 1}),
                        material("paper back", {0.93, 0.94, 0.95, 1})};
    animation_.name = "deploy";
  }

  Result<std::string> pattern_alone(const Pattern& pattern, const PoseTable& table) {
    if (auto sound = check_faces(pattern.faces()); !sound) return tl::unexpected(sound.error());
    tinygltf::Node root;
    root.name = pattern.name.empty() ? "popcut" : pattern.name;
    root.scale = kMmToM;
    // x away from the wall becomes z, v becomes x, z becomes y: a third of a turn about (1, 1, 1).
    root.rotation = {-0.5, -0.5, -0.5, 0.5};
    if (!options_.front.png.empty()) add_picture();
    const auto children = add_bodies(pattern, table);
    if (!children) return tl::unexpected(children.error());
    root.children = *children;
    add_root(std::move(root));
    if (table.poses() > 1) add_motion(table, 0);
    return written(table);
  }

  Result<std::string> book(std::span<const GlbCard> cards, const std::string& name) {
    std::size_t faces = 0;
    for (const GlbCard& card : cards) faces += card.pattern->faces();
    if (auto sound = check_faces(faces); !sound) return tl::unexpected(sound.error());
    tinygltf::Node root;
    root.name = name.empty() ? "popcut" : name;
    root.scale = kMmToM;  // v, along the spine, is up already
    for (std::size_t i = 0; i < cards.size(); ++i) {
      const auto& [pattern, table] = cards[i];
      const auto first = static_cast<int>(model_.nodes.size());
      auto children = add_bodies(*pattern, *table);
      if (!children) return tl::unexpected(children.error());
      if (table->poses() > 1) add_motion(*table, first);
      tinygltf::Node node;
      node.name = fmt::format("card {}", i + 1);
      node.children = std::move(*children);
      const rigid::Turn turn = turn_of_card(i, table->psi_rad.back());
      node.rotation.assign(turn.coeffs().begin(), turn.coeffs().end());
      root.children.push_back(static_cast<int>(model_.nodes.size()));
      model_.nodes.push_back(std::move(node));
      if (table->poses() > 1 && i > 0) add_card_track(*table, i);
    }
    add_root(std::move(root));
    return written(*cards.front().table);
  }

 private:
  inline static const std::vector<double> kMmToM{0.001, 0.001, 0.001};

  static Result<void> check_faces(std::size_t faces) {
    if (faces <= kMaxGlbFaces) return {};
    return fail(ErrorKind::OutOfRange, "faces",
                fmt::format("{} are too many for one animation; at most {} can be moved", faces,
                            kMaxGlbFaces));
  }

  Result<std::string> written(const PoseTable& table) {
    if (!animation_.channels.empty()) {
      animation_.extras = tinygltf::Value(
          tinygltf::Value::Object{{"psi_from_rad", tinygltf::Value(table.psi_rad.front())},
                                  {"psi_to_rad", tinygltf::Value(table.psi_rad.back())}});
      model_.animations.push_back(std::move(animation_));
    }
    store_.finish();
    std::ostringstream out;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model_, out, false, true) || !out)
      return fail(ErrorKind::Internal, "deploy.glb", "the glTF library cannot write it");
    return std::move(out).str();
  }

  void add_picture() {
    tinygltf::Image image;
    image.bufferView = store_.picture(options_.front.png);
    image.mimeType = "image/png";
    model_.images.push_back(std::move(image));
    tinygltf::Sampler sampler;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    model_.samplers.push_back(sampler);
    tinygltf::Texture texture;
    texture.sampler = 0, texture.source = 0;
    model_.textures.push_back(std::move(texture));
    auto& front = model_.materials[kFront].pbrMetallicRoughness;
    front.baseColorFactor = {1, 1, 1, 1};
    front.baseColorTexture.index = 0;
  }

  void add_root(tinygltf::Node root) {
    model_.scenes.emplace_back();
    model_.scenes.front().nodes = {static_cast<int>(model_.nodes.size())};
    model_.defaultScene = 0;
    model_.nodes.push_back(std::move(root));
  }

  /// The bodies of a pattern as they stand in the last pose, a node each.
  ///
  /// @return the nodes that hang on nothing
  Result<std::vector<int>> add_bodies(const Pattern& pattern, const PoseTable& table) {
    const auto faces = triangulate_faces(pattern);
    if (!faces) return tl::unexpected(faces.error());
    std::vector<int> roots;
    const std::size_t bodies = table.bodies(), first = model_.nodes.size();
    const std::size_t rest = table.poses() - 1;
    model_.nodes.resize(first + bodies);
    for (std::size_t b = 0; b < bodies; ++b) {
      tinygltf::Node& node = model_.nodes[first + b];
      const Vec3 place = joint_place(table, rest, b);
      const rigid::Turn turn = joint_turn(table, rest, b);
      node.name = b < table.faces ? face_name(pattern, b) : fmt::format("link {}", b);
      node.translation.assign(place.begin(), place.end());
      node.rotation.assign(turn.coeffs().begin(), turn.coeffs().end());
      if (b < table.faces) {
        const FacePaper paper(*faces, b, table.pivot[b], pattern.wall_mm,
                              options_.front.png.empty() ? nullptr : &options_.front);
        node.mesh = static_cast<int>(model_.meshes.size());
        model_.meshes.push_back(options_.thickness_mm > 0
                                    ? paper.solid(store_, options_.thickness_mm)
                                    : paper.surface(store_));
        model_.meshes.back().name = node.name;
      }
      const std::int32_t parent = table.parent[b];
      auto& siblings =
          parent < 0 ? roots : model_.nodes[first + static_cast<std::size_t>(parent)].children;
      siblings.push_back(static_cast<int>(first + b));
    }
    return roots;
  }

  [[nodiscard]] int time_track(const PoseTable& table, const std::vector<std::size_t>& keys) {
    const double from = table.psi_rad.front(), to = table.psi_rad.back();
    std::vector<float> times;
    times.reserve(keys.size());
    for (const std::size_t k : keys)
      times.push_back(
          static_cast<float>(options_.seconds * (table.psi_rad[k] - from) / (to - from)));
    return store_.track(times, keys.size(), TINYGLTF_TYPE_SCALAR, true);
  }

  /// How the bodies of a pattern move, whose first node is `first`.
  void add_motion(const PoseTable& table, int first) {
    const std::vector<std::size_t> keys = animation_keys(table);
    const int input = time_track(table, keys);
    for (std::size_t b = 0; b < table.bodies(); ++b) {
      const int node = first + static_cast<int>(b);
      add_track(input, node, "rotation", TINYGLTF_TYPE_VEC4, turns_of(table, keys, b));
      if (table.parent[b] < 0 && shifts(table, keys, b))
        add_track(input, node, "translation", TINYGLTF_TYPE_VEC3, places_of(table, keys, b));
    }
  }

  /// A card of a book is turned about the spine by the openings of those before it: x toward z.
  static rigid::Turn turn_of_card(std::size_t card, double psi_rad) {
    return rigid::Turn(Eigen::AngleAxisd(-static_cast<double>(card) * psi_rad, Vec3(0, 1, 0)));
  }

  void add_card_track(const PoseTable& table, std::size_t card) {
    std::vector<std::size_t> keys(table.poses());
    std::iota(keys.begin(), keys.end(), std::size_t{0});
    std::vector<float> numbers;
    rigid::Turn last = rigid::kNoTurn;
    for (const std::size_t k : keys) {
      last = rigid::toward(turn_of_card(card, table.psi_rad[k]), last);
      for (const double part : last.coeffs()) numbers.push_back(static_cast<float>(part));
    }
    add_track(time_track(table, keys), static_cast<int>(model_.nodes.size()) - 1, "rotation",
              TINYGLTF_TYPE_VEC4, numbers);
  }

  /// Adds a track unless it stays what it is; tracks with equal numbers share a sampler.
  void add_track(int input, int node, const char* path, int type,
                 const std::vector<float>& numbers) {
    const std::size_t width = type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
    bool moves = false;
    for (std::size_t i = width; i < numbers.size(); ++i)
      moves = moves || numbers[i] != numbers[i - width];
    if (!moves) return;
    const int output = store_.track(numbers, numbers.size() / width, type, false);
    const auto [known, fresh] =
        sampler_of_.try_emplace(std::pair(input, output), animation_.samplers.size());
    if (fresh) {
      tinygltf::AnimationSampler sampler;
      sampler.input = input;
      sampler.output = output;
      sampler.interpolation = "LINEAR";
      animation_.samplers.push_back(std::move(sampler));
    }
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(known->second);
    channel.target_node = node;
    channel.target_path = path;
    animation_.channels.push_back(std::move(channel));
  }

  static std::vector<float> turns_of(const PoseTable& table, const std::vector<std::size_t>& keys,
                                     std::size_t body) {
    std::vector<float> numbers;
    rigid::Turn last = rigid::kNoTurn;
    for (const std::size_t k : keys) {
      const rigid::Turn turn = rigid::toward(joint_turn(table, k, body), last);
      // Parts below float precision are noise; without it equal tracks are equal.
      constexpr double kNoise = 1e-9;
      for (const double part : turn.coeffs())
        numbers.push_back(std::abs(part) < kNoise ? 0.0F : static_cast<float>(part));
      last = turn;
    }
    return numbers;
  }

  static bool shifts(const PoseTable& table, const std::vector<std::size_t>& keys,
                     std::size_t root) {
    constexpr double kStillMm = 1e-7;
    const Vec3 first = joint_place(table, keys.front(), root);
    return std::any_of(keys.begin(), keys.end(), [&](std::size_t k) {
      return norm(joint_place(table, k, root) - first) > kStillMm;
    });
  }

  static std::vector<float> places_of(const PoseTable& table, const std::vector<std::size_t>& keys,
                                      std::size_t body) {
    std::vector<float> numbers;
    for (const std::size_t k : keys)
      for (const double value : joint_place(table, k, body))
        numbers.push_back(static_cast<float>(value));
    return numbers;
  }

  const GlbOptions& options_;
  tinygltf::Model model_;
  tinygltf::Animation animation_;
  Store store_;
  std::map<std::pair<int, int>, std::size_t> sampler_of_;  ///< by times and values
};

}  // namespace

Result<std::string> glb(const Pattern& pattern, const PoseTable& table, const GlbOptions& options) {
  return Scene(options).pattern_alone(pattern, table);
}

Result<std::string> book_glb(std::span<const GlbCard> cards, const std::string& name,
                             const GlbOptions& options) {
  if (cards.empty()) return fail(ErrorKind::OutOfRange, "cards", "are none; give one at least");
  return Scene(options).book(cards, name);
}

}  // namespace popcut
