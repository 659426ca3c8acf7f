# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fuzzing: valid parameter files and mesh files, changed at random, given to the program.

`python3 -m fuzzing --help`, or `scripts/fuzz --help`, prints how it is run. `seeds` collects the valid
files in a reduced form, `mutations` changes them, `runs` starts the program, `judge` decides whether it
did what it should. `scenes` and `scene_*` are those of --scenes; `related_scenes`, `relations`, `frames` and
`meshes` those of --relations.
"""
