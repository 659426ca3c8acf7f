# SPDX-License-Identifier: LGPL-2.1-or-later
"""Expressions of *PARAMETER_EXPRESSION: numbers of Fortran, parameters, + - * / **, brackets, functions."""

import ast
import math
import re

EXPONENT = re.compile(r"(?<![A-Za-z_])(\d+\.?\d*|\.\d+)[dD]([+-]?\d+)")
FUNCTIONS = {
    "abs": abs, "min": min, "max": max, "int": int, "aint": lambda x: float(int(x)), "float": float, "real": float,
    "nint": lambda x: int(math.copysign(math.floor(abs(x) + 0.5), x)),
    "anint": lambda x: math.copysign(math.floor(abs(x) + 0.5), x), "mod": math.fmod,
    "sign": lambda x, y: math.copysign(x, y), "dim": lambda x, y: max(x - y, 0),
    **{name: getattr(math, name) for name in
       ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh")}}


class ExpressionError(Exception):
    """What is wrong with an expression."""


def divided(a, b):
    """Of two integers without remainder, as in Fortran."""
    if isinstance(a, int) and isinstance(b, int):
        return int(math.copysign(abs(a) // abs(b), a * b)) if a else 0
    return a / b


def raised(a, b):
    if isinstance(a, int) and isinstance(b, int) and b < 0:
        return int(1 / a) if a else 1 / 0
    return math.pow(a, b) if isinstance(a, float) or isinstance(b, float) else a ** b if abs(b) < 64 else 1 / 0


OPERATORS = {ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b, ast.Div: divided,
             ast.Pow: raised}


def value_of_expression(text, parameters):
    """An integer or a float; parameters are values by their names in small letters."""
    source = EXPONENT.sub(r"\1e\2", text.strip().lower().replace("&", ""))
    try:
        return value_of_node(ast.parse(source, mode="eval").body, parameters)
    except (SyntaxError, ValueError, TypeError, MemoryError, RecursionError):
        raise ExpressionError(f'"{text.strip()}" is no expression of numbers, parameters, + - * / ** and functions') \
            from None
    except (ZeroDivisionError, OverflowError):
        raise ExpressionError(f'"{text.strip()}" has no finite value') from None


def value_of_node(node, parameters):
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return node.value
    if isinstance(node, ast.Name):
        if node.id not in parameters:
            raise ExpressionError(f'there is no parameter "{node.id}" before it')
        return parameters[node.id]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = value_of_node(node.operand, parameters)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](*(value_of_node(one, parameters) for one in (node.left, node.right)))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in FUNCTIONS:
            raise ExpressionError(f'there is no function "{node.func.id}"')
        return FUNCTIONS[node.func.id](*(value_of_node(one, parameters) for one in node.args))
    raise SyntaxError
