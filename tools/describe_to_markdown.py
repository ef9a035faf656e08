#!/usr/bin/env python3
"""The tables of docs/recipes.md from what the program says of its operators, and those of
docs/pictures.md from what it says of its styles.

    normalshop describe --json | tools/describe_to_markdown.py            prints the tables
    normalshop describe --json | tools/describe_to_markdown.py --write F  puts them into F
    tools/describe_to_markdown.py --run PROGRAM --check F                 fails when F is out of date
    tools/describe_to_markdown.py --run PROGRAM --with "A B" --check F    with the arguments A and B

The tables stand between two marker lines in the file.
"""

import argparse
import collections
import json
import subprocess
import sys

BEGIN = "<!-- {kind}s: written by tools/describe_to_markdown.py -->"
END = "<!-- end of {kind}s -->"


def cell(text):
    return str(text).replace("|", "\\|").replace("\n", " ")


def number(value):
    return f"{value:.10g}"


def default_of(field):
    if field.get("required"):
        return "required"
    value = field["default"]
    if isinstance(value, bool):
        return "`true`" if value else "`false`"
    if isinstance(value, (int, float)):
        return number(value)
    return "`" + json.dumps(value) + "`"


def accepted(field):
    kind = field["type"]
    if kind == "name":
        return ", ".join(f'`"{name}"`' for name in field["names"])
    if kind == "switch":
        return "`true`, `false`"
    if kind == "curve":
        return "list of `[u, height]`"
    if "range" in field:
        low, high = field["range"]
        unit = {"1": "", "length": ", length"}.get(field.get("unit", ""), ", " + field.get("unit", ""))
        each = "list of numbers from " if kind == "numbers" else ""
        return f"{each}{number(low)} to {number(high)}{unit}"
    return kind


def kind_of(entry):
    return "operator" if "operator" in entry else "style"


def row(field):
    cells = (f"`{field['name']}`", accepted(field), default_of(field), field["help"])
    return "| " + " | ".join(cell(c) for c in cells) + " |"


def table(rows):
    return ["| option | accepted | default | |", "| --- | --- | --- | --- |", *rows]


def section(entry, area):
    yield f"### {entry[kind_of(entry)]}"
    yield ""
    yield entry["summary"] + "."
    yield ""
    if "strokes" in entry:
        yield "Strokes: " + entry["strokes"] + "."
        yield ""
    rows = [row(field) for field in entry["options"]]
    own = [each for each in rows if each not in area]
    if own:
        yield from table(own)
    if len(own) < len(rows):
        if own:
            yield ""
        yield "Then the [options of an area](#options-of-an-area)."


def area_rows(described):
    """The rows that most operators have in common are those of areas."""
    count = collections.Counter(row(field) for entry in described for field in entry["options"])
    return [each for each, times in count.items() if times > max(2, len(described) // 2)]


def operators_of(described):
    """`describe` may wrap the list in an object."""
    return described["operators"] if isinstance(described, dict) else described


def tables(described):
    area = area_rows(described)
    blocks = ["\n".join(section(entry, area)) for entry in described]
    if area:
        blocks.append("\n".join(["### Options of an area", "", *table(area)]))
    return "\n\n".join(blocks)


def replaced(document, text, kind):
    begin = BEGIN.format(kind=kind)
    finish = END.format(kind=kind)
    before, mark, rest = document.partition(begin)
    _, end, after = rest.partition(finish)
    if not mark or not end:
        sys.exit(f"the file has no lines {begin} and {finish}")
    return f"{before}{begin}\n\n{text}\n\n{finish}{after}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--run", help="program that prints the JSON; else it is read from stdin")
    parser.add_argument("--with", dest="arguments", default="", metavar="ARGUMENTS",
                        help="what the program is run with")
    parser.add_argument("--write", metavar="FILE")
    parser.add_argument("--check", metavar="FILE")
    arguments = parser.parse_args()
    source = (
        subprocess.run([arguments.run, *arguments.arguments.split()], check=True, capture_output=True, text=True).stdout
        if arguments.run
        else sys.stdin.read()
    )
    described = operators_of(json.loads(source))
    text = tables(described)
    path = arguments.write or arguments.check
    if path is None:
        print(text)
        return
    with open(path, encoding="utf-8") as file:
        document = file.read()
    wanted = replaced(document, text, kind_of(described[0]))
    if arguments.write:
        with open(path, "w", encoding="utf-8") as file:
            file.write(wanted)
    elif wanted != document:
        sys.exit(f"{path} does not say what the program says; "
                 f"run: normalshop describe {'' if kind_of(described[0]) == 'operator' else '--styles '}--json | tools/describe_to_markdown.py --write {path}")


if __name__ == "__main__":
    main()
