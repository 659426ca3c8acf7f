# SPDX-License-Identifier: LGPL-2.1-or-later
"""Changes of parameter files and mesh files, each a function of a generator and a text.

Texts are bytes: a change may leave something that is no text. All randomness comes from the
generator, so that a seed repeats them.
"""

import re

# What is read as a number, or nearly.
EXTREMES = [b"0", b"-0", b"1", b"-1", b"2", b"3", b"-2", b"0.5", b"1e-300", b"-1e-300", b"1e300",
            b"-1e300", b"1e308", b"1.8e308", b"1e999", b"-1e999", b"4.9e-324", b"nan", b"-nan", b"inf",
            b"-inf", b"infinity", b"255", b"256", b"65535", b"65536", b"2147483647", b"2147483648",
            b"-2147483648", b"4294967295", b"4294967296", b"9223372036854775807",
            b"9223372036854775808", b"18446744073709551615", b"18446744073709551616", b"1e9", b"1e-9",
            b"1e5", b"100", b"1000", b"1000000", b"1000000000", b"0x10", b"1e", b"1e+", b".", b"-", b"+",
            b"1.2.3", b"1,2", b"1 2", b"1;2", b"1/0", b"0/0", b"", b"one", b"1\xc2\xbd", b"007"]

# Pieces of values of parameter files.
WORDS = [b"all", b"otherwise", b"none", b"paper", b"trace", b"true", b"false", b"x < 0", b"x > 1e9",
         b"x < y", b"x", b"t", b"x/0", b"sqrt(-1)", b"1/(x-x)", b"log(0)", b"if(x<1,2,3)", b"exp(1e4*t)",
         b"x min", b"x max", b"material 0", b"material 1", b"group a", b"material -1", b"free; free; free",
         b"0; 0; 0", b"free", b"1; 2", b"((((((((", b"))))", b"sin(", b"rand()", b"pi", b"x &&", b"1:2, 3:4",
         b"0: 1, 0: 2", b"0: -1, 1: 1e300", b"a: 0, 0", b"a: 0, 0; a: 1, 1", b"1 to 2 | 3 to 1", b"2 to 1 ratio 0",
         b"2 to 1 ratio 1e300", b"1 | 1 | 1", b",,,", b";;;", b"|", b"/", b"..", b"/dev/null", b"/dev/zero",
         b"case.prm", b"\\", b"#", b"$", b"=", b"set", b"end", b"%s%n", b"\xe2\x88\x9e", b"x" * 300]

NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
ENTRY = re.compile(rb"^(\s*set\s+)([^=\n]*?)(\s*=[ \t]*)([^\n]*)$", re.M)


def lines_of(text):
    return text.split(b"\n")


def drop_line(generator, text):
    lines = lines_of(text)
    del lines[generator.randrange(len(lines))]
    return b"\n".join(lines)


def double_line(generator, text):
    lines = lines_of(text)
    index = generator.randrange(len(lines))
    lines.insert(generator.choice([index, generator.randrange(len(lines) + 1)]), lines[index])
    return b"\n".join(lines)


def swap_lines(generator, text):
    lines = lines_of(text)
    first = generator.randrange(len(lines))
    second = generator.choice([min(first + 1, len(lines) - 1), generator.randrange(len(lines))])
    lines[first], lines[second] = lines[second], lines[first]
    return b"\n".join(lines)


def drop_lines(generator, text):
    lines = lines_of(text)
    begin = generator.randrange(len(lines))
    del lines[begin:begin + generator.randint(2, 12)]
    return b"\n".join(lines)


def repeat_lines(generator, text):
    lines = lines_of(text)
    begin = generator.randrange(len(lines))
    piece = lines[begin:begin + generator.randint(1, 12)]
    index = generator.randrange(len(lines) + 1)
    lines[index:index] = piece * generator.choice([1, 1, 2, 50])
    return b"\n".join(lines)


def truncate(generator, text):
    return text[:generator.randrange(len(text) + 1)]


def cut_out(generator, text):
    begin = generator.randrange(len(text) + 1)
    return text[:begin] + text[begin + generator.randint(1, 40):]


def flip_bits(generator, text):
    changed = bytearray(text)
    for _ in range(generator.choice([1, 1, 1, 3, 20])):
        if changed:
            changed[generator.randrange(len(changed))] ^= 1 << generator.randrange(8)
    return bytes(changed)


def random_bytes(generator, n):
    return bytes(generator.randrange(256) for _ in range(n))


def insert_bytes(generator, text):
    index = generator.randrange(len(text) + 1)
    piece = generator.choice([random_bytes(generator, generator.randint(1, 30)), b"\0", b"\r\n", b"\t", b"\n",
                              b"\xff\xfe", b"\xef\xbb\xbf", b"\xc3", b"a" * generator.choice([100, 200000]),
                              b"\x1b[31m", b"\v", b"\f"])
    return text[:index] + piece + text[index:]


