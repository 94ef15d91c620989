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
#include "daemon/service/aside.hpp"
#include "daemon/service/service_options.hpp"

namespace popcut::daemon {

/// The programs of sheets that will soon be cut. A large one is read, and its digest taken, on
/// another thread while a person goes from arming to START; a small one is read at once.
class ProgramShelf {
 public:
  using Read = std::function<Result<StoredProgram>(const std::string& folder, int sheet)>;
  struct Program {
    StoredProgram stored;
    std::string sha256;  ///< of its bytes
  };

  ProgramShelf(Aside& aside, const Read& read) : aside_(aside), read_(read) {}
  ProgramShelf(const ProgramShelf&) = delete;
  ProgramShelf& operator=(const ProgramShelf&) = delete;

  /// Begins to read it if it is large. `job` has one program on the shelf.
  void want(const std::string& job, const std::string& folder, int sheet);
  /// The program, which stays on the shelf until `forget`; nothing: it is still being read, ask
  /// again.
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
  Aside& aside_;
  const Read& read_;
  std::map<std::string, std::shared_ptr<Place>> shelf_{};
};

}  // namespace popcut::daemon
