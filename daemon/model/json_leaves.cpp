// SPDX-License-Identifier: MIT
#include "daemon/model/json_leaves.hpp"

#include <nlohmann/json.hpp>

namespace popcut::daemon {
namespace {

class Leaves : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit Leaves(const std::function<void(const JsonLeaf&)>& take) : take_(take) {}

  bool null() override { return leaf({}); }
  bool boolean(bool value) override { return leaf({.is_true = value}); }
  bool number_integer(number_integer_t value) override {
    return leaf({.number = static_cast<double>(value)});
  }
  bool number_unsigned(number_unsigned_t value) override {
    return leaf({.number = static_cast<double>(value)});
  }
  bool number_float(number_float_t value, const string_t&) override {
    return leaf({.number = value});
  }
  bool string(string_t& value) override { return leaf({.text = std::string_view(value)}); }
  bool binary(binary_t&) override { return leaf({}); }
  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    name_ = name;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  bool open() {
    parents_.push_back(std::exchange(name_, {}));
    return true;
  }
  bool close() {
    name_.clear();
    parents_.pop_back();
    if (parents_.size() == 1) ++item_;
    return true;
  }
  bool leaf(JsonLeaf one) {
    one.item = item_;
    one.depth = static_cast<int>(parents_.size());
    if (!parents_.empty()) one.parent = parents_.back();
    one.name = name_;
    take_(one);
    name_.clear();
    if (parents_.size() == 1) ++item_;
    return true;
  }

  const std::function<void(const JsonLeaf&)>& take_;
  std::vector<std::string>
      parents_{};  ///< the names of the lists and objects around, outermost first
  std::string name_{};
  std::size_t item_{0};
};

}  // namespace

bool each_json_leaf(std::string_view json, const std::function<void(const JsonLeaf&)>& take) {
  Leaves leaves(take);
  return nlohmann::json::sax_parse(json, &leaves);
}

}  // namespace popcut::daemon