def change_letter(generator, text):
    """A typing mistake: a letter left out, doubled, exchanged with the next, or another one."""
    letters = [match.start() for match in re.finditer(rb"[A-Za-z]", text)]
    if not letters:
        return text
    index = generator.choice(letters)
    letter, after = text[index:index + 1], text[index + 1:index + 2]
    return text[:index] + generator.choice([
        b"" + after, letter * 2 + after, after + letter, letter.swapcase() + after,
        bytes([generator.randrange(97, 123)]) + after]) + text[index + 2:]


def change_number(generator, text):
    numbers = list(NUMBER.finditer(text))
    if not numbers:
        return text
    match = generator.choice(numbers)
    return text[:match.start()] + other_number(generator, match.group()) + text[match.end():]


def other_number(generator, number):
    kind = generator.randrange(6)
    if kind < 3:
        return generator.choice(EXTREMES)
    try:
        value = float(number)
    except ValueError:
        return generator.choice(EXTREMES)
    if kind == 3:
        return (b"-" + number).replace(b"--", b"").replace(b"-+", b"-")
    if kind == 4 and abs(value) < 1e9 and value == int(value):
        return b"%d" % (int(value) + generator.choice([-1, 1, -2, 2, 7]))
    return b"%g" % (value * generator.choice([0.1, 0.5, 0.999, 1.001, 2., 10., 1e3, 1e-6, -1.]))


def exchange_numbers(generator, text):
    numbers = list(NUMBER.finditer(text))
    if len(numbers) < 2:
        return text
    first, second = sorted(generator.sample(range(len(numbers)), 2))
    first, second = numbers[first], numbers[second]
    return (text[:first.start()] + second.group() + text[first.end():second.start()] + first.group() +
            text[second.end():])


def change_line_ends(generator, text):
    return text.replace(b"\n", generator.choice([b"\r\n", b"\r", b"\n\n", b" \n"]))


def nothing_left(generator, text):
    return generator.choice([b"", b"\n\n", b" ", b"\0", random_bytes(generator, 2000), text[::-1]])


ANY_TEXT = [drop_line, drop_line, double_line, double_line, swap_lines, swap_lines, drop_lines, repeat_lines,
            truncate, cut_out, flip_bits, insert_bytes, change_letter, change_letter, change_number,
            change_number, change_number, exchange_numbers]
RARE = [change_line_ends, nothing_left]


class ParameterFiles:
    """Changes of sections and entries. `vocabulary` holds the declared entries of the seeds,
    as (section path, name, default value), and all values that they have."""

    def __init__(self, vocabulary, values):
        self.vocabulary = vocabulary
        self.values = values
        self.kinds = (ANY_TEXT + 5 * [self.change_value] + 3 * [self.change_number_of_value] +
                      3 * [self.add_entry] + 2 * [self.exchange_values] + [self.move_section, self.open_sections,
                                                                          self.include])

    def change(self, generator, text):
        kind = generator.choice(RARE) if generator.random() < 0.02 else generator.choice(self.kinds)
        return kind(generator, text)

    def another_value(self, generator):
        kind = generator.randrange(4)
        if kind == 0:
            return generator.choice(EXTREMES)
        if kind == 1:
            return generator.choice(WORDS)
        return generator.choice(self.values)

    def change_value(self, generator, text):
        entries = list(ENTRY.finditer(text))
        if not entries:
            return text
        match = generator.choice(entries)
        return text[:match.start(4)] + self.another_value(generator) + text[match.end(4):]

    def change_number_of_value(self, generator, text):
        """A number of a value, not of a comment."""
        entries = [match for match in ENTRY.finditer(text) if NUMBER.search(match.group(4))]
        if not entries:
            return text
        match = generator.choice(entries)
        return text[:match.start(4)] + change_number(generator, match.group(4)) + text[match.end(4):]

    def exchange_values(self, generator, text):
        entries = list(ENTRY.finditer(text))
        if len(entries) < 2:
            return text
        first, second = sorted(generator.sample(range(len(entries)), 2))
        first, second = entries[first], entries[second]
        return (text[:first.start(4)] + second.group(4) + text[first.end(4):second.start(4)] +
                first.group(4) + text[second.end(4):])

    def add_entry(self, generator, text):
        """An entry that some seed declares, in its section, with its default or another value."""
        path, name, default = generator.choice(self.vocabulary)
        value = default if generator.random() < 0.3 else self.another_value(generator)
        here = generator.choice(text_sections(text) or [b""])
        sections = path.split(b"/") if path else []
        # Names of parts, materials and so on are those of this text.
        if sections and b": " in sections[0]:
            kind = sections[0].split(b": ")[0]
            same_kind = [section for section in text_sections(text) if section.startswith(kind + b": ")]
            here = generator.choice(same_kind or [b""])
            sections[0] = here or sections[0]
        block = b"".join(b"subsection %s\n" % section for section in sections)
        block += b"set %s = %s\n" % (name, value) + b"end\n" * len(sections)
        return insert_into(text, block, sections)

    def move_section(self, generator, text):
        blocks = [match for match in re.finditer(rb"^subsection .*?^end$", text, re.M | re.S)]
        if not blocks:
            return text
        block = generator.choice(blocks)
        rest = text[:block.start()] + text[block.end():]
        if generator.random() < 0.3:
            return rest
        index = rest.find(b"\n", generator.randrange(len(rest) + 1))
        copies = generator.choice([1, 1, 2])
        return rest[:index] + b"\n" + (block.group() + b"\n") * copies + rest[index:]

    def open_sections(self, generator, text):
        index = text.find(b"\n", generator.randrange(len(text) + 1))
        n = generator.choice([1, 2, 100, 5000])
        piece = b"\nsubsection deep" * n + generator.choice([b"", b"\nset x = 1"])
        piece += generator.choice([b"", b"\nend" * n, b"\nend" * (n + 1)])
        return text[:index] + piece + text[index:]

    def include(self, generator, text):
        index = text.find(b"\n", generator.randrange(len(text) + 1))
        name = generator.choice([b"", b".", b"..", b"nowhere.prm", b"/dev/null", b"a/b/c.prm", b"case.prm",
                                 b"common.prm", b"mesh.msh"])
        return text[:index] + b"\ninclude " + name + text[index:]


