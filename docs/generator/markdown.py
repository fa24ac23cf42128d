"""Tables and marked parts of Markdown pages."""
import math
import re

BEGIN = "<!-- generated: {} (docs/generate.py) -->"
END = "<!-- end of generated -->"
# What stands for BEGIN where nothing is recorded yet: the part between is typed until docs/measure.py has been run.
PENDING = "<!-- to be generated from docs/data/{0}.csv: {0} (docs/measure.py) -->"


def cell(text):
    """Text of a table's cell: nothing in it ends the cell or begins an element of HTML."""
    return str(text).replace("|", "\\|").replace("<", "&lt;")


def table(head, rows):
    """A table; cells are Markdown already."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def replace_parts(path, text, parts):
    """The page with each marked part replaced by parts[name]; ends with a message where a marker or a part is missing."""
    found = set()
    for name in parts:
        text = text.replace(PENDING.format(name), BEGIN.format(name))
    def part(match):
        name = match.group(1)
        if name not in parts:
            raise SystemExit(f"{path}: expected a generated part among {', '.join(sorted(parts))}, got '{name}'")
        found.add(name)
        return BEGIN.format(name) + "\n\n" + parts[name] + "\n\n" + END
    pattern = BEGIN.format("(NAME)").replace("(NAME)", "\0")
    pattern = re.escape(pattern).replace("\0", r"([\w-]+)") + r"\n.*?" + re.escape(END)
    text = re.sub(pattern, part, text, flags=re.DOTALL)
    missing = sorted(set(parts) - found)
    if missing:
        raise SystemExit(f"{path}: expected a line '{BEGIN.format(missing[0])}', got none")
    return text


def number(value, digits=2):
    """A number with so many significant digits, without an exponent from a ten-thousandth to a million."""
    value = float(value)
    if value == 0:
        return "0"
    if abs(value) < 1e-4 or abs(value) >= 1e6:
        return re.sub(r"e([+-])0?", lambda match: "e" + match.group(1).replace("+", ""), f"{value:.{digits - 1}e}")
    rounded = float(f"{value:.{digits}g}")
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
    return f"{rounded:.{decimals}f}"
