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

/// The programs of sheets that will soon be cut. A large one takes long to read and hash, so
/// another thread does this between arming and START. A small one is read when `find` is called.
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

  /// Begins to read the program on the other thread if it is large. Forgets the earlier program of
  /// `job`.
  void read_ahead(const std::string& job, const std::string& folder, int sheet);
  /// The program. Nothing while the other thread reads it; if it does not yet, it begins now. A
  /// large program is kept until `forget`.
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
