// The unit of './run weigh' for builds: what compiling this file costs, without a precompiled
// header. It holds what popcut compiles most, and must never change: a change makes all budgets
// wrong.
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

namespace {

using Json = nlohmann::json;
using Value = std::variant<double, std::string, std::vector<double>, Eigen::Vector3d>;

template <int N>
struct Part {
  std::map<std::string, Value> values;
  std::function<double(const Part&)> size = [](const Part& part) {
    return static_cast<double>(part.values.size() + N);
  };
  Eigen::Matrix<double, N, N> turn = Eigen::Matrix<double, N, N>::Identity();
};

template <int N>
Json described(const Part<N>& part) {
  Json out = Json::object();
  for (const auto& [name, value] : part.values) {
    std::visit(
        [&out, name = name](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
            out[name] = {v.x(), v.y(), v.z()};
          } else {
            out[name] = v;
          }
        },
        value);
  }
  out["size"] = part.size(part);
  out["turned"] = (part.turn * part.turn.transpose()).eval().determinant();
  return out;
}

template <int N>
std::string sorted_names(const Part<N>& part) {
  std::vector<std::string> names;
  for (const auto& entry : part.values) names.push_back(entry.first);
  std::sort(names.begin(), names.end(),
            [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::string out;
  for (const std::string& name : names)
    out += fmt::format("{:>12} {:08.3f}\n", name, part.size(part));
  return out;
}

template <int N>
std::string all_parts() {
  std::string out = described(Part<N>{}).dump() + sorted_names(Part<N>{});
  if constexpr (N > 2) out += all_parts<N - 1>();
  return out;
}

}  // namespace

std::string reference_text() { return all_parts<6>(); }
