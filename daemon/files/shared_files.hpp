// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::daemon {

/// Files of the state folder that all nodes of a fleet need: designs, assets, what plans became.
/// Names are those in the folder: "designs/sha256-...", "plans/01J.../sheet-01.gpgl".
class SharedFiles {
 public:
  virtual ~SharedFiles() = default;

  /// Stores a file, or all in a folder, so that others can fetch it; the same again changes
  /// nothing. From any thread; takes as long as the database takes.
  ///
  /// @param place  where it is now; empty: where its name says
  /// @retval Unwritable  the database is away, or its disk is full
  [[nodiscard]] virtual Result<void> keep(const std::string& name,
                                          const std::string& place = {}) = 0;
  /// The same of a file in its place, in the transaction that is open; on the service's thread.
  /// False: it is large, and must be kept by another thread.
  ///
  /// @throws StoreFault
  [[nodiscard]] virtual bool keep_small(const std::string& name) = 0;
  enum class Found : std::uint8_t {
    Here,    ///< it is in the folder
    Coming,  ///< it is large and on its way
    Absent,  ///< the database does not have it, either
  };
  /// Makes a file be in the folder. On the service's thread: what is small is fetched at once.
  ///
  /// @throws StoreFault
  [[nodiscard]] virtual Found fetch(const std::string& name) = 0;
  /// The names that begin with `beginning`. On the service's thread.
  ///
  /// @throws StoreFault
  [[nodiscard]] virtual std::vector<std::string> names(const std::string& beginning) = 0;
  /// Forgets all files whose names begin so, in the transaction that is open. On the service's
  /// thread.
  ///
  /// @throws StoreFault
  virtual void forget(const std::string& beginning) = 0;
};

}  // namespace popcut::daemon
