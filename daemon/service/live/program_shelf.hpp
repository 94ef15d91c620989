// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/result.hpp"
#include "daemon/service/service_options.hpp"
#include "daemon/service/side_thread.hpp"

namespace popcut::daemon {

/// The programs of sheets that will soon be cut. A large one is read and hashed on another thread,
/// between arming and START. A small one is read at once.
class ProgramShelf {
 public:
  using Read = std::function<Result<StoredProgram>(const std::string& folder, int sheet)>;
  struct Program {
    StoredProgram stored;
    std::string sha256;  ///< of its bytes
  };

  ProgramShelf(SideThread& side_thread, const Read& read)
      : side_thread_(side_thread), read_(read) {}
  ProgramShelf(const ProgramShelf&) = delete;
  ProgramShelf& operator=(const ProgramShelf&) = delete;

  /// Begins to read the program if it is large. It replaces the earlier one of `job`.
  void read_ahead(const std::string& job, const std::string& folder, int sheet);
  /// The program, which is kept until `forget`; nothing while it is still being read.
  [[nodiscard]] std::optional<Result<Program>> find(const std::string& job,
                                                    const std::string& folder, int sheet);
  void forget(const std::string& job) { shelf_.erase(job); }

 private:
  struct Place {
    std::string folder;
    int sheet{};
    bool is_read{false};
    Result<Program> program = fail(ErrorKind::Internal, "", "it was not read");
  };
  SideThread& side_thread_;
  const Read& read_;
  std::map<std::string, std::shared_ptr<Place>> shelf_{};
};

}  // namespace popcut::daemon
