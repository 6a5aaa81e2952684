#!/usr/bin/env python3
"""Prepares the pages of docs/ for mdBook, which calls it (book.toml). Behind a paragraph that links to a table of docs/figures, the table itself is
shown. Links to files outside docs/ become text, as the book holds docs/ alone."""
import csv
import html
import json
import os
import re
import sys

DOCS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs")
MOST_ROWS = 120


def table(name):
    with open(os.path.join(DOCS, name), encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    cells = lambda row, tag: "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row)
    body = "".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows[:MOST_ROWS])
    more = f"<p>{len(rows) - MOST_ROWS} more rows are in the file.</p>" if len(rows) > MOST_ROWS else ""
    return (
        f"\n\n<details><summary>{html.escape(name)}, {len(rows)} rows</summary><div style=\"overflow-x:auto\">"
        f"<table><thead><tr>{cells(head, 'th')}</tr></thead><tbody>{body}</tbody></table></div>{more}</details>\n"
    )


def prepared(text):
    text = re.sub(r"(?<!!)\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", text)
    paragraphs = re.split(r"(\n\n+)", text)
    for n, paragraph in enumerate(paragraphs):
        names = dict.fromkeys(re.findall(r"\]\((figures/[\w-]+\.csv)\)", paragraph))
        paragraphs[n] += "".join(table(name) for name in names)
    return "".join(paragraphs)


def prepare(items):
    for item in items:
        chapter = item.get("Chapter") if isinstance(item, dict) else None
        if chapter:
            chapter["content"] = prepared(chapter["content"])
            prepare(chapter["sub_items"])


if sys.argv[1:2] == ["supports"]:
    sys.exit(0)
_, book = json.load(sys.stdin)
prepare(book.get("items", book.get("sections", [])))
json.dump(book, sys.stdout)
