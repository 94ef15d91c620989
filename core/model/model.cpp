// SPDX-License-Identifier: MIT
#include "core/model/model.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/model/model_readers.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace model_readers {
namespace {

using namespace std::string_view_literals;

constexpr double kMostCoordinate = std::numeric_limits<float>::max();

}  // namespace

Result<void> check_triangles(const std::string& name, std::size_t count) {
  if (count <= kMaxTriangles) return {};
  return fail(
      ErrorKind::OutOfRange, name,
      fmt::format("has {} triangles; at most {} are read: reduce the mesh", count, kMaxTriangles));
}

Result<std::int32_t> add_picture(Model& model, const ModelOptions& options,
                                 const std::string& place, ModelPicture picture,
                                 std::string_view bytes) {
  if (options.take_picture)
    if (auto taken = options.take_picture(picture.name, bytes); !taken)
      return tl::unexpected(within(place, taken.error()));
  model.pictures.push_back(std::move(picture));
  return static_cast<std::int32_t>(model.pictures.size() - 1);
}

std::string_view plain_lines(std::string_view bytes, std::string& kept) {
  std::string text(plain_text(bytes, kept));
  constexpr std::array kBlanks{"\xC2\xA0"sv, "\xE2\x80\xAF"sv, "\xE3\x80\x80"sv, "\xEF\xBB\xBF"sv};
  bool changed = false;
  for (const std::string_view blank : kBlanks)
    for (std::size_t at = 0; (at = text.find(blank, at)) != text.npos; changed = true)
      text.replace(at, blank.size(), blank.size(), ' ');
  // In Latin-1 it is one byte, which UTF-8 has only after others.
  for (std::size_t at = 0; (at = text.find('\xA0', at)) != text.npos; ++at)
    if (at == 0 || (text[at - 1] & 0x80) == 0) text[at] = ' ', changed = true;
  if (!changed) return plain_text(bytes, kept);
  kept = std::move(text);
  return kept;
}

Result<double> read_coordinate(const std::string& name, std::size_t number, std::string_view word) {
  const std::string_view shown = word.substr(0, 24);
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size() || error == std::errc::invalid_argument)
    return fail(ErrorKind::Malformed, line_place(name, number),
                fmt::format("has \"{}\" where a number is needed; a vertex has three", shown));
  const bool tiny = error == std::errc::result_out_of_range && word.find("e-") != word.npos;
  if ((error != std::errc{} && !tiny) || !(std::abs(value) <= kMostCoordinate))
    return fail(
        ErrorKind::OutOfRange, line_place(name, number),
        fmt::format("has the coordinate {}; a finite number is needed: repair the mesh", shown));
  return value;
}

Result<std::array<double, 3>> read_vertex(const std::string& name, std::size_t number,
                                          std::string_view& words) {
  std::array<double, 3> out{};
  for (double& value : out) {
    const auto read = read_coordinate(name, number, next_word(words));
    if (!read) return tl::unexpected(read.error());
    value = *read;
  }
  return out;
}

}  // namespace model_readers

namespace {

std::string extension(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? "" : lower(std::string_view(name).substr(dot + 1));
}

/// The format of a file whose name has no extension, as assets are named. An OBJ is text with
/// vertices in it, a .gltf begins with a brace.
std::string kind_by_bytes(std::string_view bytes) {
  std::string kept;
  if (bytes.starts_with("glTF")) return "gltf";
  const std::string_view begin = trimmed(plain_text(bytes.substr(0, 256), kept));
  if (begin.starts_with('{')) return "gltf";
  const bool stl =
      lower(begin.substr(0, 5)) == "solid" || begin.find('\0') != std::string_view::npos;
  return stl || (kept.empty() && bytes.find('\0') != std::string_view::npos) ? "stl" : "obj";
}

/// Takes the model to the origin along each axis on which it lies very far from there, as in site
/// coordinates: a float would keep little of its shape, and no card reaches there.
void move_near(Model& model) {
  constexpr double kFar = 100.0;  // times its size
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < model.corners.size(); ++k) {
    low[k % 3] = std::min(low[k % 3], model.corners[k]);
    high[k % 3] = std::max(high[k % 3], model.corners[k]);
  }
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) size = std::max(size, high[k] - low[k]);
  for (std::size_t k = 0; k < 3; ++k)
    if (const double far = std::max(low[k], -high[k]); far > kFar * size) model.moved[k] = -low[k];
  if (model.moved == std::array<double, 3>{}) return;
  for (std::size_t k = 0; k < model.corners.size(); ++k) model.corners[k] += model.moved[k % 3];
}

Result<Model> read_as(const std::string& kind, const std::string& name, std::string_view bytes,
                      const ModelOptions& options) {
  using namespace model_readers;
  if (kind == "glb" || kind == "gltf") return read_gltf(name, bytes, options);
  if (kind == "obj") return read_obj(name, bytes, options);
  if (kind == "stl") return read_stl(name, bytes);
  return fail(
      ErrorKind::Malformed, name,
      fmt::format("is a \"{}\" file; meshes are read from .stl, .obj, .glb and .gltf", kind));
}

}  // namespace

Result<Model> read_model(const std::string& name, std::string_view bytes,
                         const ModelOptions& options) {
  using namespace model_readers;
  if (const auto foreign = foreign_kind(bytes); !foreign.empty() && !is_whole_binary_stl(bytes))
    return fail(ErrorKind::Malformed, name,
                fmt::format("is {}; give a 3D model as an STL, OBJ or GLB file", foreign));
  std::string kind = extension(name);
  if (kind.empty()) kind = kind_by_bytes(bytes);
  auto model = read_as(kind, name, bytes, options);
  if (model) move_near(*model);
  return model;
}

Result<TriangleMesh> read_mesh(const std::string& name, std::string_view bytes,
                               std::vector<std::string>* notes) {
  const auto model = read_model(name, bytes);
  if (!model) return tl::unexpected(model.error());
  if (const auto& by = model->moved; notes != nullptr && by != std::array<double, 3>{})
    notes->push_back(fmt::format(
        "the model lies far from its origin and is moved there: by {:.10g}, {:.10g}, {:.10g}",
        by[0], by[1], by[2]));
  if (notes != nullptr && model->corners_left_over > 0)
    notes->push_back(
        fmt::format("corners of the model that make no whole triangle, {}: popcut leaves them out",
                    model->corners_left_over));
  TriangleMesh mesh;
  mesh.corners.reserve(model->corners.size());
  for (const double value : model->corners) mesh.corners.push_back(static_cast<float>(value));
  return mesh;
}

}  // namespace popcut
