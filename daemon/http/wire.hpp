// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "daemon/http/api/message.hpp"

namespace popcut::daemon::http {

/// Reads requests from the bytes of one connection, one after the other. No sockets: what arrives
/// is given to `append`.
///
/// A head goes through `check_head` before Beast sees it; bodies are handed on piece by piece, so
/// that none is ever held whole here.
class RequestReader {
 public:
  explicit RequestReader(std::size_t header_bytes);
  ~RequestReader();
  RequestReader(const RequestReader&) = delete;
  RequestReader& operator=(const RequestReader&) = delete;

  void append(std::string_view bytes);
  /// True once a byte of the request to come is here.
  [[nodiscard]] bool has_begun() const;
  /// True when the head is complete; then `head()` returns it.
  /// @retval TooLarge    it is longer than `header_bytes`
  /// @retval BadRequest  see `check_head`
  [[nodiscard]] Answer<bool> read_head();
  [[nodiscard]] const RequestHead& head() const;
  /// True when the request has no body, or all of it was read.
  [[nodiscard]] bool is_done() const;
  /// Takes a piece of the body; a problem ends the reading.
  using Sink = std::function<std::optional<Problem>(std::string_view)>;
  /// Reads on as far as the bytes go; true when the body is whole.
  /// @retval TooLarge    more than `most_bytes` of body
  /// @retval BadRequest  the chunks are not well formed
  [[nodiscard]] Answer<bool> read_body(std::uint64_t most_bytes, const Sink& sink);
  /// Prepares for the next request; the part of it that has arrived is kept.
  void next();

 private:
  class Parser;
  std::size_t header_bytes_;
  std::string pending_;
  std::size_t scanned_{0};
  std::unique_ptr<Parser> parser_;
};

}  // namespace popcut::daemon::http
