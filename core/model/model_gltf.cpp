// SPDX-License-Identifier: MIT
// Meshes of glTF 2.0 files (Khronos, glTF 2.0 Specification, 2021). tinygltf parses the JSON.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/model/gltf_scene.hpp"
#include "core/model/model_readers.hpp"

namespace popcut::model_readers {
namespace {

// ---- what the library may see

/// Values of its JSON that a file may have: the library takes several hundred bytes for each.
constexpr std::size_t kMostValues = 2'000'000;
/// The library calls itself once for each bracket.
constexpr std::size_t kDeepestJson = 200;

/// The JSON of a file: all of a .gltf, the first chunk of a .glb (glTF 2.0, 4.4).
std::string_view json_of(std::string_view bytes) {
  constexpr std::size_t kHead = 20;
  if (!bytes.starts_with("glTF") || bytes.size() < kHead) return bytes;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, sizeof length);
  return bytes.substr(kHead, length);
}

Result<void> check_json(const std::string& name, std::string_view json) {
  std::size_t values = 0, depth = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    if (quoted) {
      if (c == '\\') ++k;
      quoted = c != '"';
      continue;
    }
    if (c == '"') quoted = true;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == '[' || c == '{' || c == ',') ++values;
    if (depth > kDeepestJson)
      return fail(ErrorKind::Malformed, name,
                  fmt::format("nests its JSON deeper than {} brackets; save the model again",
                              kDeepestJson));
    if (values > kMostValues)
      return fail(
          ErrorKind::OutOfRange, name,
          fmt::format("has more than {} values in its JSON; reduce the model", kMostValues));
  }
  return {};
}

/// Extensions that are read, or that change nothing of what is read.
bool is_known(std::string_view extension) {
  static constexpr std::array kKnown{
      std::string_view("KHR_mesh_quantization"), std::string_view("KHR_node_visibility"),
      std::string_view("KHR_texture_transform"), std::string_view("EXT_mesh_gpu_instancing"),
      std::string_view("KHR_lights_punctual"),   std::string_view("KHR_xmp_json_ld"),
      std::string_view("KHR_animation_pointer"), std::string_view("EXT_lights_image_based")};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end() ||
         extension.starts_with("KHR_materials_");
}

tl::unexpected<Error> compressed(const std::string& place, std::string_view extension) {
  return fail(ErrorKind::Malformed, place,
              fmt::format("is compressed ({}); save the model without compression", extension));
}

/// Refuses files of the first version, whose meshes and nodes have names in place of numbers. A
/// .glb has its version behind the first word.
Result<void> check_version(const std::string& name, std::string_view version) {
  if (version != "1" && !version.starts_with("1.")) return {};
  return fail(ErrorKind::Malformed, name,
              "is glTF 1.0, which popcut does not read; save the model as glTF 2.0 (.glb)");
}

/// Refuses a file that cannot be read without a later version of the format, or an extension that
/// popcut does not know (glTF 2.0, 3.2 and 3.12).
Result<void> check_needs(const std::string& name, const tinygltf::Model& model) {
  const std::string& version = model.asset.minVersion;
  if (!version.empty() && version != "2.0")
    return fail(ErrorKind::Malformed, name + ": /asset/minVersion",
                fmt::format("asks for glTF {}, and popcut reads 2.0; save the model as glTF 2.0",
                            version.substr(0, 20)));
  for (std::size_t k = 0; k < model.extensionsRequired.size(); ++k) {
    const std::string& extension = model.extensionsRequired[k];
    if (is_known(extension)) continue;
    const std::string place = fmt::format("{}: /extensionsRequired/{}", name, k);
    if (extension.find("compression") != std::string::npos) return compressed(place, extension);
    return fail(
        ErrorKind::Malformed, place,
        fmt::format("needs the extension {}, which popcut does not know; save the model without it",
                    extension));
  }
  return {};
}

// ---- parsing

// The library hands over pictures as they are in the file. It does not check that those in a buffer
// lie within it, so `GltfMaterials` reads these.
bool keep_picture(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

/// Opens the files beside a model, where it may have some.
struct Beside {
  const ModelOptions& options;
  std::string missing;  ///< the first file that was asked for where none may be
};

// What the library asks of a disk goes to the files beside the model.
bool is_there(const std::string&, void*) { return true; }
std::string as_named(const std::string& name, void*) { return name; }
bool read_beside(std::vector<unsigned char>* out, std::string* error, const std::string& name,
                 void* user) {
  auto& beside = *static_cast<Beside*>(user);
  // The library puts "./" or a folder of its own before a name; the model's folder has none.
  std::string plain = name;
  while (plain.starts_with("./")) plain.erase(0, 2);
  if (!beside.options.open) {
    if (beside.missing.empty()) beside.missing = plain;
    return false;
  }
  const auto bytes = beside.options.open(plain);
  if (!bytes) {
    *error += plain + " cannot be read; ";
    return false;
  }
  out->assign(bytes->begin(), bytes->end());
  return true;
}
bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

Result<tinygltf::Model> parsed(const std::string& name, std::string_view bytes,
                               const ModelOptions& options) {
  if (bytes.size() > std::numeric_limits<unsigned>::max() / 2)
    return fail(ErrorKind::OutOfRange, name, "is larger than 2 GB; reduce the model");
  const std::string_view json = json_of(bytes);
  if (bytes.starts_with("glTF") && bytes.size() > 4)
    if (auto fit = check_version(name, std::to_string(static_cast<unsigned char>(bytes[4]))); !fit)
      return tl::unexpected(fit.error());
  if (auto fit = check_json(name, json); !fit) return tl::unexpected(fit.error());
  Beside beside{options, {}};
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(keep_picture, nullptr);
  reader.SetFsCallbacks({is_there, as_named, read_beside, write_nothing, &beside});
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  bool read = false;
  try {
    read = bytes.starts_with("glTF")
               ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(bytes.data()),
                                             size)
               : reader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, "");
  } catch (const std::logic_error&) {
    error = "a length in it is wrong";  // of a buffer, which the library finds too late
  }
  if (read) return model;
  if (!beside.missing.empty())
    return fail(ErrorKind::Malformed, name,
                fmt::format("keeps its mesh in {} beside it; save the model as one file (.glb)",
                            beside.missing));
  // Some files leave out what the library needs, and do not say that they need the extension.
  for (const std::string_view extension : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
    if (json.find(fmt::format("\"{}\"", extension)) != std::string_view::npos)
      return compressed(name, extension);
  std::replace(error.begin(), error.end(), '\n', ' ');
  while (!error.empty() && std::string_view(" .;").find(error.back()) != std::string_view::npos)
    error.pop_back();
  return fail(ErrorKind::Malformed, name,
              fmt::format("cannot be read as glTF{}{}; save the model again",
                          error.empty() ? "" : ": ", error.substr(0, 200)));
}

}  // namespace

Result<Model> read_gltf(const std::string& name, std::string_view bytes,
                        const ModelOptions& options) {
  const auto file = parsed(name, bytes, options);
  if (!file) return tl::unexpected(file.error());
  if (auto known = check_version(name, file->asset.version); !known)
    return tl::unexpected(known.error());
  if (auto known = check_needs(name, *file); !known) return tl::unexpected(known.error());
  return read_gltf_scene(name, *file, options);
}

}  // namespace popcut::model_readers
