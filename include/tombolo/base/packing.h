// SPDX-License-Identifier: LGPL-2.1-or-later
// What deal.II packs messages between ranks with: the library has it once.
#pragma once

#include <boost/iostreams/device/array.hpp>
#include <boost/iostreams/device/back_inserter.hpp>
#include <boost/iostreams/device/null.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filtering_stream.hpp>
#include <boost/iostreams/stream.hpp>

#include <memory>
#include <string>
#include <vector>

/** Instantiates what deal.II's pack() and unpack() need of boost; @p what is `extern template` or
 * `template`. */
#define TOMBOLO_PACKING(what)                                                                      \
  TOMBOLO_BUFFER(what, basic_gzip_compressor<>, output);                                           \
  TOMBOLO_BUFFER(what, basic_gzip_decompressor<>, input);                                          \
  TOMBOLO_BUFFER(what, back_insert_device<std::vector<char>>, output);                             \
  what class boost::iostreams::basic_gzip_compressor<>;                                            \
  what class boost::iostreams::basic_gzip_decompressor<>;                                          \
  TOMBOLO_CHAIN(what, output);                                                                     \
  TOMBOLO_CHAIN(what, input)

#define TOMBOLO_CHAIN(what, mode)                                                                  \
  what class boost::iostreams::detail::indirect_streambuf<                                         \
      boost::iostreams::basic_null_device<char, boost::iostreams::mode>, std::char_traits<char>,   \
      std::allocator<char>, boost::iostreams::mode>;                                               \
  what class boost::iostreams::detail::chain_base<boost::iostreams::chain<boost::iostreams::mode>, \
                                                  char, std::char_traits<char>,                    \
                                                  std::allocator<char>, boost::iostreams::mode>;   \
  what class boost::iostreams::detail::chainbuf<boost::iostreams::chain<boost::iostreams::mode>,   \
                                                boost::iostreams::mode,                            \
                                                boost::iostreams::public_>;                        \
  what class boost::iostreams::filtering_streambuf<boost::iostreams::mode>

#define TOMBOLO_BUFFER(what, device, mode)                                                         \
  what class boost::iostreams::detail::indirect_streambuf<                                         \
      boost::iostreams::device, std::char_traits<char>, std::allocator<char>,                      \
      boost::iostreams::mode>;                                                                     \
  what class boost::iostreams::stream_buffer<boost::iostreams::device, std::char_traits<char>,     \
                                             std::allocator<char>, boost::iostreams::mode>

TOMBOLO_PACKING(extern template);
