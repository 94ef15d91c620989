// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "core/result.hpp"

namespace popcut {

/// A folder that is held by a descriptor: what is opened in it stays in it, whatever becomes of its
/// path meanwhile. Names are of one part, and a link is never followed: neither the folder itself
/// nor a file in it may be one. Copies hold the same folder.
class HeldFolder {
 public:
  HeldFolder() = default;  ///< none; every call fails

  /// @retval Unwritable  it is absent, or a link, or no folder; errno says which
  [[nodiscard]] static Result<HeldFolder> open(const std::string& path);
  /// The folder in which a path's last part lies, and that part.
  ///
  /// @retval as `open`
  [[nodiscard]] static Result<HeldFolder> around(const std::string& path, std::string& name);

  /// The folder of a descriptor, which this closes; none if it is below 0.
  [[nodiscard]] static HeldFolder of(int descriptor);
  /// A folder in this one; none with errno, ENOTDIR or ELOOP if a file or link has the name.
  [[nodiscard]] HeldFolder below(const std::string& name) const;

  [[nodiscard]] bool holds() const { return folder_ != nullptr; }
  [[nodiscard]] int descriptor() const { return folder_ ? *folder_ : -1; }
  /// A descriptor of a new file, to write; -1 with errno, EEXIST if the name is taken, be it by a
  /// link that leads nowhere.
  [[nodiscard]] int create(const std::string& name, unsigned mode = 0600) const;
  /// The same, after what had the name is removed; a link itself, not what it leads to.
  [[nodiscard]] int create_again(const std::string& name, unsigned mode = 0600) const;
  /// A descriptor of a regular file, to read; -1 with errno, EINVAL if it is a pipe, a device or
  /// anything else whose reading may never end.
  [[nodiscard]] int read(const std::string& name) const;
  /// A descriptor of a file to append to, made if it is absent; -1 with errno, EMLINK if the file
  /// has another name too, which may lie elsewhere.
  [[nodiscard]] int append(const std::string& name) const;
  /// As rename, unlink, mkdir: 0, or -1 with errno.
  [[nodiscard]] int rename(const std::string& from, const std::string& to) const;
  int remove(const std::string& name) const;  // NOLINT(modernize-use-nodiscard): at worst it stays
  [[nodiscard]] int make_folder(const std::string& name, unsigned mode = 0700) const;
  /// As renameat, to another folder.
  [[nodiscard]] int move(const std::string& from, const HeldFolder& folder,
                         const std::string& to) const;
  /// Its entries are on disk; false with errno.
  [[nodiscard]] bool sync() const;

 private:
  explicit HeldFolder(int folder);
  std::shared_ptr<const int> folder_{};
};

}  // namespace popcut
