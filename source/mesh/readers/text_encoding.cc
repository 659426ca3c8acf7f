// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/text_scanner.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    bool is_utf8(const std::string_view line)
    {
      for (std::size_t i = 0; i < line.size();)
      {
        const auto first = static_cast<unsigned char>(line[i++]);
        std::size_t n_further = first < 0x80   ? 0
                                : first < 0xc2 ? 4
                                : first < 0xe0 ? 1
                                : first < 0xf0 ? 2
                                : first < 0xf5 ? 3
                                               : 4;
        if (n_further == 4)
          return false;
        for (; n_further > 0; --n_further, ++i)
          if (i == line.size() || (static_cast<unsigned char>(line[i]) & 0xc0) != 0x80)
            return false;
      }
      return true;
    }

    void append_latin_1(const std::string_view line, std::string &text)
    {
      for (const char character : line)
      {
        const auto code = static_cast<unsigned char>(character);
        if (code >= 0x80)
          text += static_cast<char>(0xc0 | (code >> 6));
        text += code < 0x80 ? character : static_cast<char>(0x80 | (code & 0x3f));
      }
    }
  } // namespace

  std::string decoded_text(std::string bytes)
  {
    if (bytes.compare(0, 2, "\xff\xfe") == 0 || bytes.compare(0, 2, "\xfe\xff") == 0)
      throw MeshFileError("The file is UTF-16 text. Save it as UTF-8 or Latin-1.");
    if (bytes.find('\0') != bytes.npos)
      return bytes;
    if (bytes.compare(0, 3, "\xef\xbb\xbf") == 0)
      bytes.erase(0, 3);
    if (is_utf8(bytes))
      return bytes;
    std::string text;
    for (std::size_t begin = 0; begin < bytes.size();)
    {
      const std::size_t end = std::min(bytes.find('\n', begin), bytes.size() - 1) + 1;
      const auto line = std::string_view(bytes).substr(begin, end - begin);
      if (is_utf8(line))
        text += line;
      else
        append_latin_1(line, text);
      begin = end;
    }
    return text;
  }
} // namespace tombolo
