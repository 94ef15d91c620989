// SPDX-License-Identifier: MIT
#include "core/formats/fold_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/formats/json_data.hpp"
#include "core/json_fields.hpp"

namespace popcut {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxFrames = 1000;
constexpr std::size_t kMaxInFrames =
    30'000'000;  // vertices and edges of all frames, with inherited

// Reads the keys of one frame; the first fault stays.
class FrameReader {
 public:
  FrameReader(const Json& json, std::string pointer, FoldFrame& frame)
      : json_(json), pointer_(std::move(pointer)), frame_(frame) {}

  Result<void> read(bool needs_vertices) {
    if (!json_.is_object()) return wrong("", "a frame is an object", json_);
    read_words();
    if (auto done = vertices(needs_vertices); !done) return done;
    if (auto done = edges(); !done) return done;
    if (auto done = assignments(); !done) return done;
    if (auto done = angles(); !done) return done;
    return faces();
  }

 private:
  [[nodiscard]] std::string at(const std::string& key) const { return pointer_ + "/" + key; }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& key, const char* due,
                                            const Json& value) const {
    return fail(ErrorKind::Malformed, key.empty() && pointer_.empty() ? "/" : pointer_ + key,
                fmt::format("is {}; {}", json_type(value), due));
  }

  // The list at `key`, or null if there is none; `length` (if not 0) is the length it must have.
  Result<const Json*> list(const char* key, std::size_t length, const char* like) const {
    const auto found = json_.find(key);
    if (found == json_.end() || found->is_null()) return nullptr;
    if (!found->is_array()) return wrong(fmt::format("/{}", key), "a list is needed", *found);
    if (like != nullptr && found->size() != length)
      return fail(ErrorKind::Malformed, at(key),
                  fmt::format("has {} entries; {} has {}, and both must be equally long",
                              found->size(), like, length));
    return &*found;
  }

  void read_words() {
    const auto text = [&](const char* key, std::string& out) {
      const auto found = json_.find(key);
      if (found != json_.end() && found->is_string()) out = found->get<std::string>();
    };
    text("frame_title", frame_.title);
    text("frame_unit", frame_.unit);
    const auto psi = json_.find("frame_popcut:psi_rad");
    frame_.psi_rad.reset();
    if (psi != json_.end() && psi->is_number()) frame_.psi_rad = psi->get<double>();
    const auto classes = json_.find("frame_classes");
    if (classes == json_.end() || !classes->is_array()) return;
    frame_.folded_form = false;
    for (const Json& word : *classes)
      if (word.is_string() && word.get<std::string>() == "foldedForm") frame_.folded_form = true;
  }

  Result<void> vertices(bool needed) {
    const auto found = list("vertices_coords", 0, nullptr);
    if (!found) return tl::unexpected(found.error());
    if (*found == nullptr) {
      if (!needed) return {};
      std::vector<std::string> keys;
      for (const auto& item : json_.items())
        if (keys.size() < 200) keys.push_back(item.key());
      const std::string near = nearest_word("vertices_coords", keys);
      return fail(ErrorKind::Malformed, at("vertices_coords"),
                  near.empty() ? "is missing; the vertices' coordinates are needed"
                               : fmt::format("is missing; is \"{}\" meant to be it?", near));
    }
    frame_.vertices.clear();
    frame_.vertices.reserve((*found)->size());
    for (std::size_t i = 0; i < (*found)->size(); ++i) {
      const Json& point = (**found)[i];
      const std::string place = fmt::format("/vertices_coords/{}", i);
      if (!point.is_array() || point.size() < 2 || point.size() > 3)
        return wrong(place, "two or three coordinates are needed", point);
      std::array<double, 3> p{};
      for (std::size_t c = 0; c < point.size(); ++c) {
        if (!point[c].is_number())
          return wrong(fmt::format("{}/{}", place, c), "a number is needed", point[c]);
        p[c] = point[c].get<double>();
        if (!std::isfinite(p[c]))
          return fail(ErrorKind::OutOfRange, fmt::format("{}{}/{}", pointer_, place, c),
                      "is not a finite number");
      }
      frame_.vertices.push_back(p);
    }
    return {};
  }

  Result<std::uint32_t> index(const Json& value, const std::string& place) const {
    if (!value.is_number_integer()) return wrong(place, "the index of a vertex is needed", value);
    const auto i = value.is_number_unsigned() ? value.get<std::uint64_t>() : ~std::uint64_t{0};
    if (i >= frame_.vertices.size())
      return fail(ErrorKind::OutOfRange, pointer_ + place,
                  fmt::format("is {}; there are {} vertices, so at most {}", value.dump(),
                              frame_.vertices.size(),
                              static_cast<std::int64_t>(frame_.vertices.size()) - 1));
    return static_cast<std::uint32_t>(i);
  }

  Result<void> edges() {
    const auto found = list("edges_vertices", 0, nullptr);
    if (!found) return tl::unexpected(found.error());
    if (*found == nullptr) return recheck_edges();
    frame_.edges.clear();
    frame_.edges.reserve((*found)->size());
    for (std::size_t i = 0; i < (*found)->size(); ++i) {
      const Json& edge = (**found)[i];
      const std::string place = fmt::format("/edges_vertices/{}", i);
      if (!edge.is_array() || edge.size() != 2)
        return wrong(place, "two vertices are needed", edge);
      std::array<std::uint32_t, 2> ends{};
      for (std::size_t e = 0; e < 2; ++e) {
        const auto vertex = index(edge[e], fmt::format("{}/{}", place, e));
        if (!vertex) return tl::unexpected(vertex.error());
        ends[e] = *vertex;
      }
      frame_.edges.push_back(ends);
    }
    frame_.assignments.assign(frame_.edges.size(), 'U');
    frame_.fold_angles_deg.assign(frame_.edges.size(), 0.0);
    return {};
  }

