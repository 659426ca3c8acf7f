// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/file_stream.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tombolo
{
  namespace
  {
    constexpr mode_t for_all = 0666; // less what the user's mask removes

    int open_to_append(const std::string &path, std::string &problem)
    {
      // Without O_NONBLOCK a pipe without reader is waited for.
      const int descriptor =
          open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC,
               for_all);
      struct stat status;
      if (descriptor < 0)
        problem = errno == ELOOP   ? "it is a link, and links are not followed"
                  : errno == ENXIO ? "it is a pipe"
                                   : std::strerror(errno);
      else if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
      {
        problem = "it is not a file";
        ::close(descriptor);
        return -1;
      }
      return descriptor;
    }
  } // namespace

  int open_new_file(const std::string &path, std::string &problem)
  {
    // A link or a pipe of that name is removed, not what it leads to.
    if (unlink(path.c_str()) != 0 && errno != ENOENT)
    {
      problem = errno == EISDIR ? "it is a directory" : std::strerror(errno);
      return -1;
    }
    const int descriptor =
        open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, for_all);
    if (descriptor < 0)
      problem = std::strerror(errno);
    return descriptor;
  }

  std::string reason_not_a_file(const std::string &path)
  {
    struct stat status;
    if (lstat(path.c_str(), &status) != 0)
      return std::strerror(errno);
    return S_ISLNK(status.st_mode)    ? "it is a link, and links are not followed"
           : !S_ISREG(status.st_mode) ? "it is not a file"
                                      : "";
  }

  FileStream::FileStream(const std::string &path, const Mode mode) : std::ostream(nullptr)
  {
    const int descriptor =
        mode == Mode::create ? open_new_file(path, problem) : open_to_append(path, problem);
    if (descriptor >= 0)
      buffer = __gnu_cxx::stdio_filebuf<char>(descriptor, std::ios::out | std::ios::binary);
    rdbuf(&buffer);
    if (descriptor < 0)
      setstate(std::ios::failbit);
    errno = 0;
  }

  std::string FileStream::close()
  {
    if (!problem.empty())
      return problem;
    const bool has_failed = !*this;
    if (buffer.close() == nullptr || has_failed)
      return errno != 0 ? std::strerror(errno) : "the stream failed";
    return "";
  }
} // namespace tombolo
