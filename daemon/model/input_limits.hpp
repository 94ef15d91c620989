// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace popcut::daemon {

// What a request may contain: the one home of these limits. The handlers, the description of the
// API, the service and the tables of the database all use them.

/// The longest a text may be.
struct TextLimit {
  std::size_t characters;  ///< Unicode code points
  /// The same in UTF-8, where a character takes at most four bytes.
  [[nodiscard]] constexpr std::size_t bytes() const { return 4 * characters; }
};

inline constexpr TextLimit kNameLimit{120};   ///< what people call a job, design, token or tablet
inline constexpr TextLimit kNoteLimit{2000};  ///< of a job
inline constexpr TextLimit kReasonLimit{200};
inline constexpr TextLimit kTagLimit{40};
inline constexpr TextLimit kIdLimit{64};          ///< ids, and names of machines, mats and sites
inline constexpr TextLimit kContentIdLimit{80};   ///< "sha256-" and 64 digits, and as long plan ids
inline constexpr TextLimit kMaterialIdLimit{60};  ///< of a material that is added
/// Whether a material that is added may have this id.
[[nodiscard]] constexpr bool is_material_id(std::string_view id) {
  return !id.empty() && id.size() <= kMaterialIdLimit.characters &&
         id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_.") == std::string_view::npos;
}

inline constexpr TextLimit kSecretLimit{200};
inline constexpr TextLimit kPairingCodeLimit{20};  ///< with the blanks that people type
inline constexpr TextLimit kWarningCodeLimit{40};

/// Idempotency-Key and Preview-Key.
inline constexpr std::size_t kLeastKeyCharacters = 16, kMostKeyCharacters = 128;

inline constexpr std::size_t kMostTags = 20;
inline constexpr std::size_t kMostAcceptedWarnings = 100;
inline constexpr int kMostCopies = 1000;
inline constexpr int kLeastPriority = -10, kMostPriority = 10;
inline constexpr int kMostSheets = 10'000;  ///< of a job, and parts of a design
inline constexpr int kMostBlanks = 1'000'000;
inline constexpr std::int64_t kMostPaths = std::int64_t{1} << 40;  ///< of a sheet
inline constexpr int kLeastTokenLifetime_s = 60, kMostTokenLifetime_s = 10 * 366 * 86'400;
inline constexpr int kLeastDpi = 50, kMostDpi = 600;  ///< of printed artwork

/// Items of a page of a list, and how many a client gets that names no `limit`.
inline constexpr int kMostPageItems = 200, kUsualPageItems = 50;

}  // namespace popcut::daemon
