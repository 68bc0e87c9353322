# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/mutate.
"""Where the C++ of a translation unit can be mutated, by Clang's AST, and the text that chooses at run time.

Only bodies of functions, and there only built-in types: arithmetic, comparison, logic, integers, conditions, statements and
returned values. A mutation is an edit of the source that calls scripts/mutant.h with a number, so that one build holds all
mutants. Edits nest: each is a list of literal text and of ranges of the source, which may hold further edits.

Left out by rule:
- what a compiler evaluates: constexpr, static_assert, case labels, array sizes, template arguments;
- macros, so CHECK_*: an invariant that holds is not seen by a test;
- reserve() and shrink_to_fit(), the grain of parallel_ranges() and prefetching: time alone depends on them;
- texts of exceptions: arithmetic inside of a throw expression."""

import re
from dataclasses import dataclass, field

from clang.cindex import CursorKind as K
from clang.cindex import Index, TranslationUnit
from clang.cindex import TypeKind as T

INTEGERS = {T.CHAR_S, T.CHAR_U, T.SCHAR, T.UCHAR, T.SHORT, T.USHORT, T.INT, T.UINT, T.LONG, T.ULONG, T.LONGLONG, T.ULONGLONG}
REALS = {T.FLOAT, T.DOUBLE, T.LONGDOUBLE}
NUMBERS = INTEGERS | REALS
COMPARABLE = NUMBERS | {T.BOOL, T.POINTER, T.ENUM}

FUNCTIONS = {K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.DESTRUCTOR, K.FUNCTION_TEMPLATE, K.CONVERSION_FUNCTION}
LOOPS = {K.FOR_STMT, K.CXX_FOR_RANGE_STMT, K.WHILE_STMT, K.DO_STMT}
UNVISITED = {K.STATIC_ASSERT, K.TYPE_REF, K.TEMPLATE_REF, K.NAMESPACE_REF, K.PARM_DECL, K.STRUCT_DECL, K.CLASS_DECL, K.ENUM_DECL,
             K.TYPE_ALIAS_DECL, K.DECL_REF_EXPR}

BOUNDARIES = {"<": ("less", "<="), "<=": ("less_equal", "<"), ">": ("greater", ">="), ">=": ("greater_equal", ">")}
NEGATIONS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
ARITHMETIC = {"+": ("plus", "-"), "-": ("minus", "+"), "*": ("times", "/"), "/": ("divided_by", "*"), "%": ("modulo", "*")}
COMPOUND = {"+=": ("opposite", "-="), "-=": ("opposite", "+="), "*=": ("inverse", "/="), "/=": ("inverse", "*=")}
STEPS = {"++": "--", "--": "++"}
TWINS = [("min", "max"), ("min_element", "max_element"), ("lower_bound", "upper_bound"), ("any_of", "all_of"),
         ("floor", "ceil"), ("sin", "cos")]
SWAPPED = {f"std::{scope}{a}": f"std::{scope}{b}" for scope in ("", "ranges::") for pair in TWINS
           for a, b in (pair, reversed(pair))}
ONLY_TIME = {"reserve", "shrink_to_fit", "__builtin_prefetch", "_mm_prefetch"}


@dataclass
class Site:
    """One mutant. `parts` replace [begin, end): text, in which {} is the mutant's number, or a range of the source."""
    file: str
    function: str
    line: int
    begin: int
    end: int
    parts: list
    change: str  # "a < b => a <= b"
    source_line: str = ""
    id: int = -1
    key: tuple = field(default=())


def bare(cursor):
    """The expression below implicit conversions and parentheses."""
    while cursor.kind in (K.UNEXPOSED_EXPR, K.PAREN_EXPR):
        children = list(cursor.get_children())
        if len(children) != 1:
            break
        cursor = children[0]
    return cursor


def kind_of(cursor):
    return cursor.type.get_canonical().kind


