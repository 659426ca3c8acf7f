# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which waves return from an interface of finite elements and particles (doc/reflection.md)."""
