#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Formulas of the pages become MathML, each of them without an error. Ends with 77 where blahtexml is missing."""

import re
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path
from unittest import mock

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))

from pages import formulas, text  # noqa: E402

SKIPPED = 77

PAGE = """# A page

Of $`x_I`$ and `code`, and over
lines $`\\hat v < 1`$; $c_1$ is one, `$c$`, $5 and 6$ are none.

```math
x = \\frac12 \\tag{M1}
```

```
$`no formula`$
```

| a | $`b`$ |
|---|---|
"""


class FormulasTest(unittest.TestCase):
    def test_formulas_are_found_with_their_lines(self):
        self.assertEqual(formulas.formulas_of(PAGE), [(3, "x_I", False), (4, "\\hat v < 1", False), (4, "c_1", False),
                                                      (6, "x = \\frac12 \\tag{M1}", True), (14, "b", False)])

    def test_every_formula_of_the_pages_is_converted(self):
        wrong, n_formulas = [], 0
        for page in text.pages_of(PROJECT) + text.tables_of(PROJECT):
            for line, tex, is_block in formulas.formulas_of((PROJECT / page).read_text("utf-8")):
                n_formulas += 1
                try:
                    xml.etree.ElementTree.fromstring(formulas.mathml(formulas.TAG.sub("", tex), is_block))
                except (formulas.FormulaError, xml.etree.ElementTree.ParseError) as error:
                    wrong.append(f"{page}:{line}: {error}")
        self.assertEqual(wrong, [], "\n".join(wrong))
        self.assertGreater(n_formulas, 400)

    def test_no_formula_begins_without_its_end(self):
        for page in text.pages_of(PROJECT) + text.tables_of(PROJECT):
            for block in text.blocks_of((PROJECT / page).read_text("utf-8")):
                if block.kind in ("text", "table"):
                    left = formulas.INLINE.sub("", block.text)
                    self.assertIsNone(re.search(r"\$`|`\$", left), f"{page}:{block.line}: {left}")

    def test_what_a_formula_means_is_kept(self):
        element = formulas.mathml("\\sum_J \\varphi_J = \\frac{1}{2} < \\hat m")
        for tag in ("<msub>", "<mfrac>", "φ", "&lt;", "<mover>"):
            self.assertIn(tag, element)
        self.assertIn("<mn>0.01</mn>", formulas.mathml("0.01 h"))
        self.assertIn('display="block"', formulas.mathml("x", True))

    def test_a_formula_that_is_wrong_is_told(self):
        with self.assertRaisesRegex(formulas.FormulaError, r'\\fraction\{1\}\{2\}: Unrecognised command "\\fraction"'):
            formulas.mathml("\\fraction{1}{2}")

    def test_numbers_stand_beside_equations(self):
        body = '<p>$<code>a &lt; b</code>$</p><pre><code class="language-math">x = y \\tag{M1}\n</code></pre>'
        page = formulas.in_page(body)
        self.assertIn('<span class="number">(M1)</span></div>', page)
        self.assertEqual(page.count("<math"), 2)
        with mock.patch.object(formulas, "can_be_converted", return_value=False):
            self.assertEqual(formulas.in_page(body), "<p><code>a &lt; b</code></p><pre><code>x = y \\tag{M1}\n</code></pre>")


if __name__ == "__main__":
    if not formulas.can_be_converted():
        print(f"There is no {formulas.PROGRAM} (`scripts/setup {formulas.PROGRAM}` installs it): no formula was converted.")
        sys.exit(SKIPPED)
    unittest.main()
