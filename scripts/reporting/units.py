# SPDX-License-Identifier: LGPL-2.1-or-later
"""Units of a run in SI units with a prefix that suits the numbers: N, Pa, J, µs."""

import math
import re
from dataclasses import dataclass

# Dimensions are exponents of mass, length, time and temperature.
SYMBOLS = {"g": (1e-3, (1, 0, 0, 0)), "m": (1, (0, 1, 0, 0)), "s": (1, (0, 0, 1, 0)),
           "N": (1, (1, 1, -2, 0)), "Pa": (1, (1, -1, -2, 0)), "J": (1, (1, 2, -2, 0)),
           "W": (1, (1, 2, -3, 0))}
PREFIXES = {"n": 1e-9, "µ": 1e-6, "μ": 1e-6, "u": 1e-6, "m": 1e-3, "c": 1e-2, "": 1, "k": 1e3, "M": 1e6,
            "G": 1e9}
OTHERS = {"t": (1e3, (1, 0, 0, 0)), "K": (1, (0, 0, 0, 1))}

# What quantities are called in, with the factor to the unit without prefix; "" for no prefix.
NAMED = {(0, 0, 1, 0): ("s", 1, "nµm"), (0, 1, 0, 0): ("m", 1, "nµm"), (1, 0, 0, 0): ("g", 1e-3, "µmk"),
         (1, 1, -2, 0): ("N", 1, "µmkM"), (1, -1, -2, 0): ("Pa", 1, "mkMG"),
         (1, 2, -2, 0): ("J", 1, "nµmkM"), (1, 2, -3, 0): ("W", 1, "µmkMG"),
         (0, 1, -1, 0): ("m/s", 1, "µm"), (1, 1, -1, 0): ("N s", 1, "nµmk"),
         (1, 2, -1, 0): ("N m s", 1, "nµmk"), (1, -3, 0, 0): ("kg/m³", 1, ""),
         (0, 0, 0, 1): ("K", 1, ""), (0, 0, -1, 0): ("1/s", 1, "kM"), (0, 1, -2, 0): ("m/s²", 1, ""),
         (0, 2, 0, 0): ("m²", 1, ""), (0, 3, 0, 0): ("m³", 1, "")}
PREFIX_VALUES = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
# At this size a quantity has its next prefix; the others at a thousand.
STAYS_UNTIL = {"m/s": 1e5, "K": math.inf}

TOKEN = re.compile(r"\s*(?:([A-Za-zµμ]+)|(\d+)|(\^-?\d+)|([/()]))")
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def symbol(text):
    """Factor to SI and dimension of a unit symbol, or None."""
    if text in OTHERS:
        return OTHERS[text]
    for name, (factor, dimension) in SYMBOLS.items():
        prefix = text[:len(text) - len(name)]
        if text.endswith(name) and prefix in PREFIXES:
            return factor * PREFIXES[prefix], dimension
    return None


def tokens_of(text):
    position, result = 0, []
    while text[position:].strip():
        match = TOKEN.match(text, position)
        if match is None:
            return None
        result.append(match.group().strip())
        position = match.end()
    return result


def parse(text):
    """Factor to SI and dimension of a unit such as "kg m^2/s^2" or "t/(mm s^2)", or None where it
    has symbols that are not known."""
    tokens = tokens_of(text)
    if not tokens:
        return None
    factor, dimension = 1.0, [0, 0, 0, 0]
    # A slash holds for the next symbol, or for the bracket that follows it.
    sign, outer = 1, []
    for index, token in enumerate(tokens):
        if token == "/":
            sign = -sign
        elif token == "(":
            outer.append(sign)
        elif token == ")":
            if not outer:
                return None
            outer.pop()
            sign = outer[-1] if outer else 1
        elif token.startswith("^"):
            continue
        else:
            following = tokens[index + 1] if index + 1 < len(tokens) else ""
            power = sign * (int(following[1:]) if following.startswith("^") else 1)
            known = (float(token), (0, 0, 0, 0)) if token.isdigit() else symbol(token)
            if known is None or known[0] == 0:
                return None
            factor *= known[0]**power
            dimension = [own + power * more for own, more in zip(dimension, known[1])]
            sign = outer[-1] if outer else 1
    return (factor, tuple(dimension)) if not outer else None


def typeset(unit):
    """Powers as superscripts."""
    return re.sub(r"\^(-?\d+)", lambda match: match.group(1).translate(SUPERSCRIPTS), unit)


@dataclass
class Scale:
    """Numbers of the run times `factor` are in the unit `label`."""
    factor: float = 1.0
    label: str = ""

    def heading(self, name):
        return f"{name} [{self.label}]" if self.label else name


def dimension_of(unit):
    parsed = parse(unit)
    return parsed[1] if parsed else None


def scale_for(largest, unit, name=""):
    """The scale of a quantity whose largest absolute number is `largest`, in units of the run."""
    parsed = parse(unit) if unit else None
    if parsed is None or parsed[1] not in NAMED:
        return Scale(1.0, typeset(unit))
    base, base_factor, prefixes = NAMED[parsed[1]]
    if base == "J" and ("torque" in name or "moment" in name):
        base = "N m"
    factor = parsed[0] / base_factor
    size = abs(largest) * factor
    if not (size > 0 and math.isfinite(size)):
        return Scale(factor * 1e-3, "kg") if base == "g" else Scale(factor, base)
    limit = STAYS_UNTIL.get(base, 1e3)
    best = ("", 1.0)
    smallest = min([1.0] + [PREFIX_VALUES[one] for one in prefixes])
    # 0.0999... of a unit that is one but for round-off keeps its prefix.
    if size >= limit * (1 - 1e-9) and prefixes:
        larger = [one for one in prefixes if PREFIX_VALUES[one] > 1]
        fitting = [one for one in larger if size >= PREFIX_VALUES[one] * (1 - 1e-9)]
        best = max(((one, PREFIX_VALUES[one]) for one in fitting), key=lambda pair: pair[1], default=best)
    elif 1e-3 * smallest < size < 1 - 1e-9 and not (base in ("m/s", "N m", "J", "N") and size >= 0.1):
        smaller = sorted((one for one in prefixes if PREFIX_VALUES[one] < 1), key=PREFIX_VALUES.get)
        for one in reversed(smaller):
            best = (one, PREFIX_VALUES[one])
            if size >= PREFIX_VALUES[one] * (1 - 1e-9):
                break
    # Round-off has the unit without prefix.
    return Scale(factor / best[1], best[0] + base)


def number(value, digits=4):
    """A number as text, with a power of ten where it is very small or large."""
    if value is None or not math.isfinite(value):
        return "–" if value is None or math.isnan(value) else ("∞" if value > 0 else "−∞")
    if 1e-3 <= abs(value) < 1e6:
        decimals = max(0, digits - 1 - math.floor(math.log10(abs(value)) + 1e-12))
        text = f"{value:.{decimals}f}"
        return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return mantissa.replace("-", "−")
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPTS)}".replace("-", "−", 1)


def quantity(value, unit, name="", digits=4):
    """A number with its unit, such as "25.4 mm"."""
    scale = scale_for(value, unit, name)
    return f"{number(value * scale.factor, digits)} {scale.label}".strip()
