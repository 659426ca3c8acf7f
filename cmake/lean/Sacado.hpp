// SPDX-License-Identifier: LGPL-2.1-or-later
// Stands in for the header of Trilinos in targets of this project. deal.II's numbers.h includes it
// for automatic differentiation, which nothing here does, and it brings 65,000 lines.
#pragma once
