# SPDX-License-Identifier: GPL-3.0-or-later
"""Comments, docstrings and pages avoid the words listed in words.txt."""

import ast
import io
import pathlib
import re
import tokenize
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("cache", "cmake", "docs", "io", "models", "pipeline", "python", "scripts", "stages", "tests")
LINES = (ROOT / "tests/quality/words.txt").read_text(encoding="utf-8").splitlines()
RULES = [line.split("\t") for line in LINES if not line.startswith("#")]
LITERAL = r"""(?:"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])')"""
COMMENT = re.compile(rf'((?:{LITERAL}|/(?!/)|[^"/])*)//(.*)')  # with the code before it


def files(*endings):
    return [path for name in FOLDERS for end in endings for path in sorted((ROOT / name).rglob(f"*{end}"))]


def beginnings(comments):
    """(line, text) of the comments (line, column, code before, text) that do not continue the line above."""
    last = None
    for line, column, code, text in comments:
        if code.strip() or last != (line - 1, column):
            yield line, text
        last = None if "SPDX" in text else (line, column)


def cpp_comments(text):
    found = ((line, COMMENT.match(words)) for line, words in enumerate(text.splitlines(), 1))
    return beginnings((line, len(match[1]), match[1], match[2].strip()) for line, match in found if match)


def python_comments(text):
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    found = ((*token.start, token) for token in tokens if token.type == tokenize.COMMENT)
    return beginnings((line, at, token.line[:at], token.string.strip("# ")) for line, at, token in found)


def docstrings(text):
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, kinds) and ast.get_docstring(node):
            yield node.body[0].lineno, ast.get_docstring(node)


def python_texts(text):
    """Strings of several words that are no docstrings."""
    tree = ast.parse(text)
    bodies = (getattr(node, "body", None) for node in ast.walk(tree))
    alone = {id(each.value) for body in bodies if isinstance(body, list) for each in body if isinstance(each, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value and id(node) not in alone:
            yield node.lineno, node.value


def cpp_texts(text):
    for line, words in enumerate(text.splitlines(), 1):
        if '"' in words:
            yield from ((line, literal) for literal in re.findall(LITERAL, words.partition(" // ")[0]) if " " in literal)


def prose(text):
    """(line, text) of a page without blocks and spans of code, and without targets of links."""
    code = re.compile(r"^```.*?^```$|`[^`]*`|\]\([^)]*\)", flags=re.M | re.S)
    return enumerate(code.sub(lambda found: "\n" * found[0].count("\n"), text).splitlines(), 1)


class Words(unittest.TestCase):
    def expect_none(self, paths, places, pattern, texts_of):
        rules = [(re.compile(pattern.format(word)), fix) for word, place, fix in RULES if place in places]
        texts = [(path, *text) for path in paths for text in texts_of(path.read_text(encoding="utf-8"))]
        found = [f"{path.relative_to(ROOT)}:{line}: {hit[0]}: {fix}" for path, line, text in texts
                 for rule, fix in rules if (hit := rule.search(text))]
        self.assertEqual(len(found), 0, "\n" + "\n".join(found))

    def test_comments_of_cpp(self):
        self.expect_none(files(".h", ".cpp"), ("start", "cpp"), r"\A(?:{})\b", cpp_comments)

    def test_comments_of_python(self):
        self.expect_none(files(".py"), ("start",), r"\A(?:{})\b", python_comments)

    def test_docstrings(self):
        self.expect_none(files(".py"), ("start",), r"\A(?:{})\b", docstrings)

    def test_messages(self):
        """And help texts, and what reports say."""
        package = [path for path in files(".py") if path.is_relative_to(ROOT / "python/salbench")]
        product = [path for path in files(".h", ".cpp") if not path.is_relative_to(ROOT / "tests")]
        templates = sorted((ROOT / "python/salbench").rglob("templates/*.html"))
        for paths, texts_of in ((package, python_texts), (product, cpp_texts), (templates, prose)):
            self.expect_none(paths, ("text",), r"(?i)\b(?:{})\b", texts_of)

    def test_pages(self):
        pages = [path for path in sorted((ROOT / "docs").glob("*.md")) if path.name != "glossary.md"]
        self.expect_none([ROOT / "README.md", *pages], ("page",), r"(?i)\b(?:{})\b", prose)