def text_sections(text):
    """Names of the outermost sections."""
    return [match.group(1).strip() for match in re.finditer(rb"^subsection ([^\n]*)$", text, re.M)]


def insert_into(text, block, sections):
    """Puts the innermost lines of a block into the section of the text that is open already."""
    lines = lines_of(text)
    depth = 0
    matched = 0
    index = None
    for number, line in enumerate(lines):
        words = line.strip()
        if words.startswith(b"subsection "):
            if depth == matched and matched < len(sections) and words[11:].strip() == sections[matched]:
                matched += 1
                index = number + 1
                if matched == len(sections):
                    break
            depth += 1
        elif words == b"end":
            depth -= 1
            if depth < matched:
                break
    inner = lines_of(block.rstrip(b"\n"))
    if matched > 0:
        inner = inner[matched:len(inner) - matched]
    if index is None:
        index = len(lines)
    return b"\n".join(lines[:index] + inner + lines[index:])


# Words of mesh files, which some change puts where they do not belong.
MESH_WORDS = [b"$Nodes", b"$EndNodes", b"$Elements", b"$EndElements", b"$Entities", b"$PhysicalNames",
              b"$MeshFormat\n2.2 0 8\n$EndMeshFormat", b"4.1 0 8", b"2.2 1 8", b"$Periodic\n0\n$EndPeriodic",
              b"*NODE", b"*ELEMENT, TYPE=C3D8, ELSET=a", b"*ELEMENT, TYPE=C3D4", b"*SURFACE, NAME=s",
              b"*SURFACE", b"*ELSET, ELSET=a", b"*NODE, NSET=a", b"*", b"**", b"*,,,", b"POINTS 1 double",
              b"CELLS 1 9", b"CELL_TYPES 1", b"CELL_DATA 2", b"SCALARS MaterialID int", b"POINT_DATA 3",
              b"LOOKUP_TABLE default", b"BINARY", b"DATASET POLYDATA", b"METADATA", b"1 2 3", b"\"a\"", b"3 1 \"\"",
              b"1,", b", ,"]


def put_mesh_word(generator, text):
    lines = lines_of(text)
    index = generator.randrange(len(lines) + 1)
    if generator.random() < 0.5 and index < len(lines):
        lines[index] = generator.choice(MESH_WORDS)
    else:
        lines.insert(index, generator.choice(MESH_WORDS))
    return b"\n".join(lines)


def change_field(generator, text):
    """One number of a line with numbers becomes that of another line."""
    numbers = list(NUMBER.finditer(text))
    if len(numbers) < 2:
        return text
    match, other = generator.sample(numbers, 2)
    return text[:match.start()] + other.group() + text[match.end():]


class MeshFiles:
    """Changes of mesh files."""

    def __init__(self):
        self.kinds = ANY_TEXT + 3 * [change_number] + 3 * [change_field] + 2 * [put_mesh_word]

    def change(self, generator, text):
        kind = generator.choice(RARE) if generator.random() < 0.02 else generator.choice(self.kinds)
        return kind(generator, text)
