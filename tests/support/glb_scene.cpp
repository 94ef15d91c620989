// SPDX-License-Identifier: MIT
#include "tests/support/glb_scene.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace popcut::testing {
namespace {

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + 4 > bytes.size()) throw std::runtime_error("the GLB is cut short");
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

template <typename Array>
Array filled(const nlohmann::json& list, Array fallback) {
  if (!list.is_array()) return fallback;
  for (std::size_t i = 0; i < list.size(); ++i)
    fallback[static_cast<Eigen::Index>(i)] = list[i].get<double>();
  return fallback;
}

}  // namespace

GlbScene::GlbScene(const std::string& bytes) {
  if (bytes.substr(0, 4) != "glTF" || word(bytes, 4) != 2 || word(bytes, 8) != bytes.size())
    throw std::runtime_error("not a GLB of version 2 and this length");
  const std::size_t length = word(bytes, 12);
  if (word(bytes, 16) != 0x4E4F534A) throw std::runtime_error("the first chunk is not JSON");
  json_ = nlohmann::json::parse(bytes.substr(20, length));
  const std::size_t second = 20 + length;
  if (word(bytes, second + 4) != 0x004E4942) throw std::runtime_error("no binary chunk");
  binary_ = bytes.substr(second + 8, word(bytes, second));
  parent_.assign(nodes(), -1);
  for (std::size_t n = 0; n < nodes(); ++n)
    for (const auto& child : json_["nodes"][n].value("children", nlohmann::json::array()))
      parent_[child.get<std::size_t>()] = static_cast<int>(n);
}

std::vector<double> GlbScene::numbers(std::size_t accessor) const {
  const auto& a = json_["accessors"][accessor];
  const auto& view = json_["bufferViews"][a["bufferView"].get<std::size_t>()];
  const std::string type = a["type"];
  const std::size_t width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
  const std::size_t first = view.value("byteOffset", 0U) + a.value("byteOffset", 0U);
  std::vector<double> out;
  for (std::size_t i = 0; i < a["count"].get<std::size_t>() * width; ++i) {
    if (a["componentType"] == 5125) {
      out.push_back(word(binary_, first + 4 * i));
      continue;
    }
    const std::uint32_t bits = word(binary_, first + 4 * i);
    float value = 0;
    std::memcpy(&value, &bits, 4);
    out.push_back(static_cast<double>(value));
  }
  return out;
}

double GlbScene::seconds() const {
  double last = 0;
  for (const auto& animation : json_.value("animations", nlohmann::json::array()))
    for (const auto& sampler : animation["samplers"])
      last = std::max(last, numbers(sampler["input"].get<std::size_t>()).back());
  return last;
}

GlbScene::Local GlbScene::local(std::size_t node, double at_s) const {
  const auto& n = json_["nodes"][node];
  Local out;
  out.scale = filled(n.value("scale", nlohmann::json()), Vec3{1, 1, 1})[0];
  out.motion.turn = rigid::Turn(
      filled(n.value("rotation", nlohmann::json()), Eigen::Vector4d(rigid::kNoTurn.coeffs())));
  out.motion.shift = filled(n.value("translation", nlohmann::json()), Vec3(Vec3::Zero()));
  for (const auto& animation : json_.value("animations", nlohmann::json::array())) {
    for (const auto& channel : animation["channels"]) {
      if (channel["target"]["node"] != node) continue;
      const auto& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      const auto times = numbers(sampler["input"].get<std::size_t>());
      const auto values = numbers(sampler["output"].get<std::size_t>());
      std::size_t k = 0;
      while (k + 2 < times.size() && times[k + 1] < at_s) ++k;
      const double part = std::clamp((at_s - times[k]) / (times[k + 1] - times[k]), 0.0, 1.0);
      if (channel["target"]["path"] == "rotation") {
        out.motion.turn =
            rigid::slerp(rigid::Turn(&values[4 * k]), rigid::Turn(&values[4 * k + 4]), part);
      } else {
        out.motion.shift = (1 - part) * Vec3(&values[3 * k]) + part * Vec3(&values[3 * k + 3]);
      }
    }
  }
  return out;
}

std::vector<Vec3> GlbScene::places(std::size_t node, double at_s) const {
  const auto mesh = json_["nodes"][node]["mesh"].get<std::size_t>();
  const auto& primitive = json_["meshes"][mesh]["primitives"][0];
  const auto corners = numbers(primitive["attributes"]["POSITION"].get<std::size_t>());
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    out.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  for (int n = static_cast<int>(node); n >= 0; n = parent_[static_cast<std::size_t>(n)]) {
    const Local here = local(static_cast<std::size_t>(n), at_s);
    for (Vec3& p : out) p = here.motion(here.scale * p);
  }
  return out;
}

int GlbScene::depth(std::size_t node) const {
  int joints = 0;
  for (int n = parent_[node]; n >= 0; n = parent_[static_cast<std::size_t>(n)]) ++joints;
  return joints;
}

}  // namespace popcut::testing