  // A frame that inherits edges but brings vertices of its own must have enough of them.
  Result<void> recheck_edges() const {
    for (const auto& edge : frame_.edges)
      if (std::max(edge[0], edge[1]) >= frame_.vertices.size())
        return fail(ErrorKind::OutOfRange, at("vertices_coords"),
                    fmt::format("has {} vertices; inherited edges ask for vertex {}",
                                frame_.vertices.size(), std::max(edge[0], edge[1])));
    return {};
  }

  Result<void> assignments() {
    const auto found = list("edges_assignment", frame_.edges.size(), "edges_vertices");
    if (!found) return tl::unexpected(found.error());
    if (*found == nullptr) return {};
    for (std::size_t i = 0; i < (*found)->size(); ++i) {
      const Json& value = (**found)[i];
      if (value.is_null()) continue;
      const std::string word = value.is_string() ? value.get<std::string>() : "";
      const char letter = word.size() == 1 ? static_cast<char>(std::toupper(word[0])) : '?';
      if (std::string_view("BMVFUCJ").find(letter) == std::string_view::npos)
        return fail(ErrorKind::Malformed, fmt::format("{}/edges_assignment/{}", pointer_, i),
                    "is no assignment; one of B, M, V, F, U, C, J is needed");
      frame_.assignments[i] = letter;
    }
    return {};
  }

  Result<void> angles() {
    for (const char* key : {"edges_foldAngle", "edges_foldAngles"}) {
      const auto found = list(key, frame_.edges.size(), "edges_vertices");
      if (!found) return tl::unexpected(found.error());
      if (*found == nullptr) continue;
      for (std::size_t i = 0; i < (*found)->size(); ++i) {
        const Json& value = (**found)[i];
        if (value.is_null()) continue;
        if (!value.is_number())
          return wrong(fmt::format("/{}/{}", key, i), "degrees are needed", value);
        const double degrees = value.get<double>();
        if (!(std::abs(degrees) <= 360.0))
          return fail(ErrorKind::OutOfRange, fmt::format("{}/{}/{}", pointer_, key, i),
                      fmt::format("is {:g} degrees; from -180 to 180", degrees));
        frame_.fold_angles_deg[i] = degrees;
      }
    }
    return {};
  }

  Result<void> faces() {
    const auto found = list("faces_vertices", 0, nullptr);
    if (!found) return tl::unexpected(found.error());
    if (*found == nullptr) return {};
    frame_.faces.clear();
    frame_.faces.reserve((*found)->size());
    for (std::size_t i = 0; i < (*found)->size(); ++i) {
      const Json& face = (**found)[i];
      const std::string place = fmt::format("/faces_vertices/{}", i);
      if (!face.is_array()) return wrong(place, "a list of vertices is needed", face);
      std::vector<std::uint32_t> corners;
      corners.reserve(face.size());
      for (std::size_t c = 0; c < face.size(); ++c) {
        const auto vertex = index(face[c], fmt::format("{}/{}", place, c));
        if (!vertex) return tl::unexpected(vertex.error());
        corners.push_back(*vertex);
      }
      frame_.faces.push_back(std::move(corners));
    }
    return {};
  }

  const Json& json_;
  std::string pointer_;
  FoldFrame& frame_;
};

// The frame that `json` starts from: its parent if it inherits, else an empty one.
Result<FoldFrame> parent_of(const Json& json, const std::string& pointer, const FoldFile& file) {
  const auto inherit = json.find("frame_inherit");
  if (inherit == json.end() || !inherit->is_boolean() || !inherit->get<bool>()) return FoldFrame{};
  const auto parent = json.find("frame_parent");
  const bool known = parent != json.end() && parent->is_number_unsigned() &&
                     parent->get<std::uint64_t>() < file.frames.size();
  if (!known)
    return fail(ErrorKind::Malformed, pointer + "/frame_parent",
                "a frame that inherits needs the number of a frame before it");
  return file.frames[parent->get<std::size_t>()];
}

}  // namespace

Result<FoldFile> read_fold(std::string_view text) {
  const auto json = parse_json_data(text);
  if (!json) return tl::unexpected(json.error());
  FoldFile file;
  file.frames.emplace_back();
  if (auto key = FrameReader(*json, "", file.frames.front()).read(true); !key)
    return tl::unexpected(key.error());
  const auto title = json->find("file_title");
  if (title != json->end() && title->is_string()) file.title = title->get<std::string>();
  const auto frames = json->find("file_frames");
  if (frames == json->end() || frames->is_null()) return file;
  if (!frames->is_array() || frames->size() > kMaxFrames)
    return fail(ErrorKind::Malformed, "/file_frames",
                fmt::format("a list of at most {} frames is needed", kMaxFrames));
  std::size_t total = file.frames[0].vertices.size() + file.frames[0].edges.size();
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const std::string pointer = fmt::format("/file_frames/{}", i);
    if (!(*frames)[i].is_object())
      return fail(ErrorKind::Malformed, pointer, "a frame is an object");
    auto frame = parent_of((*frames)[i], pointer, file);
    if (!frame) return tl::unexpected(frame.error());
    if (auto done = FrameReader((*frames)[i], pointer, *frame).read(false); !done)
      return tl::unexpected(done.error());
    total += frame->vertices.size() + frame->edges.size();
    if (total > kMaxInFrames)
      return fail(ErrorKind::Malformed, pointer, "the frames together are too large to be read");
    file.frames.push_back(std::move(*frame));
  }
  return file;
}

}  // namespace popcut