class Finder:
    def __init__(self, path, name, macros):
        self.text = path.read_bytes().decode("latin-1")  # offsets are bytes
        self.name, self.macros, self.sites, self.function = name, macros, [], ""

    def span(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def source(self, begin, end):
        return " ".join(self.text[begin:end].split())

    def add(self, cursor, parts, mutated, whole=None, tail=0):
        """`whole`: the expression that is shown, if it is larger than what is replaced; `tail`: replaced behind it."""
        begin, end = self.span(cursor)
        shown = self.source(*self.span(whole or cursor))
        end += tail
        if begin >= end or any(a <= begin and end <= b for a, b in self.macros):
            return
        line_begin, line_end = self.text.rfind("\n", 0, begin) + 1, self.text.find("\n", begin)
        self.sites.append(Site(self.name, self.function, cursor.extent.start.line, begin, end, parts,
                               f"{shown} => {mutated}", self.text[line_begin:line_end].strip()))

    def wrap(self, cursor, function, mutated):
        self.add(cursor, [f"salbench_mutant::{function}({{}}, ", self.span(cursor), ")"], mutated)

    # -- what becomes of an expression

    def binary(self, cursor):
        children = list(cursor.get_children())
        if len(children) != 2:
            return
        left, right = map(self.span, children)
        operator = re.sub(r"//.*|/\*.*?\*/", "", self.text[left[1]:right[0]]).strip()
        kinds = {kind_of(c) for c in children}
        a, b = self.source(*left), self.source(*right)
        if operator in ("&&", "||"):
            self.logical(cursor, operator, left, right)
        if operator in NEGATIONS and kinds <= COMPARABLE:
            self.wrap(cursor, "flipped", f"{a} {NEGATIONS[operator]} {b}")
        for table, types in ((BOUNDARIES, COMPARABLE), (ARITHMETIC, NUMBERS)):
            if operator in table and kinds <= types:
                function, other = table[operator]
                self.add(cursor, [f"salbench_mutant::{function}({{}}, ", left, ", ", right, ")"], f"{a} {other} {b}")

    def logical(self, cursor, operator, left, right):
        a, b = self.source(*left), self.source(*right)
        x, y = ["static_cast<bool>(", left, ")"], ["static_cast<bool>(", right, ")"]
        flip = "salbench_mutant::is({})"
        other = "||" if operator == "&&" else "&&"  # by De Morgan: evaluates each side once, the right one if needed
        self.add(cursor, [f"((({flip} != ", *x, f") {operator} ({flip} != ", *y, f")) != {flip})"], f"{a} {other} {b}")
        dropped = f"{flip} ||" if operator == "&&" else f"!{flip} &&"
        self.add(cursor, [f"(({dropped} ", *x, f") {operator} ", *y, ")"], b)
        self.add(cursor, ["(", *x, f" {operator} ({dropped} ", *y, "))"], a)

    def compound(self, cursor):
        target, value = cursor.get_children()
        left, right = self.span(target), self.span(value)
        operator = self.text[left[1]:right[0]].strip()
        types = NUMBERS if operator in ("+=", "-=") else REALS
        if operator in COMPOUND and {kind_of(target), kind_of(value)} <= types:
            function, other = COMPOUND[operator]
            self.add(value, [f"salbench_mutant::{function}({{}}, ", right, ")"],
                     f"{self.source(*left)} {other} {self.source(*right)}", cursor)

    def unary(self, cursor):
        operand = next(cursor.get_children())
        begin, end = self.span(cursor)
        inner = self.span(operand)
        text, name = self.text[begin:end], self.source(*inner)
        if text[:2] in STEPS:
            other = STEPS[text[:2]]
            self.add(cursor, [f"(salbench_mutant::is({{}}) ? {other}", inner, f" : {text[:2]}", inner, ")"], other + name)
        elif text[-2:] in STEPS:
            other = STEPS[text[-2:]]
            self.add(cursor, ["(salbench_mutant::is({}) ? ", inner, f"{other} : ", inner, f"{text[-2:]})"], name + other)
        elif text.startswith("-") and kind_of(operand) in NUMBERS:
            self.add(cursor, ["salbench_mutant::positive({}, ", inner, ")"], name)

    def literal(self, cursor, parent):
        begin, end = self.span(cursor)
        before, after = self.text[:begin].rstrip()[-1:], self.text[end:end + 8].lstrip()[:1]
        if parent.kind != K.BINARY_OPERATOR and (before == "<" or after == ">"):
            return  # a template argument
        text = self.source(begin, end)
        if not re.match(r"[.\d]|true$|false$", text):
            return  # of an operator that C++20 rewrites
        if cursor.kind == K.CXX_BOOL_LITERAL_EXPR:
            self.wrap(cursor, "flipped", "false" if text == "true" else "true")
            return
        self.wrap(cursor, "plus_one", f"{text} + 1")
        if cursor.kind == K.INTEGER_LITERAL and not re.match(r"[01][uUlLzZ]*$", text):
            self.wrap(cursor, "minus_one", f"{text} - 1")

    def call(self, cursor, children):
        if not children:
            return
        callee = self.span(children[0])
        name = self.text[slice(*callee)]
        if name in SWAPPED:
            arguments = (callee[1], self.span(cursor)[1])
            self.add(cursor, [f"(salbench_mutant::is({{}}) ? {SWAPPED[name]}", arguments, f" : {name}", arguments, ")"],
                     f"{SWAPPED[name]}{self.source(*arguments)}")

    # -- what becomes of a statement

    def condition(self, cursor):
        inner = bare(cursor)
        begin, end = self.span(inner)
        if inner.kind != K.BINARY_OPERATOR:  # whose own mutants negate it
            self.add(cursor, ["salbench_mutant::flipped({}, static_cast<bool>(", self.span(cursor), "))"],
                     f"!({self.source(begin, end)})")

    def returned(self, value, result):
        kind = kind_of(value)
        if self.text[self.span(value)[0]] == "{" or bare(value).kind in (
                K.BINARY_OPERATOR, K.INTEGER_LITERAL, K.FLOATING_LITERAL, K.CXX_BOOL_LITERAL_EXPR):
            return
        text = self.source(*self.span(value))
        if kind == T.BOOL:
            self.condition(value)
        elif kind in NUMBERS:
            self.wrap(value, "plus_one", f"{text} + 1")
        elif kind == T.RECORD and result is not None and self.own_type(value) == result.get_canonical().spelling:
            self.wrap(value, "or_default", "{}")

    def own_type(self, value):
        """The type before implicit conversions, without const."""
        inner, span = value, self.span(value)
        while (child := next(inner.get_children(), None)) and self.span(child) == span:
            inner = child
        return inner.type.get_canonical().spelling.removeprefix("const ")

    def removal(self, statement):
        if statement.kind in (K.BREAK_STMT, K.CONTINUE_STMT):
            end = self.span(statement)[1]
            tail = self.text.index(";", end) + 1 - end
            self.add(statement, ["{ if (!salbench_mutant::is({})) ", self.span(statement), "; }"], "(removed)", tail=tail)
        if not statement.kind.is_expression() or bare(statement).spelling in ONLY_TIME:
            return
        self.add(statement, ["(salbench_mutant::is({}) ? void() : void(", self.span(statement), "))"]
                 if bare(statement).kind != K.CXX_THROW_EXPR else
                 ["(salbench_mutant::is({}) ? void() : ", self.span(statement), ")"], "(removed)")

    # -- the walk

    def visit(self, cursor, parent, result):
        """`result`: what the enclosing function returns, where it is written down."""
        kind = cursor.kind
        if kind in UNVISITED:
            return
        children = list(cursor.get_children())
        bodies = children if kind == K.COMPOUND_STMT else children[-1:] if kind in LOOPS else []
        if kind == K.VAR_DECL:
            begin, name = cursor.extent.start.offset, cursor.location.offset
            if re.search(r"\bconstexpr\b", self.text[begin:name]):
                return
            children = [c for c in children if c.extent.start.offset > name and c.kind.is_expression()
                        and not (kind_of(cursor) == T.CONSTANTARRAY and c.kind == K.INTEGER_LITERAL)]
        elif kind == K.LAMBDA_EXPR:
            result = None
        elif kind == K.CASE_STMT:
            children = children[1:]
        elif kind == K.CXX_FOR_RANGE_STMT:
            children = children[1:]
        elif kind == K.FOR_STMT:  # ++i of its head: turned over, it hardly ever ends
            children = [c for c in children[:-1] if c.kind != K.UNARY_OPERATOR] + children[-1:]
        elif kind in (K.IF_STMT, K.WHILE_STMT):
            begin, end = self.span(cursor)
            if re.match(r"if\s+constexpr", self.text[begin:end]):
                bodies = children = children[1:]
            else:
                has_declaration = not children[0].kind.is_expression()  # `if (auto x = f())` or `if (auto x = f(); x > 0)`
                if children[0].kind != K.VAR_DECL:
                    self.condition(children[has_declaration])
                bodies = children[1 + has_declaration:]
                if children[0].kind == K.VAR_DECL:
                    del children[1]  # the variable as a condition
        elif kind == K.CONDITIONAL_OPERATOR and len(children) == 3:
            self.condition(children[0])
        elif kind == K.BINARY_OPERATOR:
            self.binary(cursor)
        elif kind == K.COMPOUND_ASSIGNMENT_OPERATOR:
            self.compound(cursor)
        elif kind == K.UNARY_OPERATOR:
            self.unary(cursor)
        elif kind in (K.INTEGER_LITERAL, K.FLOATING_LITERAL, K.CXX_BOOL_LITERAL_EXPR):
            self.literal(cursor, parent)
        elif kind == K.CALL_EXPR:
            self.call(cursor, children)
            if cursor.spelling in ONLY_TIME:
                return
            if cursor.spelling == "parallel_ranges":
                del children[2]
        elif kind == K.CXX_THROW_EXPR:
            return
        elif kind == K.RETURN_STMT and children:
            self.returned(children[0], result)
        for child in bodies:
            self.removal(child)
        for child in children:
            self.visit(child, cursor, result)

    def visit_function(self, cursor):
        children = list(cursor.get_children())
        if not children or children[-1].kind != K.COMPOUND_STMT:
            return
        begin, body = cursor.extent.start.offset, children[-1].extent.start.offset
        if re.search(r"\b(constexpr|consteval)\b", self.text[begin:body]):
            return
        scope = cursor.semantic_parent
        self.function = cursor.spelling if scope.kind in (K.NAMESPACE, K.TRANSLATION_UNIT) else \
            f"{scope.spelling}::{cursor.spelling}"
        for child in children:
            if child.kind == K.COMPOUND_STMT or cursor.kind == K.CONSTRUCTOR and child.kind.is_expression():
                self.visit(child, cursor, cursor.result_type)


def sites_of(source, arguments, files):
    """The sites of those of `files` ({path: name}) that the translation unit `source` reads: {path: [Site]}."""
    unit = Index.create().parse(str(source), args=arguments,
                                options=TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
    by_name = {str(path): path for path in files}
    finders, macros = {}, {path: [] for path in files}

    def walk(cursor):
        for child in cursor.get_children():
            path = by_name.get(child.location.file.name if child.location.file else "")
            if path is None:
                continue
            if child.kind == K.MACRO_INSTANTIATION:
                macros[path].append((child.extent.start.offset, child.extent.end.offset))
            if path not in finders:
                finders[path] = Finder(path, files[path], macros[path])
            if child.kind in FUNCTIONS:
                finders[path].visit_function(child)
            elif child.kind in (K.NAMESPACE, K.CLASS_DECL, K.STRUCT_DECL, K.CLASS_TEMPLATE, K.LINKAGE_SPEC):
                walk(child)

    walk(unit.cursor)
    return {path: finder.sites for path, finder in finders.items()}


def rewritten(text, sites):
    """The source with the edits of `sites`, which have numbers; the lines keep theirs. `text` is bytes read as Latin-1."""
    order = sorted(range(len(sites)), key=lambda i: (sites[i].begin, -sites[i].end, i))

    def render(begin, end, inside):
        out, at = [], begin
        while inside:
            site = sites[inside[0]]
            within = [i for i in inside[1:] if sites[i].end <= site.end]
            inside = [i for i in inside[1:] if sites[i].begin >= site.end]
            out.append(text[at:site.begin])
            for part in site.parts:
                if isinstance(part, str):
                    out.append(part.replace("{}", str(site.id)))
                else:
                    out.append(render(*part, [i for i in within if part[0] <= sites[i].begin and sites[i].end <= part[1]]))
            at = site.end
        out.append(text[at:end])
        return "".join(out)

    return render(0, len(text), order)
