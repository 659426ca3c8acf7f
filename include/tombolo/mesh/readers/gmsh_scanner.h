// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/text_scanner.h>

namespace tombolo
{
  /** Reads the numbers of a file of gmsh, as words or as bytes. All throw MeshFileError. */
  class GmshScanner : public TextScanner
  {
  public:
    using TextScanner::TextScanner;

    /** Numbers are binary from now on. Version 2.2 has no numbers of 8 bytes but coordinates. */
    void begin_binary(bool is_version_4);
    bool is_binary() const;

    /** Moves from the line that begins a section to the first byte of its numbers. */
    void begin_numbers();

    /** C's `int`. */
    long long small_integer(const char *what);
    /** C's `size_t`, in version 2.2 an `int`. */
    long long large_integer(const char *what);
    double number(const char *what);
    /** The same, not negative. */
    std::size_t small_count(const char *what);
    std::size_t large_count(const char *what);

  private:
    std::size_t not_negative(long long value, const char *what) const;

    bool binary = false;
    bool has_large_integers = false;
  };
} // namespace tombolo
