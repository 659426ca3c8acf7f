// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/packing.h>

TOMBOLO_PACKING(template);
