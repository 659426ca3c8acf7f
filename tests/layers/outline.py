# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads C++ without a compiler: where classes, their members and functions are in a file.

It needs no more than balanced braces. Comments, texts and lines of the preprocessor are blanked out
first. Then each brace at the level of a namespace or a class is judged by the words before it. What
is inside of a function, lambdas and local classes too, belongs to that function.
"""

import collections
import re

# A function: the names of the classes around it (empty if there are none), its own name, its first
# and its last line. Lines are counted from the return type, or from `template`, to the last brace.
Function = collections.namedtuple("Function", "scope name first last")
# A class: its names from the outermost, its lines, the number of its data members.
Class = collections.namedtuple("Class", "scope first last members")

BLANKED = re.compile(
    r'//[^\n]*|/\*.*?\*/'
    r'|R"(?P<delimiter>[^(\s]*)\(.*?\)(?P=delimiter)"'
    r'|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'"
    r'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*', re.S | re.M)
CLASS_KEY = re.compile(r"(?:class|struct|union)\b\s*((?:\w+\s*::\s*)*\w*)")
VERSION = re.compile(r"(?:class|struct|union) (\w+) ?(<[^:]*>)$")
NO_DATA = re.compile(r"(?:using|typedef|friend|static_assert|static|enum|extern|template|operator|virtual)\b")
ACCESS = re.compile(r"\s*(?:public|protected|private)\s*:(?!:)")
# What may be between the parameters of a constructor and its body, if that is not the body.
CONSTRUCTOR_LIST = re.compile(r"\)\s*(?:noexcept\s*)?:(?!:)")


def blank(text):
    """The text with the same lines, without comments, texts and the preprocessor."""
    def spaces(match):
        quote = match.group()[:1] if match.group()[:1] in "\"'" else " "
        # A text stays a value: two quotes, so that no statement becomes empty.
        return quote * (quote != " ") + re.sub(r"[^\n]", " ", match.group()[1:] if quote != " " else match.group())
    return BLANKED.sub(spaces, text)


def without_templates(text):
    """Without template arguments and the heads of templates: `<...>` of all depths, `template` too."""
    text = re.sub(r"operator\s*(?:<=|>=|<<|>>|->|<|>|=)=?", "operator_", text).replace("->", "  ")
    text = re.sub(r"<<|<=|>=", "  ", text)
    while True:
        shorter = re.sub(r"<[^<>;{}]*>", " ", text)
        if shorter == text:
            return re.sub(r"\btemplate\b", " ", text)
        text = shorter


def without_attributes(text):
    return re.sub(r"\[\[.*?\]\]|\balignas\s*\([^)]*\)|\b__attribute__\s*\(\(.*?\)\)", " ", text)


def declarators(text):
    """The parts of a declaration between its commas, without what they are set to."""
    parts, depth, in_value = [""], 0, False
    for index, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if depth == 0 and character == ",":
            parts.append("")
            in_value = False
            continue
        neighbours = text[index - 1:index] + text[index + 1:index + 2]
        in_value = in_value or (depth == 0 and character == "=" and not set(neighbours) & set("=!<>+-*/%&|^"))
        if not in_value:
            parts[-1] += character
    return parts


def data_members(statement):
    """The number of data members that a statement in a class declares."""
    plain = " ".join(without_attributes(without_templates(statement)).split())
    while ACCESS.match(plain):
        plain = ACCESS.sub("", plain, count=1).strip()
    plain = re.sub(r"^(?:mutable|inline|constexpr|const)\s+", "", plain)
    parts = declarators(plain)
    if not plain or NO_DATA.match(plain) or re.search(r"\boperator", parts[0]):
        return 0
    if re.search(r"\(\s*\*\s*\w*\s*\)\s*\(", parts[0]):  # a pointer to a function
        return 1
    if "(" in parts[0] or re.fullmatch(r"(?:class|struct|union)\s+[\w:]+", plain):
        return 0
    return len(parts)


class Scope:
    def __init__(self, kind, names, first):
        self.kind = kind  # "namespace", "class", "function" or "value"
        self.names = names  # of classes
        self.first = first
        self.members = 0
        self.keeps = ""  # what is before a value goes on behind it


class Outline:
    """The functions and classes of one file."""

    def __init__(self, text):
        self.functions = []
        self.classes = []
        self.n_lines = len(text.splitlines())
        self._read(blank(text))

    def _read(self, text):
        line = 1
        scopes = [Scope("namespace", (), 1)]
        statement, begin, parentheses = "", None, 0
        for character in text:
            scope = scopes[-1]
            listens = scope.kind in ("namespace", "class")
            if character == "\n":
                line += 1
            if not listens:
                if character == "{":
                    scopes.append(Scope("value" if scope.kind == "value" else "function", scope.names, line))
                    scopes[-1].inner = True
                elif character == "}":
                    self._close(scopes, line)
                    if not getattr(scope, "inner", False):
                        statement = scope.keeps
                        if not statement:
                            begin = None
                continue
            parentheses += (character == "(") - (character == ")")
            if character == "{" and parentheses == 0:
                opened = self._opened(statement, scope, begin if begin is not None else line)
                scopes.append(opened)
                if opened.kind != "value":
                    statement, begin = "", None
            elif character == "{":  # a value among the parameters
                opened = Scope("value", scope.names, line)
                opened.keeps = statement + " "
                scopes.append(opened)
            elif character == "}":
                self._close(scopes, line)
                statement, begin = "", None
            elif character == ";" and parentheses == 0:
                if scope.kind == "class":
                    scope.members += data_members(statement)
                statement, begin = "", None
            else:
                if begin is None and not character.isspace():
                    begin = line
                statement += character
                if scope.kind == "class" and character == ":" and ACCESS.fullmatch(statement):
                    statement, begin = "", None
        if len(scopes) != 1 or parentheses != 0:
            raise ValueError("the braces are not balanced")

    def _opened(self, statement, scope, first):
        """The scope that the brace after `statement` begins."""
        plain = without_attributes(without_templates(statement)).strip()
        if re.match(r"(?:inline\s+)?namespace\b", plain) or plain.startswith("extern \""):
            return Scope("namespace", scope.names, first)
        match = CLASS_KEY.match(plain)
        if match and "(" not in plain and not re.search(r"(?<![=!<>])=(?!=)", plain):
            names = re.findall(r"\w+", match.group(1)) or ["(unnamed)"]
            version = VERSION.search(" ".join(statement.split()))  # a class of its own
            if version and names == version.group(1).split():
                names = ["".join(version.groups())]
            return Scope("class", scope.names + tuple(names), first)
        parts = declarators(plain)
        before = parts[0]
        is_value = ("(" not in before or plain.startswith("enum") or ",".join(parts) != plain
                    or (CONSTRUCTOR_LIST.search(plain) and re.search(r"[\w>:]$", plain)
                        and not re.search(r"[)}]\s*(?:const|noexcept|override|final|try)$", plain)))
        if is_value and not re.search(r"\boperator", before.split("(")[0]):
            opened = Scope("value", scope.names, first)
            opened.keeps = statement + " {} "
            return opened
        opened = Scope("function", scope.names, first)
        match = re.search(r"((?:\w+\s*::\s*)*)(~?\w+|operator\b[^(]*)\s*$", before.split("(")[0])
        qualifier = tuple(re.findall(r"\w+", match.group(1))) if match else ()
        opened.names = scope.names + qualifier
        opened.name = " ".join(match.group(2).split()) if match else "(unnamed)"
        return opened

    def _close(self, scopes, line):
        scope = scopes.pop()
        if scope.kind == "class":
            self.classes.append(Class(scope.names, scope.first, line, scope.members))
        elif scope.kind == "function" and not getattr(scope, "inner", False):
            self.functions.append(Function(scope.names, scope.name, scope.first, line))
