// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/hands/envelope.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// What is asked for beside a card.
struct AroundCard {
  std::string envelope{};  ///< "fit", a name or a size (`hands::envelope_mm`); empty: none
  bool cover{false};

  /// @retval Usage  no such envelope, whatever the card
  [[nodiscard]] Result<void> check() const;
  [[nodiscard]] bool any() const { return cover || !envelope.empty(); }
};

/// Adds envelope.svg and cover.svg, as far as they are asked for, and their DXF if `wants` has dxf.
///
/// @return their names, each after a blank
/// @retval Infeasible  the card is too large for the envelope
[[nodiscard]] Result<std::string> add_envelope_files(
    const AroundCard& around, const hands::ShutCard& card,
    const std::function<bool(std::string_view)>& wants, OutputFolder& folder);

/// One line for a person: how large the shut card and its envelope are; nothing if none is asked.
[[nodiscard]] std::string envelope_words(const AroundCard& around, const hands::ShutCard& card);

}  // namespace popcut::cli
