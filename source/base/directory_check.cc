// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/directory_check.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace tombolo
{
  namespace fs = std::filesystem;

  std::string what_prevents_directory(const std::string &path)
  {
    if (path.empty())
      return "the name is empty; give a path that can be written.";
    std::error_code code;
    fs::path existing = fs::absolute(path, code).lexically_normal();
    if (!existing.has_filename()) // a slash at the end
      existing = existing.parent_path();
    bool is_parent = false;
    // On the way up: below a file nothing exists either.
    while (!fs::exists(existing, code) && existing.has_relative_path())
    {
      existing = existing.parent_path();
      is_parent = true;
    }
    if (!fs::is_directory(existing, code))
      return is_parent ? "\"" + existing.string() +
                             "\" is a file, so that there can be no directory in it; name a path "
                             "whose parents exist or can be made."
                       : "this is a file, not a directory; name another path, or move the file "
                         "away.";
    if (access(existing.c_str(), W_OK | X_OK) != 0)
      return "the directory \"" + existing.string() + "\" cannot be written (" +
             std::strerror(errno) + "); change its permissions or name another path.";
    return "";
  }
} // namespace tombolo
