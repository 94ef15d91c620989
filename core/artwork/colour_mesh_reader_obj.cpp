// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/design/target/mesh_reader.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::string_view kSpaces = " \t\r";

/// The words of a line, one after the other.
std::string_view next(std::string_view& line) {
  line = trimmed(line, kSpaces);
  const std::string_view word = line.substr(0, line.find_first_of(kSpaces));
  line.remove_prefix(word.size());
  return word;
}

/// Up to `numbers.size()` finite numbers; how many there are before what is none.
std::size_t numbers_of(std::string_view line, std::span<float> numbers) {
  std::size_t count = 0;
  while (count < numbers.size()) {
    const std::string_view word = next(line);
    if (word.empty() || !read_number(word, numbers[count]) || !std::isfinite(numbers[count])) break;
    ++count;
  }
  return count;
}

template <typename Visit>
Result<void> each_line(std::string_view text, Visit&& visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = trimmed(take_word(text, "\n"), kSpaces);
    if (line.empty() || line.front() == '#') continue;
    const std::string_view key = next(line);
    if (auto done = visit(key, trimmed(line, kSpaces), number); !done) return done;
  }
  return {};
}

/// The file of a "map_Kd" line: what stands after its options, each with its own count of words.
std::string picture_name(std::string_view line) {
  static const std::map<std::string_view, int> kWords{
      {"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-mm", 2},      {"-o", 3}, {"-s", 3},
      {"-t", 3},      {"-texres", 1}, {"-clamp", 1}, {"-imfchan", 1}, {"-bm", 1}};
  while (!line.empty() && line.front() == '-') {
    const auto known = kWords.find(next(line));
    if (known == kWords.end()) break;
    for (int k = 0; k < known->second; ++k) {
      std::string_view rest = line;
      const std::string_view word = next(rest);
      float number{};
      // Of three numbers, the last ones may be left out.
      if (k > 0 && known->second == 3 && !read_number(word, number)) break;
      line = rest;
    }
    line = trimmed(line, kSpaces);
  }
  std::string name(line);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

class ObjColours {
 public:
  ObjColours(const std::string& name, const ModelFiles& files) : name_(name), files_(files) {
    mesh_.surfacings.push_back({{204, 160, 126, 255}});  // clay, where no material is named
  }

  Result<ColourMesh> read(std::string_view bytes) {
    const auto done = each_line(
        bytes,
        [&](std::string_view key, std::string_view line, std::size_t number) -> Result<void> {
          if (key == "v") return vertex(line);
          if (key == "vt") return texture_place(line, number);
          if (key == "f") return face(line, number);
          if (key == "mtllib") return library(std::string(line), number);
          if (key == "usemtl") return material(std::string(line), number);
          return {};
        });
    if (!done) return tl::unexpected(done.error());
    if (!any_tint_) mesh_.tint.clear();
    mesh_.coloured = any_tint_ || any_material_;
    if (!any_material_ && any_tint_) mesh_.surfacings.front().colour = {};
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::string line_of(std::size_t number) const {
    return fmt::format("{}: line {}", name_, number);
  }

  Result<void> vertex(std::string_view line) {
    std::array<float, 7> n{};
    const std::size_t count = numbers_of(line, n);
    places_.push_back({n[0], n[1], n[2]});
    // "x y z r g b", or with a weight before the colour.
    const std::size_t colour = count == 6 ? 3 : count == 7 ? 4 : 0;
    std::array<float, 3> tint{1, 1, 1};
    if (colour > 0) {
      any_tint_ = true;
      for (std::size_t k = 0; k < 3; ++k) tint[k] = std::clamp(n[colour + k], 0.0F, 1.0F);
    }
    tints_.push_back(tint);
    return {};
  }

  Result<void> texture_place(std::string_view line, std::size_t number) {
    std::array<float, 2> n{};
    if (numbers_of(line, n) == 0)
      return fail(ErrorKind::Malformed, line_of(number),
                  "is no place of a texture; vt needs numbers, such as \"vt 0.5 0.25\"");
    st_.push_back({n[0], 1.0F - n[1]});  // v of an OBJ goes up
    return {};
  }

  /// The number after the first slash of "v/t/n", counted from 0; none if there is none.
  [[nodiscard]] Result<std::optional<std::size_t>> place_named(std::string_view word,
                                                               std::size_t number) const {
    take_word(word, "/");
    const std::string_view text = take_word(word, "/");
    if (text.empty()) return std::optional<std::size_t>{};
    long long at = 0;
    const auto most = static_cast<long long>(st_.size());
    if (!read_number(text, at) || at == 0 || at > most || at < -most)
      return fail(ErrorKind::Malformed, line_of(number),
                  fmt::format("names place {} of the texture; a number from 1 to {}, the vt lines "
                              "before it, is needed",
                              text.substr(0, 24), most));
    return std::optional(static_cast<std::size_t>(at < 0 ? most + at : at - 1));
  }

  // `read_mesh` has read all faces before: each names at least three vertices that are there.
  Result<void> face(std::string_view line, std::size_t number) {
    face_.clear(), face_st_.clear();
    for (std::string_view word = next(line); !word.empty(); word = next(line)) {
      long long at = 0;
      if (!read_number(word.substr(0, word.find('/')), at)) continue;
      face_.push_back(static_cast<std::uint32_t>(
          at < 0 ? static_cast<long long>(places_.size()) + at : at - 1));
      const auto place = place_named(word, number);
      if (!place) return tl::unexpected(place.error());
      face_st_.push_back(*place ? st_[**place] : std::array<float, 2>{});
    }
    for (const Triangle& triangle : polygon_triangles(places_, face_)) {
      for (const std::uint32_t k : triangle) {
        const auto& p = places_[face_[k]];
        mesh_.soup.corners.insert(mesh_.soup.corners.end(), p.begin(), p.end());
        mesh_.st.push_back(face_st_[k]);
        mesh_.tint.push_back(tints_[face_[k]]);
      }
      mesh_.surfacing_of.push_back(surfacing_);
    }
    return {};
  }

  Result<void> library(const std::string& file, std::size_t number) {
    const auto bytes = files_.open(file);
    if (!bytes)
      return fail(ErrorKind::Malformed, line_of(number),
                  fmt::format("the materials {} cannot be read; {}", file, files_.advice));
    std::uint32_t now = 0;
    return each_line(
        *bytes, [&](std::string_view key, std::string_view line, std::size_t at) -> Result<void> {
          if (key == "newmtl") {
            now = static_cast<std::uint32_t>(mesh_.surfacings.size());
            mesh_.surfacings.emplace_back();
            materials_[std::string(line)] = now;
          }
          if (now == 0) return {};
          if (key == "Kd") {
            std::array<float, 3> kd{};
            const std::size_t count = numbers_of(line, kd);
            if (count == 0)
              return fail(ErrorKind::Malformed, fmt::format("{}: line {}", file, at),
                          "is no colour; Kd needs numbers from 0 to 1, such as \"Kd 0.8 0.4 0.2\"");
            for (std::size_t k = count; k < 3; ++k) kd[k] = kd[0];  // a grey
            mesh_.surfacings[now].colour = {255 * std::clamp(kd[0], 0.0F, 1.0F),
                                            255 * std::clamp(kd[1], 0.0F, 1.0F),
                                            255 * std::clamp(kd[2], 0.0F, 1.0F), 255};
          }
          if (key == "map_Kd") return picture(picture_name(line), file, at, mesh_.surfacings[now]);
          return {};
        });
  }

  Result<void> picture(const std::string& file, const std::string& library, std::size_t number,
                       Surfacing& how) {
    const auto [known, fresh] = pictures_.try_emplace(file, 0);
    if (fresh) {
      const std::string place = fmt::format("{}: line {}", library, number);
      const auto bytes = files_.open(file);
      if (!bytes)
        return fail(ErrorKind::Malformed, place,
                    fmt::format("the picture {} cannot be read; {}", file, files_.advice));
      auto image = files_.decode(file, *bytes);
      if (!image) return tl::unexpected(within(place, image.error()));
      known->second = static_cast<std::int32_t>(mesh_.textures.size());
      mesh_.textures.emplace_back(std::move(*image));
    }
    how.texture = known->second;
    // Many programs write a black Kd beside a picture and mean the picture alone.
    if (how.colour.r + how.colour.g + how.colour.b == 0) how.colour = {};
    return {};
  }

  Result<void> material(const std::string& name, std::size_t number) {
    const auto known = materials_.find(name);
    if (known == materials_.end())
      return fail(ErrorKind::Malformed, line_of(number),
                  fmt::format("names the material {}, which no mtllib before it has; add it, or "
                              "print without colours (--clay)",
                              name));
    surfacing_ = known->second;
    any_material_ = true;
    return {};
  }

  const std::string& name_;
  const ModelFiles& files_;
  ColourMesh mesh_;
  std::vector<std::array<float, 3>> places_, tints_;
  std::vector<std::array<float, 2>> st_, face_st_;
  std::vector<std::uint32_t> face_;
  std::map<std::string, std::uint32_t> materials_;
  std::map<std::string, std::int32_t> pictures_;
  std::uint32_t surfacing_{0};
  bool any_tint_{false}, any_material_{false};
};

}  // namespace

Result<ColourMesh> read_colour_obj(const std::string& name, std::string_view bytes,
                                   const ModelFiles& files) {
  return ObjColours(name, files).read(bytes);
}

}  // namespace popcut
