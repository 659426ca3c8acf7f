// SPDX-License-Identifier: LGPL-2.1-or-later
extern "C" int function_that_nothing_defines();

/** Referred to when the library is loaded. */
int (*const missing_function)() = &function_that_nothing_defines;

int call_missing_function()
{
  return missing_function();
}
