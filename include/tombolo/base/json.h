// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace tombolo
{
  /** A value of a JSON document, whose objects keep the order in which keys were added. Adding a
   * key to an object invalidates references to its other values. Sources that use more than the
   * name include <nlohmann/json.hpp>. */
  using Json = nlohmann::ordered_json;

  /** The document as text, indented by two blanks a level, with a newline at its end. Numbers read
   * back as the same double. JSON has no numbers that are not finite: they become null. Bytes that
   * are not UTF-8 become U+FFFD. */
  std::string json_text(const Json &document);
} // namespace tombolo
