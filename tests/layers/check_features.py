#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks that a feature of the library is named in its own files alone.

usage: check_features.py [--list] PROJECT_DIRECTORY

FEATURES says by which names the code knows a feature, and which files are its own, by their paths.
Comments do not count. Any other file of include/ and source/ with one of the names is a foreign file:
somebody who adds or changes the feature has to know that file as well. Today's foreign files stand in
tests/layers/foreign_names.txt ("feature file"), a list that only shrinks. Prints one line for every
foreign file that is not in the list, and for every line of the list that is none any more, and fails
where there is one. --list prints the list as it is now.
"""

import re

import checking

FOREIGN_NAMES = "tests/layers/foreign_names.txt"
HEADER = """\
# Files that name a feature and are not its own: feature, file (tests/layers/check_features.py). The list
# only shrinks: no line may come, and whoever takes a name out of a file removes its line. As it is now:
# python3 tests/layers/check_features.py --list . > tests/layers/foreign_names.txt
"""

# Feature: names in the code, and what the paths of its own files have.
FEATURES = {
    "archive": (r"StateArchive|\bserialize\w*\(", r"archive|checkpoint|state/records"),
    "bonds": (r"\b[Bb]ond(?:s?\b|_|[A-Z])|\w*_bonds?\b|(?:\b|_)broken", r"bond|failure|/contact/"),  # in contact, bonded faces
    "conversion": (r"[Cc]onver(?:sion|ting|ted|ts)\b|Conver(?:sion|ting|ted)[A-Z]|conversion_|converted_"
                   r"|StateTransfer|\badd_particles\b|\bcan_add_particles\b|\bsetup\.source\b", r"conver"),
    "erosion": (r"[Ee]rosion|[Ee]rod(?:e|ing)", r"eros|erod"),
    "hanging-nodes": (r"[Hh]anging|[Gg]raded(?:\b|[A-Z_])|FollowsDivisions|follow_division|CellDivisions|refined_faces",
                      r"hanging|division|graded|refine"),
    "mirror-planes": (r"[Ss]ymmetry|MirrorNode|ReflectionParity|under_reflection|required_images|ImageNode"
                      r"|required_image_nodes|images_of_body|find_images|makes_images", r"symmetry|mirror"),
    "mortar": (r"[Mm]ortar", r"mortar"),
    "rigid-bodies": (r"Rigid(?:Bod|Cells|Formulation)|rigid_(?:bod|cells)", r"rigid_(?:bod|cells|form)"),
    "scaled-inertia": (r"scales?_inertia|is_scaled|inertia_factor|row_inertia|true_mass|has_scaled|MassScaling"
                       r"|relative_inertia|body_mass|mass_of_bodies|inertia_is_mass",
                       r"scaling"),
    "statics": (r"Static(?:Process|Steps?|Solver|Contact)|static_(?:process|steps?|solver|contact)|[Ss]tiff_?[Cc]ells"
                r"|AtRest|at_rest|roles\.rest|for_statics|physics/statics", r"static|at_rest|rest_entries|stiff"),
}

# A text may have what looks like a comment.
COMMENT_OR_TEXT = re.compile(r'"(?:\\.|[^"\\\n])*"|/\*.*?\*/|//[^\n]*', re.S)


def code_of(text):
    """The text with the same lines, without comments."""
    def without_comment(match):
        found = match.group()
        return found if found[0] == '"' else re.sub(r"[^\n]", " ", found)
    return COMMENT_OR_TEXT.sub(without_comment, text)


def foreign_names(root):
    """{(feature, file): the first line with a name of the feature}, and the number of files."""
    result, files = {}, checking.files_of(root, ("include", "source"))
    for relative in files:
        name, code = relative.as_posix(), code_of((root / relative).read_text(encoding="utf-8"))
        for feature, (names, own) in FEATURES.items():
            found = None if re.search(own, name) else re.search(names, code)
            if found:
                result[feature, name] = code.count("\n", 0, found.start()) + 1
    return result, len(files)


def listed_names(root):
    """The pairs of the list; none where there is no list."""
    pairs = []
    for (feature, name), line in checking.rows_of_list(root, FOREIGN_NAMES):
        if feature not in FEATURES or (feature, name) in pairs:
            raise ValueError(f"{FOREIGN_NAMES}: {line}")
        pairs.append((feature, name))
    return pairs


def check(root):
    """All violations below `root`, as lines to print, and the number of files."""
    found, n_files = foreign_names(root)
    listed = listed_names(root)
    violations = [f"{name}:{line}: names {feature}, and is none of its files"
                  for (feature, name), line in sorted(found.items()) if (feature, name) not in listed]
    violations += [f"{FOREIGN_NAMES}:1: {name} does not name {feature} any more: remove the line, or renew the list by "
                   f"python3 tests/layers/check_features.py --list . > {FOREIGN_NAMES}"
                   for feature, name in listed if (feature, name) not in found]
    return violations, n_files


def print_list(root):
    print(HEADER + "\n".join(f"{feature} {name}" for feature, name in sorted(foreign_names(root)[0])))


if __name__ == "__main__":
    checking.main(__doc__, check, "--list", print_list)
