# SPDX-License-Identifier: LGPL-2.1-or-later
"""The pages of the project: checks of their links and sentences, and the site made of them."""
