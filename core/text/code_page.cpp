// SPDX-License-Identifier: MIT
#include "core/text/code_page.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>

#include <iconv.h>

#include "core/text/words.hpp"

namespace popcut {
namespace {

/// The name by which the C library knows a code page; empty: none.
std::string library_name(std::string_view name) {
  constexpr std::size_t kLongest = 40;
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyz0123456789_-:.";
  const std::string plain = lower(trimmed(name));
  if (plain.empty() || plain.size() > kLongest ||
      plain.find_first_not_of(kPlain) != std::string::npos)
    return {};
  for (const std::string_view head : {"ansi_", "dos"})
    if (plain.starts_with(head) && plain.size() > head.size() && plain[head.size()] >= '0' &&
        plain[head.size()] <= '9')
      return "cp" + plain.substr(head.size());
  if (plain.starts_with("iso8859-")) return "iso-" + plain.substr(3);
  if (plain == "ksc5601" || plain == "ks_c_5601-1987") return "cp949";
  if (plain == "gb2312" || plain == "gbk") return "gb18030";  // which have all of it
  return plain;
}

class Converter {
 public:
  explicit Converter(const std::string& name) : handle_(iconv_open("UTF-8", name.c_str())) {}
  ~Converter() {
    if (is_open()) iconv_close(handle_);
  }
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;

  [[nodiscard]] bool is_open() const { return handle_ != reinterpret_cast<iconv_t>(-1); }

  std::string convert(std::string_view text) {
    std::string in(text), out;
    char* from = in.data();
    std::size_t left = in.size();
    std::array<char, 4096> part{};
    while (left > 0) {
      char* to = part.data();
      std::size_t room = part.size();
      const std::size_t done = iconv(handle_, &from, &left, &to, &room);
      const int fault = errno;
      out.append(part.data(), part.size() - room);
      if (done != static_cast<std::size_t>(-1) || fault == E2BIG) continue;
      out += "\xEF\xBF\xBD";
      ++from, --left;
    }
    return out;
  }

 private:
  iconv_t handle_;
};

}  // namespace

std::optional<std::string> utf8_of_code_page(std::string_view text, std::string_view name) {
  const std::string known = library_name(name);
  if (known.empty()) return std::nullopt;
  Converter converter(known);
  if (!converter.is_open()) return std::nullopt;
  return converter.convert(text);
}

}  // namespace popcut
