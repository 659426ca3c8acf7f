#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Proves that check_layers.py can fail: one small project per rule, each with one mistake."""

import textwrap
import unittest

import check_layers
import outline
import small_project


def function(name, n_lines):
    """A function of so many lines."""
    return f"void {name}()\n{{\n" + "  step();\n" * (n_lines - 3) + "}\n"


def members(n):
    return "".join(f"  double member_{i} = 0;\n" for i in range(n))


class CheckLayersTest(unittest.TestCase):
    def violations(self, files):
        return small_project.violations(check_layers.check, files)

    def assert_only(self, files, expected):
        found = self.violations(files)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(expected), found)

    def test_lower_layers_may_be_included(self):
        self.assertEqual(self.violations({
            "include/tombolo/formulations/hexahedron.h":
                "#include <tombolo/base/a.h>\n#include <tombolo/mesh/a.h>\n"
                "#include <tombolo/state/a.h>\n#include <tombolo/approximation/a.h>\n"
                "#include <tombolo/materials/a.h>\n#include <tombolo/version.h>\n",
            "source/formulations/hexahedron.cc":
                "#include <tombolo/formulations/hexahedron.h>\n",
            "applications/program.cc": "#include <tombolo/simulation/simulation.h>\n",
        }), [])

    def test_a_higher_layer_is_refused_with_its_line(self):
        self.assert_only(
            {"include/tombolo/base/a.h": "#pragma once\n#include \"tombolo/state/field.h\"\n"},
            "include/tombolo/base/a.h:2: base must not include state")

    def test_every_upward_pair_is_refused(self):
        order = [["base"], ["mesh"], ["state"], ["approximation", "materials"],
                 ["formulations", "boundary", "contact"], ["coupling", "remesh"], ["output"],
                 ["model"], ["physics"], ["simulation"]]
        self.assertEqual({layer for rank in order for layer in rank}, set(check_layers.ALLOWED))
        for rank, layers in enumerate(order):
            for layer in layers:
                for others in order[rank:]:
                    for other in others:
                        problem = check_layers.check_include(layer, f"{other}/a.h")
                        self.assertEqual(problem is None, layer == other, (layer, other))

    def test_approximation_and_materials_know_no_mesh_and_not_each_other(self):
        for layer, other in (("approximation", "mesh"), ("materials", "mesh"),
                             ("approximation", "materials"), ("materials", "approximation")):
            self.assert_only(
                {f"include/tombolo/{layer}/a.h": f"#include <tombolo/{other}/b.h>\n"},
                f"include/tombolo/{layer}/a.h:1: {layer} must not include {other}")

    def test_a_layer_that_does_not_exist_is_refused(self):
        self.assert_only({"applications/a.cc": "#include <tombolo/utilities/a.h>\n"},
                         "applications/a.cc:1: tombolo/utilities/a.h is in no layer")
        self.assert_only({"include/tombolo/utilities/a.h": ""},
                         "include/tombolo/utilities/a.h:1: is in the directory of no layer")

    def test_a_source_implements_a_header_of_its_layer(self):
        self.assert_only({
            "include/tombolo/mesh/a.h": "",
            "source/mesh/a.cc": "#include <tombolo/mesh/b.h>\n",
        }, "source/mesh/a.cc:1: does not include its own header")
        self.assert_only({"source/mesh/b.cc": "#include <tombolo/base/b.h>\n"},
                         "source/mesh/b.cc:1: has no header of its own")

    def test_a_header_among_the_sources_is_refused(self):
        self.assert_only({"source/mesh/a.h": ""}, "source/mesh/a.h:1: headers belong into")

    def test_a_long_file_is_refused(self):
        self.assertEqual(self.violations({"applications/a.cc": "\n" * 600}), [])
        self.assert_only({"applications/a.cc": "\n" * 601}, "applications/a.cc:601: has 601 lines")

    def test_a_path_of_one_machine_is_refused(self):
        # Put together here, so that this file does not name one.
        path = "/" + "home/somebody/mesh.msh"
        self.assert_only({"applications/a.cc": f"\nread(\"{path}\");\n"},
                         "applications/a.cc:2: names a path of one machine")

    def test_exceptions_of_debug_builds_are_qualified(self):
        assertion = "#pragma once\nvoid f() { Assert(a, INTERNAL()); }\n"
        self.assert_only({"include/tombolo/base/a.h": assertion.replace("INTERNAL", "ExcInternalError")},
                         "include/tombolo/base/a.h:2: names an exception of deal.II")
        self.assertEqual(
            self.violations({"include/tombolo/base/a.h":
                             assertion.replace("INTERNAL", "dealii::ExcInternalError")}), [])

    def test_a_long_function_is_refused(self):
        self.assertEqual(self.violations({"applications/a.cc": function("f", 80)}), [])
        self.assert_only({"applications/a.cc": "\n" + function("f", 81)},
                         "applications/a.cc:2: a.cc:f has 81 lines, more than 80")
        self.assert_only({"include/tombolo/base/a.h": "class A\n{\n" + function("f", 81) + "};\n"},
                         "include/tombolo/base/a.h:3: A::f has 81 lines, more than 80")

    def test_of_two_versions_of_a_function_the_longer_counts(self):
        self.assert_only({"applications/a.cc": function("f", 81) + function("f", 5)}, "applications/a.cc:1: a.cc:f")
        self.assert_only({"applications/a.cc": function("f", 5) + function("f", 81)}, "applications/a.cc:6: a.cc:f")

    def test_a_class_with_many_data_members_is_refused(self):
        header = "include/tombolo/base/a.h"
        self.assertEqual(self.violations({header: "class A\n{\n" + members(25) + "};\n"}), [])
        self.assert_only({header: "class A\n{\n" + members(26) + "};\n"},
                         f"{header}:1: A has 26 data members, more than 25")
        # Those of a class in a class are its own.
        inner = "  struct Inner\n  {\n" + members(26) + "  };\n"
        self.assert_only({header: "class A\n{\n" + members(25) + inner + "};\n"},
                         f"{header}:28: A::Inner has 26 data members")

    def test_a_class_is_counted_over_all_its_files(self):
        def project(n_in_third):
            header = "class A\n{\n  void f();\n  void g();\n};\n" + "\n" * 95
            first = "#include <tombolo/base/a.h>\nnamespace\n{\n" + function("help", 50) + "}\n"
            first += function("A::f", 50) + "\n" * 300
            second = "#include <tombolo/base/a.h>\ntemplate <int dim>\n"
            second += function("A<dim>::g", 50).replace("void ", "std::vector<Pair<int, int>> ")
            second += "\n" * n_in_third
            return {"include/tombolo/base/a.h": header, "source/base/a.cc": first, "source/base/b.cc": second}

        # 100 + 404 + 52 lines.
        self.assertEqual(self.violations(project(44)), [])
        self.assert_only(project(45), "include/tombolo/base/a.h:1: A has 601 lines over all its files, more than 600")
        several = project(44)
        several["include/tombolo/base/other.h"] = "template <>\nstruct A<int>\n{};\n"
        self.assertEqual(self.violations(several), [])
        several["include/tombolo/base/other.h"] = several["include/tombolo/base/other.h"].replace("<int>", "")
        self.assertEqual(len(self.violations(several)), 1)

    def test_lines_of_another_class_in_a_file_do_not_count(self):
        header = "class A\n{\n  void f();\n};\nclass B\n{\n  void f();\n};\n"
        source = "#include <tombolo/base/a.h>\n" + "".join(function(f"A::f{i}", 50) for i in range(9))
        other = "#include <tombolo/base/a.h>\n" + "".join(function(f"B::f{i}", 50) for i in range(9))
        more = "#include <tombolo/base/a.h>\n" + function("A::g", 80) + function("B::g", 70)
        self.assertEqual(self.violations({"include/tombolo/base/a.h": header, "source/base/a.cc": source,
                                          "source/base/b.cc": other, "source/base/c.cc": more}), [])

    def test_classes_of_two_sources_are_two_though_they_have_one_name(self):
        text = "#include <tombolo/base/a.h>\nstruct A\n{\n" + "\n" * 396 + "};\n"
        self.assertEqual(self.violations({"include/tombolo/base/a.h": "", "source/base/a.cc": text,
                                          "source/base/b.cc": text}), [])

    def with_known(self, known, *length):
        files = {"applications/a.cc": "".join(function("f", n) for n in length) or "\n"}
        return {**files, check_layers.KNOWN_OFFENDERS: "# kind name number\n" + known}

    def test_a_known_offender_may_shrink_and_not_grow(self):
        for length in (90, 85):
            self.assertEqual(self.violations(self.with_known("function a.cc:f 90\n", length)), [])
        self.assert_only(self.with_known("function a.cc:f 90\n", 91),
                         "applications/a.cc:1: a.cc:f has 91 lines, more than 90")

    def test_an_entry_that_is_no_offender_has_to_be_removed(self):
        for length in ((80,), ()):
            self.assert_only(self.with_known("function a.cc:f 90\n", *length),
                             "tests/layers/known_offenders.txt:1: function a.cc:f is no offender any more")

    def test_a_list_with_a_mistake_is_refused(self):
        for known in ("method a.cc:f 90\n", "function a.cc:f 90\nfunction a.cc:f 91\n", "function a.cc:f\n"):
            with self.assertRaises(ValueError):
                self.violations(self.with_known(known, 90))

    def test_braces_that_are_not_balanced_are_told(self):
        self.assert_only({"applications/a.cc": "void f()\n{\n"}, "applications/a.cc:1: cannot be read")


