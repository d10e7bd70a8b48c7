"""Equation numbers: every bold number of the theory page gets an anchor, every "Eq. (3.2)" of the site a link to it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

HOME = "theory"
NUMBER = re.compile(r"^(P?)\((\d+(?:\.\d+)?)\)$")
OWN = r"\(\d+\.\d+\)"
CHAIN = re.compile(rf"\bEqs?\.\s*{OWN}(?:(?:\s*(?:,|and|to|-|–)\s*)+{OWN})*|\bP\(\d+\)")
ONE = re.compile(r"(P?)\((\d+(?:\.\d+)?)\)")
CLOSED = (nodes.reference, nodes.literal, nodes.literal_block, nodes.raw, nodes.title)


def anchor(paper: str, number: str) -> str:
    """The anchor of an equation: eq-3-2 for Eq. (3.2), paper-16 for P(16)."""
    return ("paper-" if paper else "eq-") + number.replace(".", "-")


def name_equations(app: Sphinx, tree: nodes.document) -> None:
    """Give the bold numbers of the theory page their anchors; the first of two alike has it."""
    if app.env.docname != HOME:
        return
    for bold in tree.findall(nodes.strong):
        found = NUMBER.match(bold.astext())
        if found and (name := anchor(*found.groups())) not in tree.ids:
            bold["ids"].append(name)
            bold["classes"].append("equation-number")
            tree.ids[name] = bold


class LinkEquations(SphinxPostTransform):
    """Turns cited equation numbers of prose and docstrings into links."""

    default_priority = 700

    def run(self, **_: Any) -> None:
        if not hasattr(self.app.builder, "get_relative_uri"):
            return
        known = {name for bold in self.env.get_doctree(HOME).findall(nodes.strong) for name in bold["ids"]}
        for text in list(self.document.findall(nodes.Text)):
            if not CHAIN.search(text) or any(_is_closed(above) for above in _above(text)):
                continue
            text.parent.replace(text, list(self._linked(str(text), known)))

    def _linked(self, text: str, known: set[str]) -> Iterator[nodes.Node]:
        done = 0
        for chain in CHAIN.finditer(text):
            for one in ONE.finditer(text, chain.start(), chain.end()):
                name = anchor(*one.groups())
                if name not in known:
                    continue
                yield nodes.Text(text[done : one.start()])
                here = self.env.docname == HOME
                page = "" if here else self.app.builder.get_relative_uri(self.env.docname, HOME)
                yield nodes.reference("", one[0], internal=True, refuri=f"{page}#{name}")
                done = one.end()
        yield nodes.Text(text[done:])


def _is_closed(node: nodes.Node) -> bool:
    """Whether numbers in here stay as they are: code, titles, and the place where an equation is defined."""
    return isinstance(node, CLOSED) or "equation-number" in getattr(node, "attributes", {}).get("classes", [])


def _above(node: nodes.Node) -> Iterator[nodes.Node]:
    while node.parent is not None:
        node = node.parent
        yield node


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.connect("doctree-read", name_equations)
    app.add_post_transform(LinkEquations)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
