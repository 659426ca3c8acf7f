// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled into each plug-in library: with which headers, which load_plugin_libraries() looks up in
// the file before it runs anything in there.
#include <tombolo/headers.h>

namespace
{
  __attribute__((used)) const char headers[] = "tombolo plug-in with headers " TOMBOLO_HEADERS;
}
