"""Parts that come from recorded files: docs/data (docs/measure.py writes it) and bench/data/peers."""
import csv
import json

from .markdown import cell, number, table


def read_csv(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def condition(rows):
    """One line that says where and when rows were measured."""
    cpus = sorted({row["cpu"] for row in rows if row.get("cpu")})
    commits = sorted({row["commit"][:7] + ("-dirty" if "dirty" in row["commit"] else "") for row in rows})
    days = sorted({row["date"][:10] for row in rows})
    where = f" on an {' and an '.join(cpus)}" if cpus else ""
    return f"Measured {' and '.join(days)}{where}, commit {', '.join(commits)}."


def claims_page(data):
    """The whole page docs/claims.md."""
    def row(claim):
        result = "-" if "passed" not in claim or claim["passed"] is None else "pass" if claim["passed"] else "**fail**"
        return cell(claim["claim"]), cell(claim["tolerance"]), cell(claim["measured"]), result
    form = "`springtower validate --full`" if data["long_form"] else "`springtower validate`"
    page = [
        "# All claims, measured", "",
        f"Made by `docs/generate.py` from `docs/data/validation.json`, which {form} wrote: version {data['version']}, commit "
        f"{data['commit'][:12]}, {data['date'][:10]}, {data['cpu']}. What the parts measure: [validation.md](validation.md).", "",
        claims_summary(data),
    ]
    for section in data["sections"]:
        page += ["", f"## {section['title']}", "",
                 table(["claim", "tolerance", "measured", "result"], [row(claim) for claim in section["claims"]])]
    return "\n".join(page) + "\n"


def claims_summary(data):
    """How many claims hold in each part, and those that fail, for docs/validation.md."""
    rows, failing = [], []
    for section in data["sections"]:
        results = [claim.get("passed") for claim in section["claims"]]
        rows.append((section["title"], str(results.count(True)), str(results.count(False)), str(results.count(None))))
        failing += [(section["title"], cell(claim["claim"]), cell(claim["tolerance"]), cell(claim["measured"]))
                    for claim in section["claims"] if claim.get("passed") is False]
    text = table(["part", "claims that hold", "that fail", "reported without a limit"], rows)
    if failing:
        text += "\n\nWhat fails:\n\n" + table(["part", "claim", "tolerance", "measured"], failing)
    return text


def claims_line(data):
    """How many claims hold, for README."""
    form = "springtower validate --full" if data["long_form"] else "springtower validate"
    total = data["passed"] + data["failed"]
    return f"{data['passed']} of {total} claims of `{form}` hold: [those that fail](docs/validation.md#claims)."


def runs(rows):
    """18 rows at rest, for docs/performance.md."""
    def command(arguments):
        return f"`{arguments}`" if arguments else "as it is"
    return table(["options", "penetration, mm", "bottom row compressed by, mm", "creep, mm", "jitter, mm/s", "ms a frame, median"],
                 [(command(row["arguments"]), number(row["max_penetration_mm"]), number(row["bottom_row_compression_mm"]),
                   number(row["creep_mm"], 1), number(row["jitter_mm_s"], 1), number(row["cpu_ms_median"])) for row in rows])


def rows(recorded):
    """Frame time against rows, for docs/performance.md."""
    def cost(row):
        milliseconds = float(row["cpu_ms_median"])
        return f"{float(row['substeps']):g}", number(milliseconds), number(1000 * milliseconds / int(row["blocks"]))
    by_rows = {}
    for row in recorded:
        by_rows.setdefault(int(row["rows"]), {})[row["method"]] = row
    lines = []
    for count, methods in sorted(by_rows.items()):
        implicit, explicit = methods["implicit"], methods.get("semi-implicit-euler")
        steps, milliseconds, a_block = cost(implicit)
        slow = cost(explicit)[:2] if explicit and explicit["cpu_ms_median"] else ("", "")
        lines.append((str(count), implicit["blocks"], number(float(implicit["stiffness_n_m"]) / 1000, 3),
                      number(implicit["max_penetration_mm"]), steps, milliseconds, a_block, *slow))
    return table(["rows", "blocks", "stiffness, kN/m", "penetration, mm", "implicit: substeps", "ms", "µs a block", "explicit: substeps",
                  "ms"], lines)


# Scenes of `profile` in words, with what is required of median and 99th percentile (of the collapse: the slowest frame), ms.
MOTION = {
    "rest": ("at rest, awake", "0.2"),
    "sway": ("while gravity sways by 0.1 degree", "0.4"),
    "heights": ("heights varying by 0.2 mm", "0.4"),
    "pull": ("a block pulled out at 4 cm/s, all awake", "0.5 (99th percentile 3)"),
    "pull-sleep": ("the same with sleep", "0.2"),
    "game": ("the recorded game", "0.5 (99th percentile 3)"),
    "collapse": ("the collapse: gravity leans by 14.5 degrees", "2 (slowest 6)"),
    "asleep": ("asleep", "0.002"),
}


def motion(recorded):
    """A tower of 18 rows in motion, and the recorded game, for docs/performance.md."""
    return table(["18 rows", "median, ms", "99th percentile", "slowest", "required"],
                 [(MOTION[row["scene"]][0], number(row["cpu_ms_median"]), number(row["cpu_ms_p99"]), number(row["cpu_ms_max"]),
                   MOTION[row["scene"]][1]) for row in recorded])


def towers(recorded):
    """Many towers, for docs/performance.md."""
    return table(["towers", "blocks", "threads", "ms a frame, median"],
                 [(row["towers"], row["blocks"], row["threads"],
                   number(row["cpu_ms_median" if row["threads"] == "1" else "wall_ms_median"])) for row in recorded])


def _ours(recorded, name):
    """Rows of ours by what `name` names: {what: {threads: row}}, and Bullet's."""
    ours, bullet = {}, {}
    for row in recorded:
        if row["engine"] == "springtower":
            ours.setdefault(row[name], {})[row["threads"]] = row
        else:
            bullet[row[name]] = row
    return ours, bullet


def stacks(recorded, peers):
    """Walls and pyramids at rest, for docs/performance.md. peers: bench/data/peers/stacks.csv."""
    ours, bullet = _ours(recorded, "stack")
    box3d = {row["scene"]: row for row in peers if row["engine"] == "Box3D" and row["settings"] == "substeps 32"}
    lines = []
    for stack, row in ours.items():
        one, two, other, theirs = row["1"], row.get("2"), bullet.get(stack), box3d.get(stack)
        lines.append((
            f"`{stack}`", one["blocks"], number(one["cpu_ms_median"]) + (f" ({one['required_ms']})" if one["required_ms"] else ""),
            number(two["wall_ms_median"]) if two else "", number(one["penetration_mm"], 1), number(one["equilibrium_s"]),
            f"{float(other['substeps']):g}, {number(other['cpu_ms_median'])}, {number(other['penetration_mm'])}" if other else "",
            f"{number(theirs['median_ms'])}, {number(theirs['penetration_end_mm'])}, {theirs['verdict'].split('@')[0]}" if theirs else ""))
    return table(["`--stacks`", "blocks", "ms, one thread (required)", "two threads", "penetration, mm", "equilibrium, s",
                  "Bullet: substeps, ms, penetration", "Box3D, 32 substeps: ms, penetration, verdict"], lines)


def falls(recorded):
    """What moves in large numbers, for docs/performance.md."""
    ours, bullet = _ours(recorded, "fall")
    lines = []
    for fall, row in ours.items():
        one, two, other = row["1"], row.get("2"), bullet.get(fall)
        faster = float(one["wall_ms_median"]) / float(two["wall_ms_median"]) if two else 0.0
        lines.append((
            f"`{fall}`", one["blocks"], f"{number(one['cpu_ms_median'])}, {number(one['cpu_ms_max'])}",
            f"{one['required_ms']}, {one['required_worst_ms']}" if one["required_ms"] else "", number(faster) if two else "",
            number(one["penetration_mm"]), number(one["energy_rise"]), number(float(one["bytes_per_block"]) / 1000),
            f"{number(other['cpu_ms_median'])}, {number(other['cpu_ms_max'])}, {number(other['penetration_mm'])}" if other else ""))
    return table(["`--falls`", "blocks", "median, worst, ms", "required", "two threads: times as fast", "depth, mm", "largest rise of energy",
                  "kB a block", "Bullet: median, worst, depth"], lines)


def peers_at_rest(recorded):
    """Box3D and Jolt on the tower of 18 rows, for docs/accuracy.md."""
    return table(["engine", "settings", "ms a frame, median", "worst penetration, mm", "creep, mm", "stands for 60 s"],
                 [(f"{row['engine']} ({row['version'].split()[0]})", cell(row["settings"]), row["ms_per_frame"],
                   row["worst_penetration_mm"], row["creep_mm"], cell(row["stands_60_s"])) for row in recorded])


def _by_setting(recorded):
    """Rows on one thread by scene and setting, in order: [((scene, blocks, engine, settings), rows)]."""
    groups = {}
    for row in recorded:
        if row["threads"] == "1":
            groups.setdefault((row["scene"], int(row["blocks"]), row["engine"], row["settings"]), []).append(row)

    def order(item):
        scene, blocks, engine, settings = item[0]
        return scene.split(":")[0], blocks, engine, [int(word) for word in settings.split() if word.isdigit()]
    return sorted(groups.items(), key=order)


def _extent(rows, column, digits):
    """The range of what was measured more than once; empty where it was not recorded."""
    values = [float(row[column]) for row in rows if row[column]]
    if not values:
        return ""
    least, most = number(min(values), digits), number(max(values), digits)
    return least if least == most else f"{least} to {most}"


def peers_stacks(recorded):
    """Box3D and Jolt on walls and pyramids, one thread, for docs/accuracy.md."""
    return table(["scene", "blocks", "engine", "settings", "ms a frame, median", "slowest, ms", "penetration at the end, mm", "verdict"],
                 [(f"`{scene}`", str(blocks), engine, settings, _extent(rows, "median_ms", 3), _extent(rows, "max_ms", 3),
                   _extent(rows, "penetration_end_mm", 2), " / ".join(sorted({cell(row["verdict"].split("@")[0]) for row in rows})))
                  for (scene, blocks, engine, settings), rows in _by_setting(recorded)])


def peers_falls(recorded):
    """Box3D and Jolt on what falls, one thread, for docs/accuracy.md."""
    return table(["scene", "blocks", "engine", "settings", "ms a frame, median", "worst but the first, ms", "largest penetration, mm"],
                 [(f"`{scene}`", str(blocks), engine, settings, _extent(rows, "median_ms", 3), _extent(rows, "worst_ms", 3),
                   _extent(rows, "penetration_max_mm", 2)) for (scene, blocks, engine, settings), rows in _by_setting(recorded)])


def read_json(path):
    with open(path) as file:
        return json.load(file)


KINDS = {"rest": "at rest", "falls": "in falls", "hand": "by hand", "methods": "of other methods"}
LEAST_EFFECT = 0.005
SCATTERS = 1.5  # times the largest deviation of the scatter from its mean that an effect exceeds


def _bounds(scatter, column):
    """Within which a ratio is no effect."""
    values = [float(row[column]) for row in scatter]
    mean = sum(values) / len(values)
    far = SCATTERS * max(abs(value - mean) for value in values)
    return min(mean - far, 1 - LEAST_EFFECT), max(mean + far, 1 + LEAST_EFFECT)


def _effects(row, scatter):
    """What a moved constant changes beyond the scatter, in words."""
    found = []
    for kind, words in KINDS.items():
        for figure in ("work", "depth"):
            ratio = float(row[f"{kind}_{figure}"])
            least, most = _bounds(scatter, f"{kind}_{figure}")
            if not least <= ratio <= most:
                found.append(f"{figure} {words} {100 * (ratio - 1):+.1f} %")
    if float(row["rise"]) > 2 * max(float(other["rise"]) for other in scatter):
        found.append(f"energy rises by {number(row['rise'], 1)}")
    usual = {end for other in scatter for end in other["ends"].split("; ")}
    found += [end for end in row["ends"].split("; ") if end and end not in usual]
    return ", ".join(found)


def _moved(recorded):
    """The rows of the scatter, and {constant: its rows}."""
    scatter = [row for row in recorded if row["constant"] in ("none", "scatter")]
    moved = {}
    for row in recorded:
        if row["constant"] not in ("none", "scatter"):
            moved.setdefault(row["constant"], []).append(row)
    return scatter, moved


def what_constants_change(recorded):
    """{constant: "nothing", "states" or "figures"}: what changes where it is moved by a tenth, figures beyond the scatter."""
    scatter, moved = _moved(recorded)
    def most(rows):
        if all(int(row["states"]) == 0 and not row["ends"] for row in rows):
            return "nothing"
        return "figures" if any(_effects(row, scatter) for row in rows) else "states"
    return {name: most(rows) for name, rows in moved.items()}


def constants(recorded):
    """What changes when a constant is moved by a tenth, for docs/sensitivity.md: counts, lists and a table."""
    scatter, moved = _moved(recorded)
    changes = what_constants_change(recorded)
    lines = []
    for name, rows in moved.items():
        if changes[name] != "figures":
            continue
        cells = [f"{number(row['value'], 3)}: " + (_effects(row, scatter) or f"within the scatter ({row['states']} states)")
                 for row in rows]
        lines.append((f"`{name}`", *(cell(text) for text in (cells if len(cells) == 2 else ["", *cells]))))
    def span(column):
        least, most = _bounds(scatter, column)
        return f"{100 * (least - 1):+.1f} to {100 * (most - 1):+.1f} %"
    def names(what):
        return ", ".join(f"`{name}`" for name, change in changes.items() if change == what)
    def count(what):
        return sum(change == what for change in changes.values())
    return "\n\n".join([
        f"Of {len(moved)} constants {count('nothing')} change no bit of any end state, {count('states')} change states but no figure beyond the "
        f"scatter, and {count('figures')} change a figure.",
        table(["no effect within", *KINDS.values()],
              [(figure, *(span(f"{kind}_{figure}") for kind in KINDS)) for figure in ("work", "depth")]),
        table(["constant", "a tenth less", "a tenth more"], lines),
        f"States change, no figure does beyond the scatter: {names('states')}.",
        f"No bit of any state changes: {names('nothing')}.",
        condition(recorded),
    ])
