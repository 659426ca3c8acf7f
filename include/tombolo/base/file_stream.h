// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <ext/stdio_filebuf.h>

#include <ostream>
#include <string>

namespace tombolo
{
  /** A file of results that this process writes. Links are not followed, and what is no file, a
   * pipe for example, is neither opened nor waited for: results go nowhere but into their
   * directory. */
  class FileStream : public std::ostream
  {
  public:
    enum class Mode
    {
      create, ///< a new file, which replaces one of the same name
      append  ///< behind what is there
    };

    /** Opens the file; where that fails, the stream is in its fail state. */
    FileStream(const std::string &path, Mode mode);

    /** Writes what is pending and closes the file. Returns why that, or something before it, went
     * wrong; nothing where all is written. */
    std::string close();

  private:
    __gnu_cxx::stdio_filebuf<char> buffer;
    std::string problem; ///< why the file could not be opened
  };

  /** Opens a file as FileStream does, for writing. Returns its descriptor, or -1 and in @p problem
   * why it cannot be opened. */
  int open_new_file(const std::string &path, std::string &problem);

  /** Where no regular file has this name, the reason for it: nothing that leads elsewhere is
   * opened.
   */
  std::string reason_not_a_file(const std::string &path);
} // namespace tombolo
