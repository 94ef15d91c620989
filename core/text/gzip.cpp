// SPDX-License-Identifier: MIT
#include "core/text/gzip.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <zlib.h>

namespace popcut {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1F\x8B"); }

Result<std::string> unpacked(std::string_view bytes, std::size_t most_bytes) {
  constexpr int kGzipOnly = 16;
  z_stream stream{};
  if (inflateInit2(&stream, kGzipOnly + MAX_WBITS) != Z_OK)
    return fail(ErrorKind::Internal, "", "zlib cannot begin");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // it only reads
  std::string out;
  std::array<char, 1 << 16> part{};
  int state = Z_OK;
  std::size_t left = bytes.size();
  while (state != Z_STREAM_END || left + stream.avail_in > 0) {
    if (state == Z_STREAM_END && inflateReset(&stream) != Z_OK) break;
    if (stream.avail_in == 0) {
      stream.avail_in = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      left -= stream.avail_in;
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = part.size();
    state = inflate(&stream, Z_NO_FLUSH);
    const std::size_t count = part.size() - stream.avail_out;
    if (state != Z_OK && state != Z_STREAM_END) break;
    if (count == 0 && state == Z_OK && stream.avail_in == 0 && left == 0) break;
    if (out.size() + count > most_bytes) {
      inflateEnd(&stream);
      return tl::unexpected(
          too_much(fmt::format("unpacked it has more than {} bytes", most_bytes)));
    }
    out.append(part.data(), count);
  }
  inflateEnd(&stream);
  if (state != Z_STREAM_END)
    return fail(ErrorKind::Malformed, "",
                "is a gzip file (.svgz) that is broken or not whole; save it again, or unpack it "
                "with gunzip");
  return out;
}

}  // namespace popcut
