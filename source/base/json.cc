// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/json.h>

#include <nlohmann/json.hpp>

namespace tombolo
{
  std::string json_text(const Json &document)
  {
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  }
} // namespace tombolo
