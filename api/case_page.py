#!/usr/bin/env python3
"""Writes the key tables of case.md, between its markers, from case.schema.json.

case_page.py           rewrites the tables
case_page.py --check   exit status 1 if they are not those of the schema
"""

import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
PAGE = FOLDER / "case.md"
BEGIN, END = "<!-- keys: written by case_page.py -->", "<!-- end of keys -->"


def number(value):
    """Shortest usual writing: 1e7 rather than 10000000.0."""
    text = f"{value:.6g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        return f"{mantissa}e{int(exponent)}"
    return text


def bounds(schema):
    """Range of a number in words, or nothing."""
    words = [sign + " " + number(schema[key]) for key, sign in
             (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))
             if key in schema]
    return ", ".join(words)


def count(schema):
    low, high = schema.get("minItems", 0), schema["maxItems"]
    if low == high:
        return str(low)
    return f"{low} to {high}" if low else f"at most {high}"


class Page:
    def __init__(self, schema):
        self.schema = schema
        self.paths, self.objects = {}, []  # by identity, where an object is described; all of them in order

    def resolved(self, node):
        while "$ref" in node:
            node = self.schema["definitions"][node["$ref"].rsplit("/", 1)[1]]
        return node

    def values(self, node):
        """What a key may hold."""
        meant = self.resolved(node)
        if "anyOf" in meant:
            return " or ".join(self.values(option) for option in meant["anyOf"])
        if "const" in meant:
            return f"`{json.dumps(meant['const'])}`"
        if "enum" in meant:
            return " ".join(f"`{word}`" for word in meant["enum"])
        types = meant["type"] if isinstance(meant["type"], list) else [meant["type"]]
        return " or ".join(self.of_type(kind, node, meant) for kind in types)

    def of_type(self, kind, node, meant):
        if kind in ("number", "integer"):
            return ("whole, " if kind == "integer" else "") + bounds(meant)
        if kind == "boolean":
            return "`true` `false`"
        if kind == "string":
            return "name" if "pattern" in meant else f"text, at most {meant['maxLength']} characters"
        if kind == "array":
            return self.of_list(meant)
        if kind == "object":
            return self.see(meant) or "by name: " + self.values(meant["additionalProperties"])
        return f"`{kind}`"

    def of_list(self, meant):
        items = self.resolved(meant["items"])
        if "properties" in items:
            return f"list of {count(meant)}: {self.see(items)}"
        each = self.values(meant["items"])
        return f"{count(meant)} numbers {each}" if items.get("type") == "number" else f"list of {count(meant)}: {each}"

    def see(self, meant):
        """A link to the section of an object, if it has one."""
        if "properties" not in meant:
            return ""
        path = self.paths.get(id(meant), "")
        return f"[{path}](#{''.join(c for c in path if c.isalnum() or c in '_-')})"

    def place(self, path, node):
        """Where each object is described: its first occurrence."""
        meant = self.resolved(node)
        if "properties" in meant:
            if id(meant) in self.paths:
                return
            self.paths[id(meant)] = path
            self.objects.append((path, meant))
            for key, value in meant["properties"].items():
                self.place(f"{path}.{key}" if path else key, value)
        elif isinstance(meant.get("additionalProperties"), dict):
            self.place(path + ".*", meant["additionalProperties"])
        elif "items" in meant:
            self.place(path + "[]", meant["items"])

    def table(self, path, meant):
        lines = [f"### `{path}`" if path else "### The case", "", meant["description"], "",
                 "| key | values | unit | default | meaning |", "|---|---|---|---|---|"]
        for key, value in meant["properties"].items():
            lines.append(self.row(key, value, key in meant.get("required", [])))
        return "\n".join(lines)

    def row(self, key, value, required):
        shown = ""
        if "default" in value:
            default = value["default"]
            shown = f"`{number(default) if type(default) in (int, float) else json.dumps(default)}`"
        members = value.get("additionalProperties") or {}
        unit = value.get("x-unit", members.get("x-unit", ""))
        return (f"| `{key}` | {self.values(value)} | {unit} "
                f"| {'**required**' if required else shown} | {value['description']} |")

    def text(self):
        self.place("", self.schema)
        return "\n\n".join(self.table(path, meant) for path, meant in self.objects)


def main():
    schema = json.loads((FOLDER / "case.schema.json").read_text(encoding="utf-8"))
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    after = rest.split(END)[1]
    written = before + BEGIN + "\n\n" + Page(schema).text() + "\n\n" + END + after
    if sys.argv[1:] == ["--check"]:
        if written != page:
            sys.exit(f"{PAGE.name} does not show the keys of case.schema.json: run {sys.argv[0]}")
        return
    PAGE.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main()
