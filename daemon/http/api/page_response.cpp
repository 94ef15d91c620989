// SPDX-License-Identifier: MIT
#include "daemon/http/api/page_response.hpp"

#include <algorithm>
#include <map>
#include <mutex>

#include <fmt/format.h>
#include <zlib.h>

#include "core/text/words.hpp"

namespace popcut::daemon::http {
namespace {

// What the page may do, and nothing else: no script and no style but its own files, no HTML from
// text (require-trusted-types-for), no device of the computer.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'; trusted-types 'none'";
constexpr std::string_view kPermissions =
    "usb=(), serial=(), camera=(), microphone=(), geolocation=(), screen-wake-lock=(self)";

std::string in_lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// The weight of a coding such as "gzip;q=0.5": false if it is 0, which says that it is not wanted.
bool has_weight(std::string_view coding) {
  const std::size_t at = coding.find("q=");
  if (at == std::string_view::npos) return true;
  return coding.substr(at + 2).find_first_of("123456789") != std::string_view::npos;
}

// Whether a client that sends this Accept-Encoding takes gzip (RFC 9110, 12.5.3). Without the
// header a client is taken for one that does not know it.
bool takes_gzip(std::string_view accepted) {
  bool any = false;
  while (!accepted.empty()) {
    const std::size_t end = std::min(accepted.find(','), accepted.size());
    const std::string one = in_lower_case(accepted.substr(0, end));
    const std::string_view name = trimmed(std::string_view(one).substr(0, one.find(';')), " \t");
    if (name == "gzip" || name == "x-gzip") return has_weight(one);
    if (name == "*") any = has_weight(one);
    accepted.remove_prefix(std::min(end + 1, accepted.size()));
  }
  return any;
}

// The file that `bytes` is a gzip of; empty if malformed, which a test finds.
std::string inflated(std::string_view bytes) {
  constexpr int kGzip = 16 + MAX_WBITS;
  std::string in(bytes), out, piece(1 << 16, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(piece, 0, piece.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END ? out : std::string();
}

// Each file is inflated once, so that clients without gzip cost no more than others.
const std::string& inflated_once(const PageFile& file) {
  static std::mutex mutex;
  static std::map<const char*, std::string> known;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto [at, is_new] = known.try_emplace(file.bytes.data());
  if (is_new) at->second = inflated(file.bytes);
  return at->second;
}

}  // namespace

Response page_response(const PageFile& file, std::string_view accept_encoding) {
  Response response;
  response.content_type = file.media_type;
  const bool packed = file.is_gzip && takes_gzip(accept_encoding);
  if (packed || !file.is_gzip)
    response.body = file.bytes;
  else
    response.body = inflated_once(file);
  // A hashed name is new with each change; what / holds is asked for each time.
  const bool is_index = file.name.empty();
  response.headers = {
      {"Content-Security-Policy", std::string(kPolicy)},
      {"Cross-Origin-Opener-Policy", "same-origin-allow-popups"},
      {"Permissions-Policy", std::string(kPermissions)},
      {"Cache-Control", is_index ? "no-cache" : "public, max-age=31536000, immutable"},
      {"ETag", fmt::format("\"{}{}\"", file.hash, packed ? "-gzip" : "")},
      {"Vary", "Accept-Encoding"},
  };
  if (packed) response.headers.push_back({"Content-Encoding", "gzip"});
  return response;
}

}  // namespace popcut::daemon::http
