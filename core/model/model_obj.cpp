// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/triangulate.hpp"
#include "core/model/model_readers.hpp"
#include "core/text/utf8.hpp"

namespace popcut::model_readers {
namespace {

using Vertex = std::array<double, 3>;

constexpr std::size_t kLongestLine = 1u << 16;
constexpr std::string_view kSpaces = " \t\r";
constexpr ModelColour kWhite{1, 1, 1};
/// Three or four numbers after a vertex; those that are not there are -1 until all are read.
using VertexColour = std::array<float, 4>;
constexpr VertexColour kNoColour{-1, -1, -1, -1};

/// The vertex that one "v", "v/t" or "v/t/n" of a face names: counted from 1, or with a minus
/// backward from the last one before the face.
///
/// @param before    vertices before the face
/// @param vertices  of the file
std::optional<std::size_t> named_vertex(std::string_view word, std::size_t before,
                                        std::size_t vertices) {
  const bool backward = !word.empty() && word.front() == '-';
  if (backward) word.remove_prefix(1);
  std::size_t value = 0, digits = 0;
  for (; digits < word.size() && word[digits] >= '0' && word[digits] <= '9' && digits < 10;
       ++digits)
    value = 10 * value + static_cast<std::size_t>(word[digits] - '0');
  if (digits == 0 || (digits < word.size() && word[digits] != '/')) return std::nullopt;
  if (word.find_first_not_of("0123456789-/", digits) != std::string_view::npos) return std::nullopt;
  if (value < 1 || value > (backward ? before : vertices)) return std::nullopt;
  return backward ? before - value : value - 1;
}

/// A polygon as triangles of its corners, counted from its first: a fan where it is convex, else by
/// its ears, as it is seen from where it looks largest. What is no simple polygon is a fan too.
///
/// @param face    its corners as indices of `vertices`, at least three
/// @param effort  pairs of corners that may be compared yet
/// @return none if the effort is used up
std::optional<std::vector<Triangle>> polygon_triangles(std::span<const Vertex> vertices,
                                                       const std::vector<std::uint32_t>& face,
                                                       std::size_t& effort) {
  std::vector<Vec3> corners;
  corners.reserve(face.size());
  for (const std::uint32_t i : face)
    corners.push_back(Eigen::Vector3d(vertices[i].data()) -
                      Eigen::Vector3d(vertices[face[0]].data()));
  Vec3 normal;
  for (std::size_t k = 2; k < corners.size(); ++k) normal += corners[k - 1].cross(corners[k]);
  std::vector<Triangle> fan;
  bool convex = true;
  for (std::uint32_t k = 2; k < corners.size(); ++k) {
    fan.push_back({0, k - 1, k});
    convex = convex && corners[k - 1].cross(corners[k]).dot(normal) >= 0.0;
  }
  if (convex) return fan;
  const std::size_t pairs = face.size() * face.size();
  if (pairs > effort) return std::nullopt;
  effort -= pairs;
  Eigen::Index along{};
  normal.cwiseAbs().maxCoeff(&along);
  const Eigen::Index u = (along + 1) % 3, v = (along + 2) % 3;
  std::vector<Vec2> seen;
  seen.reserve(corners.size());
  for (const Vec3& p : corners) seen.emplace_back(normal[along] < 0.0 ? -p[u] : p[u], p[v]);
  std::vector<std::uint32_t> all(corners.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<Triangle> ears;
  return triangulate(seen, all, ears) ? ears : fan;
}

/// Reads up to `numbers.size()` finite numbers. @return how many stand before another word
std::size_t numbers_of(std::string_view line, std::span<float> numbers) {
  std::size_t count = 0;
  while (count < numbers.size()) {
    const std::string_view word = next_word(line, kSpaces);
    if (!read_number(word, numbers[count]) || !std::isfinite(numbers[count])) break;
    ++count;
  }
  return count;
}

/// The name of a file as a model gives it, in quotes or not, with slashes of either kind: one name
/// for each file.
std::string plain_name(std::string_view name) {
  if (name.size() > 1 && name.front() == '"' && name.back() == '"')
    name = name.substr(1, name.size() - 2);
  std::string out(name.starts_with('/') || name.starts_with('\\') ? "/" : "");
  std::vector<std::size_t> ends;  // where folders of the name end that ".." takes back
  while (!name.empty()) {
    const std::string_view part = take_word(name, "/\\");
    if (part.empty() || part == ".") continue;
    if (part == ".." && !ends.empty()) {
      out.resize(ends.back());
      ends.pop_back();
      continue;
    }
    const std::size_t before = out.size();
    if (!out.empty() && out.back() != '/') out += '/';
    out += part;
    if (part != "..") ends.push_back(before);
  }
  return out;
}

/// Removes the first name of a file from a line, which may be in quotes.
std::string_view next_name(std::string_view& line) {
  line = trimmed(line, kSpaces);
  const std::size_t end = line.starts_with('"') ? line.find('"', 1) : std::string_view::npos;
  if (end == std::string_view::npos) return next_word(line, kSpaces);
  const std::string_view name = line.substr(0, end + 1);
  line.remove_prefix(end + 1);
  return name;
}

/// `text` without a comment behind it.
std::string_view without_comment(std::string_view text) {
  for (const std::string_view sign : {" #", "\t#"}) text = text.substr(0, text.find(sign));
  return trimmed(text, kSpaces);
}

/// How a picture lies on a model: a place of the texture is scaled, then moved.
struct MapOptions {
  std::array<float, 2> scale{1, 1}, offset{0, 0};
  bool clamps{false};

  /// @param place  in the picture, down from its top
  [[nodiscard]] std::array<float, 2> moved(const std::array<float, 2>& place) const {
    return {scale[0] * place[0] + offset[0], 1 - (scale[1] * (1 - place[1]) + offset[1])};
  }
};

/// The file of a "map_Kd" line: what stands after its options, each with its own count of words.
std::string_view picture_name(std::string_view line, MapOptions& options) {
  static const std::map<std::string_view, int> kWords{
      {"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-mm", 2},      {"-o", 3}, {"-s", 3},
      {"-t", 3},      {"-texres", 1}, {"-clamp", 1}, {"-imfchan", 1}, {"-bm", 1}};
  while (!line.empty() && line.front() == '-') {
    std::string_view after = line;
    const auto known = kWords.find(lower(next_word(after, kSpaces)));
    if (known == kWords.end()) break;
    line = after;
    for (std::size_t k = 0; k < static_cast<std::size_t>(known->second); ++k) {
      std::string_view rest = line;
      const std::string_view word = next_word(rest, kSpaces);
      float number{};
      const bool is_number = read_number(word, number) && std::isfinite(number);
      // Of three numbers, the last ones may be left out.
      if (k > 0 && known->second == 3 && !is_number) break;
      line = rest;
      if (is_number && k < 2 && known->first == "-s") options.scale[k] = number;
      if (is_number && k < 2 && known->first == "-o") options.offset[k] = number;
      if (known->first == "-clamp") options.clamps = same_word(word, "on");
    }
    line = trimmed(line, kSpaces);
  }
  return line;
}

/// Whether a line begins with this letter, in either case, as a word of its own.
bool is_key(std::string_view line, char key) {
  return line.size() > 1 && lower(line[0]) == key && is_blank(line[1]);
}

/// Whether a line is a face: "f", or "fo" as in the first version of the format.
bool is_face_line(std::string_view line) {
  return is_key(line, 'f') || (line.starts_with("fo") && line.size() > 2 && is_blank(line[2]));
}

/// Whether a line is a surface that is not made of faces: "surf", or its patches in the first
/// version of the format (Wavefront, appendix B1). Curves are no surfaces.
bool is_free_form(std::string_view line) {
  for (const std::string_view word : {"surf", "bzp", "bsp", "cdp"})
    if (line.starts_with(word) && line.size() > word.size() && is_blank(line[word.size()]))
      return true;
  return false;
}

/// Whether a line begins with a word that an entry begins with.
bool begins_entry(std::string_view line) {
  for (const std::string_view word :
       {"v", "vt", "vn", "f", "fo", "surf", "g", "o", "s", "usemtl", "mtllib"})
    if (line.starts_with(word) && line.size() > word.size() && is_blank(line[word.size()]))
      return true;
  return false;
}

/// The first word of a line of colours, and what follows it.
struct Entry {
  std::string_view key, rest;
  std::size_t number{};  ///< of the line

  Entry(std::string_view line, std::size_t at) : rest(line), number(at) {
    key = next_word(rest, kSpaces);
    rest = trimmed(rest, kSpaces);
  }
};

/// The materials of the MTL files that an OBJ names.
class Materials {
 public:
  Materials(Model& model, const ModelOptions& options) : model_(model), options_(options) {}

  /// Reads the MTL files that a line names: one whose name may hold blanks, or several.
  /// @param place  of the line
  Result<void> read_all(std::string_view names, const std::string& place) {
    const std::string whole = plain_name(names);
    if (!read_.insert(whole).second) return {};
    if (const auto bytes = opened(whole)) return read(whole, *bytes);
    if (const std::string_view plain = without_comment(names); plain != names) {
      read_.erase(whole);
      return read_all(plain, place);
    }
    std::vector<std::string> files;
    for (std::string_view word = next_name(names); !word.empty(); word = next_name(names))
      files.push_back(plain_name(word));
    if (files.size() < 2) return unreadable(whole, place);
    for (const std::string& file : files) {
      if (!read_.insert(file).second) continue;
      const auto bytes = opened(file);
      if (!bytes) return unreadable(file, place);
      if (auto done = read(file, *bytes); !done) return done;
    }
    return {};
  }

  /// The index of a material in the model.
  [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const {
    for (const std::string_view text : {name, without_comment(name)})
      if (const auto known = by_name_.find(text); known != by_name_.end()) return known->second;
    return std::nullopt;
  }

  /// The index of a material without its picture, for faces that have no place in it.
  [[nodiscard]] std::uint32_t without_picture(std::uint32_t material) {
    if (model_.materials[material].picture < 0) return material;
    const auto [known, fresh] =
        plain_.try_emplace(material, static_cast<std::uint32_t>(model_.materials.size()));
    if (fresh) {
      ModelMaterial plain = model_.materials[material];
      plain.picture = -1;
      model_.materials.push_back(plain);
    }
    return known->second;
  }

  /// Where a place of a texture lies in the picture of a material.
  [[nodiscard]] std::array<float, 2> moved(std::uint32_t material,
                                           const std::array<float, 2>& place) const {
    const auto known = moved_.find(material);
    return known == moved_.end() ? place : known->second.moved(place);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> unreadable(const std::string& file,
                                                 const std::string& place) const {
    return fail(ErrorKind::Malformed, place,
                fmt::format("the materials {} cannot be read; {}", file, options_.advice));
  }

  [[nodiscard]] std::optional<std::string> opened(const std::string& file) const {
    if (!options_.open) return std::nullopt;
    auto bytes = options_.open(file);
    return bytes ? std::optional(std::move(*bytes)) : std::nullopt;
  }

  Result<void> read(const std::string& file, const std::string& bytes) {
    std::uint32_t now = 0;
    std::string kept;
    std::map<std::uint32_t, ModelColour> emitted;  // of materials
    auto done = for_each_line(
        plain_lines(bytes, kept), [&](std::string_view line, std::size_t number) -> Result<void> {
          const Entry entry(line, number);
          if (same_word(entry.key, "newmtl")) {
            now = static_cast<std::uint32_t>(model_.materials.size());
            model_.materials.push_back({kWhite});
            by_name_[std::string(entry.rest)] = now;
            by_name_.try_emplace(std::string(without_comment(entry.rest)), now);
          }
          if (now == 0) return {};
          if (same_word(entry.key, "Kd")) return colour(entry, file, model_.materials[now]);
          if (same_word(entry.key, "map_Kd")) return picture(entry, file, now);
          if (entry.key == "d") dissolve(entry, model_.materials[now]);
          if (same_word(entry.key, "Ke")) numbers_of(entry.rest, emitted[now]);
          return {};
        });
    // What reflects nothing shows what it gives off itself.
    for (const auto& [number, colour] : emitted) {
      ModelMaterial& material = model_.materials[number];
      if (material.colour == ModelColour{} && material.picture < 0) material.colour = colour;
      for (float& part : *material.colour) part = std::clamp(part, 0.0F, 1.0F);
    }
    return done;
  }

  static Result<void> colour(const Entry& entry, const std::string& file, ModelMaterial& material) {
    ModelColour kd{};
    const std::size_t count = numbers_of(entry.rest, kd);
    if (count == 0)
      return fail(ErrorKind::Malformed, line_place(file, entry.number),
                  "is not a colour; Kd needs numbers from 0 to 1, such as \"Kd 0.8 0.4 0.2\"");
    for (std::size_t k = count; k < 3; ++k) kd[k] = kd[0];  // a grey
    // Some programs write colours from 0 to 255.
    const float whole = *std::max_element(kd.begin(), kd.end()) > 2.0F ? 255.0F : 1.0F;
    for (float& part : kd) part = std::clamp(part / whole, 0.0F, 1.0F);
    material.colour = kd;
    return {};
  }

  static void dissolve(const Entry& entry, ModelMaterial& material) {
    std::array<float, 1> opaque{};
    if (numbers_of(entry.rest, opaque) == 1) material.is_clear = opaque[0] <= 0.0F;
  }

  Result<void> picture(const Entry& entry, const std::string& library, std::uint32_t number) {
    MapOptions options;
    const std::string_view given = picture_name(entry.rest, options);
    std::string file = plain_name(given);
    const auto [known, fresh] = pictures_.try_emplace({file, options.clamps}, 0);
    if (fresh) {
      const std::string place = line_place(library, entry.number);
      auto bytes = options_.open(file);
      if (!bytes && without_comment(given) != given) {
        file = plain_name(without_comment(given));
        bytes = options_.open(file);
      }
      if (!bytes)
        return fail(ErrorKind::Malformed, place,
                    fmt::format("the picture {} cannot be read; {}", file, options_.advice));
      ModelPicture made{file, {}};
      if (options.clamps) made.wraps.fill(PictureWrap::Clamp);
      const auto added = add_picture(model_, options_, place, std::move(made), *bytes);
      if (!added) return tl::unexpected(added.error());
      known->second = *added;
    }
    moved_.insert_or_assign(number, options);
    ModelMaterial& material = model_.materials[number];
    material.picture = known->second;
    // Many programs write a black Kd beside a picture and mean the picture alone.
    if (material.colour == ModelColour{}) material.colour = kWhite;
    return {};
  }

  Model& model_;
  const ModelOptions& options_;
  std::set<std::string> read_;  ///< files, each of which is read once
  std::map<std::string, std::uint32_t, std::less<>> by_name_;
  std::map<std::pair<std::string, bool>, std::int32_t> pictures_;  ///< and whether they clamp
  std::map<std::uint32_t, MapOptions> moved_;                      ///< by material
  std::map<std::uint32_t, std::uint32_t> plain_;                   ///< see `without_picture`
};

/// Reads vertices and faces, and colours on the way if they are asked for. What is wrong with the
/// shape goes before what is wrong with colours, so the first fault of those waits for the end.
class ObjReader {
 public:
  ObjReader(const std::string& name, const ModelOptions& options)
      : name_(name), colours_(options.colours), materials_(model_, options) {}

  Result<Model> read(std::string_view bytes) {
    if (colours_) model_.materials.emplace_back();
    // Faces may come before the vertices that they name, so those are read first.
    for (const Pass pass : {Pass::Vertices, Pass::Faces}) {
      places_so_far_ = vertices_so_far_ = 0;
      if (auto done = read_lines(bytes, pass); !done) return tl::unexpected(done.error());
      if (pass == Pass::Vertices) scale_colours();
    }
    if (vertices_.empty())
      return fail(ErrorKind::Malformed, name_, "has no vertices; is it an OBJ file?");
    if (model_.size() == 0)
      return fail(ErrorKind::Malformed, name_, "has no faces; a mesh needs some");
    if (colour_fault_) return tl::unexpected(*colour_fault_);
    if (!has_corner_colours_) model_.corner_colours.clear();
    return std::move(model_);
  }

 private:
  enum class Pass : std::uint8_t { Vertices, Faces };

  [[nodiscard]] Result<void> broken(std::string what) const {
    return fail(ErrorKind::Malformed, line_place(name_, number_), std::move(what));
  }

  /// Whether a line has numbers, and no name.
  static bool is_numbers(std::string_view line) {
    const char first = line.empty() ? '\0' : lower(line.front());
    return first == 'v' || first == 'f';
  }

  /// Whether a line ends in a comment, whose backslash may be that of a folder.
  static bool has_comment(std::string_view line, std::string_view begun) {
    return line.starts_with('#') ||
           (is_numbers(begun.empty() ? line : begun) && line.find('#') != line.npos);
  }

  /// Reads all lines; those that end with a backslash go on in the next one.
  Result<void> read_lines(std::string_view bytes, Pass pass) {
    std::string joined;
    const auto done =
        for_each_line(bytes, [&](std::string_view line, std::size_t number) -> Result<void> {
          // A name may end with a backslash, too.
          if (!joined.empty() && begins_entry(line) && !is_numbers(joined)) {
            const std::string whole = std::exchange(joined, {});
            if (auto read = read_line(trimmed(whole, kSpaces), pass); !read) return read;
          }
          if (joined.empty()) number_ = number;
          if (line.back() == '\\' && !has_comment(line, joined)) {
            joined.append(line.substr(0, line.size() - 1)) += ' ';
            return joined.size() > kLongestLine ? broken("is longer than 65536 characters")
                                                : Result<void>{};
          }
          if (joined.empty()) return read_line(line, pass);
          const std::string whole = std::exchange(joined, {}).append(line);
          return read_line(whole, pass);
        });
    return done && !joined.empty() ? read_line(joined, pass) : done;
  }

  Result<void> read_line(std::string_view line, Pass pass) {
    const bool is_vertex = is_key(line, 'v'), is_face = is_face_line(line);
    const bool is_place = line.starts_with("vt") && line.size() > 2 && is_blank(line[2]);
    // A comment may stand behind numbers; names may hold its sign.
    if (is_vertex || is_face || is_place) line = trimmed(line.substr(0, line.find('#')), kSpaces);
    if (is_free_form(line))
      return broken(
          "is a free-form surface, which popcut does not read; save the model as polygons");
    if (pass == Pass::Vertices) {
      if (is_vertex) return read_shape(line);
      if (is_place && reads_colours()) keep(read_picture_place(Entry(line, number_)));
      return {};
    }
    vertices_so_far_ += is_vertex ? 1U : 0U;
    places_so_far_ += is_place ? 1U : 0U;
    if (is_face) return read_shape(line);
    if (!is_vertex && !is_place && reads_colours()) keep(read_colours(Entry(line, number_)));
    return {};
  }
  [[nodiscard]] bool reads_colours() const { return colours_ && !colour_fault_; }
  void keep(Result<void> of_colours) {
    if (!of_colours && !colour_fault_) colour_fault_ = std::move(of_colours.error());
  }

  Result<void> read_shape(std::string_view line) {
    if (line.size() > kLongestLine) return broken("is longer than 65536 characters");
    const std::string_view rest = line.substr(line[1] == 'o' ? 2 : 1);
    return lower(line[0]) == 'v' ? read_vertex_line(rest) : read_face(rest);
  }

  Result<void> read_vertex_line(std::string_view rest) {
    const auto vertex = read_vertex(name_, number_, rest);
    if (!vertex) return tl::unexpected(vertex.error());
    vertices_.push_back(*vertex);
    if (colours_) colours_of_vertices_.push_back(colour_of_vertex(rest));
    return vertices_.size() > 3 * kMaxTriangles ? check_triangles(name_, kMaxTriangles + 1)
                                                : Result<void>{};
  }

  /// Some programs write colours from 0 to 1, others from 0 to 255: one above 1 tells. Some write a
  /// weight before them, others how opaque they are behind them: what is 1 everywhere tells.
  void scale_colours() {
    bool weighted = true, opaque = true;
    float most = 1;
    for (const VertexColour& colour : colours_of_vertices_) {
      most = std::max({most, colour[0], colour[1], colour[2], colour[3]});
      if (colour[3] < 0) continue;
      weighted = weighted && colour[0] == 1;
      opaque = opaque && (colour[3] == 1 || colour[3] == 255);
    }
    const float whole = most > 1 ? 255.0F : 1.0F;
    const bool skips = weighted && !opaque;
    for (VertexColour& colour : colours_of_vertices_) {
      if (skips && colour[3] >= 0) std::rotate(colour.begin(), colour.begin() + 1, colour.end());
      for (float& part : colour) part = part < 0 ? 1.0F : std::min(part / whole, 1.0F);
    }
  }

  /// "r g b" after the place of a vertex, or four numbers, see `scale_colours`.
  VertexColour colour_of_vertex(std::string_view rest) {
    VertexColour numbers{};
    const std::size_t count = numbers_of(rest, numbers);
    if (count < 3) return kNoColour;
    has_corner_colours_ = true;
    for (std::size_t k = 0; k < count; ++k) numbers[k] = std::max(numbers[k], 0.0F);
    if (count < 4) numbers[3] = -1;
    return numbers;
  }

  Result<void> read_face(std::string_view rest) {
    face_.clear(), places_.clear();
    unplaced_ = false;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const auto vertex = named_vertex(word, vertices_so_far_, vertices_.size());
      if (!vertex)
        return broken(fmt::format(
            "names vertex \"{}\"; a number from 1 to {}, the vertices of the file, is needed",
            word.substr(0, 24), vertices_.size()));
      face_.push_back(static_cast<std::uint32_t>(*vertex));
      if (reads_colours()) keep(add_picture_place(word));
    }
    if (face_.size() < 3) return broken("a face needs three vertices");
    triangles_ += face_.size() - 2;
    if (auto few = check_triangles(name_, triangles_); !few) return few;
    const auto triangles = polygon_triangles(vertices_, face_, effort_);
    if (!triangles)
      return fail(
          ErrorKind::OutOfRange, line_place(name_, number_),
          fmt::format(
              "has {} corners and is not convex, as faces before it; save the model as triangles",
              face_.size()));
    for (const Triangle& triangle : *triangles) add(triangle);
    return {};
  }

  void add(const Triangle& triangle) {
    for (const std::uint32_t k : triangle) {
      const Vertex& at = vertices_[face_[k]];
      model_.corners.insert(model_.corners.end(), at.begin(), at.end());
      if (!reads_colours()) continue;
      model_.picture_places.push_back(materials_.moved(material_, places_[k]));
      const auto& [r, g, b, a] = colours_of_vertices_[face_[k]];
      model_.corner_colours.push_back({r, g, b});
    }
    if (reads_colours())
      model_.material_of.push_back(unplaced_ ? materials_.without_picture(material_) : material_);
  }

  /// Keeps the place in a picture that "v/t/n" names, counted as vertices are; the corner if it
  /// names none.
  Result<void> add_picture_place(std::string_view word) {
    static_cast<void>(take_word(word, "/"));
    const std::string_view text = take_word(word, "/");
    places_.emplace_back();
    unplaced_ = unplaced_ || text.empty();
    if (text.empty()) return {};
    long long at = 0;
    const auto most = static_cast<long long>(picture_places_.size());
    const auto before = static_cast<long long>(places_so_far_);
    if (!read_number(text, at) || at == 0 || at > most || at < -std::min(before, most))
      return broken(
          fmt::format("names place {} of the texture; a number from 1 to {}, the vt lines of the "
                      "file, is needed",
                      text.substr(0, 24), most));
    places_.back() = picture_places_[static_cast<std::size_t>(at < 0 ? before + at : at - 1)];
    return {};
  }

  Result<void> read_picture_place(const Entry& entry) {
    std::array<float, 2> n{};
    if (numbers_of(entry.rest, n) == 0)
      return broken("is not a place in a texture; vt needs numbers, such as \"vt 0.5 0.25\"");
    picture_places_.push_back({n[0], 1.0F - n[1]});  // v of an OBJ goes up
    return {};
  }

  Result<void> read_colours(const Entry& entry) {
    if (same_word(entry.key, "mtllib"))
      return materials_.read_all(entry.rest, line_place(name_, number_));
    if (same_word(entry.key, "usemtl")) {
      const auto known = materials_.find(entry.rest);
      if (!known)
        return broken(
            fmt::format("names the material {}, which no mtllib before it defines; add "
                        "it, or leave the colours out",
                        entry.rest));
      material_ = *known;
      model_.uses_materials = true;
    }
    return {};
  }

  const std::string& name_;
  bool colours_;
  Model model_;
  Materials materials_;
  std::optional<Error> colour_fault_;
  std::size_t number_{}, triangles_{};
  std::size_t effort_{400'000'000};  ///< for faces that are not convex: a few seconds
  std::size_t vertices_so_far_{}, places_so_far_{};  ///< before the line that is read
  std::vector<Vertex> vertices_;
  std::vector<VertexColour> colours_of_vertices_;
  std::vector<std::array<float, 2>> picture_places_;
  std::vector<std::uint32_t> face_;           ///< vertices of the face that is read
  std::vector<std::array<float, 2>> places_;  ///< of its corners
  std::uint32_t material_{0};
  bool unplaced_{false};  ///< a corner of the face has no place in a picture
  bool has_corner_colours_{false};
};

}  // namespace

Result<Model> read_obj(const std::string& name, std::string_view bytes,
                       const ModelOptions& options) {
  std::string kept;
  return ObjReader(name, options).read(plain_lines(bytes, kept));
}

}  // namespace popcut::model_readers
