# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files as Tombolo reads them: sections, entries, includes, with their lines."""

from pathlib import Path

from .errors import TomboloError, nearest


class InputError(TomboloError):
    """What a user has to correct."""


class ParameterFile:
    """`entries` {path: (value, where)} and `sections` [path, ...], each path with "/" between sections; `text` is all that
    was read, so that a change of an included file is seen."""

    def __init__(self, path):
        self.path = Path(path)
        self.entries, self.sections, self.text = {}, [], ""
        self.read(self.path, [], [])

    def read(self, path, within, open_files):
        try:
            text = path.read_text("utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"The parameter file \"{path}\" cannot be read: {getattr(error, 'strerror', None) or error}.") from error
        if path.resolve() in open_files:
            raise InputError(f"{path}: this file includes itself.")
        self.text += f"# ---- file {path}\n{text}\n"
        sections, lines, joined = list(within), text.split("\n"), ""
        for number, line in enumerate(lines, 1):
            line = line.split("#", 1)[0].strip()
            if line.endswith("\\"):
                joined += line[:-1]
                continue
            line, joined, where = (joined + line).strip(), "", f"{path}:{number}"
            keyword, rest = (line.split(None, 1) + ["", ""])[:2]
            rest = rest.strip()
            if not line:
                continue
            if keyword.lower() == "set" and "=" in rest:
                name, value = (part.strip() for part in rest.split("=", 1))
                self.entries["/".join([*sections, name])] = value, where
            elif keyword.lower() == "subsection" and rest:
                sections.append(rest)
                if "/".join(sections) not in self.sections:
                    self.sections.append("/".join(sections))
            elif keyword.lower() == "end" and not rest:
                if len(sections) <= len(within):
                    raise InputError(f'{where}: "end" without a subsection that is open in this file.')
                sections.pop()
            elif keyword.lower() == "include" and rest:
                self.read(path.parent / rest.strip('"'), sections, [*open_files, path.resolve()])
            else:
                raise InputError(f'{where}: a line begins with "set", "subsection", "end" or "include", found "{line}".'
                                 + nearest(keyword, ["set", "subsection", "end", "include"]))
        if len(sections) > len(within):
            raise InputError(f'{path}: subsection "{sections[-1]}" is not closed: an "end" is missing.')

    def override(self, assignment):
        """Takes "Section/Entry = value" of the command line; without a value the entry is as though not set."""
        name, equals, value = (part.strip() for part in assignment.partition("="))
        if not equals:
            raise InputError(f'--set "{assignment}": allowed is "Section/Entry = value".')
        self.entries.pop(name, None)
        if value:
            self.entries[name] = value, "--set"