class OutlineTest(unittest.TestCase):
    def read(self, text):
        return outline.Outline(textwrap.dedent(text))

    def names(self, text):
        return ["::".join(each.scope + (each.name,)) for each in self.read(text).functions]

    def test_names_of_functions(self):
        for text, name in (
                ("int main(int argc, char **argv) {}", "main"),
                ("template <int dim> void A<dim>::f() {}", "A::f"),
                ("template <int dim, class = std::enable_if_t<(dim > 1)>> A<dim>::A(int x) : a(x), b{x} {}", "A::A"),
                ("A::A() : a(1), b{{1, 2}} { if (a) { f(); } }", "A::A"),
                ("A::A() : Base<int>{1}, b{2} {}", "A::A"),
                ("A::~A() noexcept {}", "A::~A"),
                ("auto A::f(const std::function<void(int)> &g) const -> std::vector<int> {}", "A::f"),
                ("bool A::operator<(const A &other) const {}", "A::operator_"),
                ("std::ostream &operator<<(std::ostream &out, const A &a) {}", "operator_"),
                ("double A::operator()(const int i) const {}", "A::operator"),
                ("A &A::operator=(A &&) {}", "A::operator_"),
                ("void f(const std::vector<int> &v = {1, 2}) {}", "f"),
                ("[[nodiscard]] inline double f(int x) {}", "f"),
                ("namespace a::b { namespace { void f() {} } }", "f"),
                ("extern \"C\" { void f() {} }", "f"),
                ("class A final : public B<int> { int f() const override { return 1; } };", "A::f"),
                ("struct A { struct B { void f() {} }; };", "A::B::f"),
                ("template <int dim> struct A<dim>::B { void f() {} };", "A::B::f")):
            with self.subTest(text=text):
                self.assertEqual(self.names(text), [name])

    def test_what_is_no_function(self):
        for text in ("int a[] = {1, 2, 3};", "const A a{f(1)};", "enum class A { b, c };", "class A { int b{1}; };",
                     "// void f() {\n", "/* void f() { */", "const char *a = \"void f() {\";",
                     "char a = '{';", "#define A(x) { \\\n  x\nint b;", "auto a = R\"(void f() { )\";",
                     "using A = B<sizeof(int)>;", "class A { int f() const; };", "class A;"):
            with self.subTest(text=text):
                self.assertEqual(self.read(text).functions, [])

    def test_lines_of_a_function(self):
        found = self.read("""\
            int a;

            // What it is for.
            template <int dim>
            void f(const int x,
                   const int y)
            {
              const auto g = [&](int z) {
                return "}" + z;
              };
              struct Local { int h() { return 1; } };
            }
            """).functions
        self.assertEqual([(each.name, each.first, each.last) for each in found], [("f", 4, 12)])

    def test_lines_of_a_class(self):
        found = self.read("""\
            struct B;
            /// Words.
            template <int dim>
            class A : public C<dim>
            {
            public:
              int f() const
              {
                return 1'000'000;
              }

            private:
              int b = 1;
            };
            """)
        self.assertEqual(found.classes, [outline.Class(("A",), 3, 14, 1)])
        self.assertEqual([(each.first, each.last) for each in found.functions], [(7, 10)])

    def test_data_members(self):
        for text, number in (
                ("int a;", 1), ("int a, b = 2, c{3};", 3), ("std::map<int, std::array<double, 3>> a;", 1),
                ("const A &a;", 1), ("mutable std::vector<int> a = {1, 2};", 1), ("int a = f(1, 2);", 1),
                ("std::function<void(int, double)> a;", 1), ("void (*a)(int);", 1), ("bool a : 1;", 1),
                ("alignas(64) std::array<double, 8> a;", 1), ("struct B { int c; } b;", 1),
                ("std::function<int()> a = [] { return 1; };", 1), ("int a[3] = {1, 2, 3};", 1),
                ("public:\n  int a;\nprivate:\n  int b;", 2), ("std::array<bool, (1 << 3)> a{};", 1),
                ("static constexpr int a = 1;", 0), ("using B = int;", 0), ("friend class B;", 0),
                ("enum class B { c, d };", 0), ("virtual void f() = 0;", 0), ("A(const A &) = delete;", 0),
                ("A &operator=(const A &) = default;", 0), ("bool operator==(const A &) const;", 0),
                ("void f(int a = 1, int b = 2);", 0), ("struct B;", 0), ("struct B { int c; };", 0),
                ("template <int n> void f(std::array<int, n> a);", 0), ("int f() { int a; return a; }", 0),
                ("std::vector<std::pair<int, int>> f(const B &b) const;", 0), ("static_assert(1 < 2);", 0)):
            with self.subTest(text=text):
                found = self.read("class A\n{\n" + text + "\n};\n").classes
                self.assertEqual([each.members for each in found if each.scope == ("A",)], [number])


if __name__ == "__main__":
    unittest.main()
