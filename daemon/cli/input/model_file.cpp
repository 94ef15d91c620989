// SPDX-License-Identifier: MIT
#include "daemon/cli/input/model_file.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "core/text/words.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/pictures/image_reader.hpp"

namespace popcut::cli {
namespace model_file {
namespace {

bool has_ending(const std::filesystem::path& file, std::string_view ending) {
  return same_word(file.extension().string(), ending);
}

/// "my%20mesh.bin" is "my mesh.bin".
std::string without_percents(std::string_view uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    const bool is_code =
        uri[k] == '%' && k + 2 < uri.size() && digit(uri[k + 1]) >= 0 && digit(uri[k + 2]) >= 0;
    out += is_code ? static_cast<char>(16 * digit(uri[k + 1]) + digit(uri[k + 2])) : uri[k];
    if (is_code) k += 2;
  }
  return out;
}

/// Puts a buffer that lies beside the model into it; false: it is in it, or is none.
Result<bool> take_in(nlohmann::json& buffer, const std::filesystem::path& model,
                     const std::string& place) {
  const auto uri = buffer.find("uri");
  if (uri == buffer.end() || !uri->is_string()) return false;
  const std::string name = without_percents(uri->get_ref<const std::string&>());
  if (name.starts_with("data:")) return false;
  const auto bytes = read_beside(model, name);
  if (!bytes)
    return fail(ErrorKind::Malformed, place,
                fmt::format("is in {}, which {}; put it beside the model, or save the model as one "
                            "file (.glb)",
                            name, bytes.error().detail.substr(0, bytes.error().detail.find(';'))));
  buffer["uri"] = "data:application/octet-stream;base64," + daemon::base64(*bytes);
  return true;
}

}  // namespace
}  // namespace model_file

bool is_model_file(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 4> kEndings{".stl", ".obj", ".glb", ".gltf"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return model_file::has_ending(file, ending); });
}

Result<std::string> read_model_file(const std::filesystem::path& file) {
  using namespace model_file;
  auto bytes = read_file(file);
  if (!bytes || !has_ending(file, ".gltf") || bytes->starts_with("glTF")) return bytes;
  auto json = parse_json_data(*bytes);
  // Whoever reads the mesh says what is wrong with it.
  if (!json || !json->is_object() || !json->contains("buffers") || !(*json)["buffers"].is_array())
    return bytes;
  bool is_changed = false;
  nlohmann::json& buffers = (*json)["buffers"];
  for (std::size_t k = 0; k < buffers.size(); ++k) {
    if (!buffers[k].is_object()) return bytes;
    const auto taken = take_in(buffers[k], file, fmt::format("{}: /buffers/{}", file.string(), k));
    if (!taken) return tl::unexpected(taken.error());
    is_changed = is_changed || *taken;
  }
  if (!is_changed) return bytes;
  return json_line(*json);
}

ModelFiles files_beside(const std::filesystem::path& model) {
  return {[model](const std::string& name) { return read_beside(model, name); },
          [](const std::string& name, std::string_view bytes, std::size_t most) {
            return read_image(name, bytes, most);
          }};
}

std::optional<ColourMesh> model_in_colours(const std::filesystem::path& file,
                                           const std::string& bytes) {
  for (const bool in_colours : {true, false})
    if (auto mesh = read_colour_mesh(file.string(), bytes, files_beside(file), in_colours))
      return std::move(*mesh);
  return std::nullopt;
}

}  // namespace popcut::cli
