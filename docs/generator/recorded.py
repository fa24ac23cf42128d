"""Parts that come from recorded files: docs/data (docs/measure.py writes it) and bench/data/peers."""
import csv
import json
import math
import re

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
        f"{data['commit'][:12]}, {data['date'][:10]}, {data['cpu']}. What the parts measure: [validation.md](validation.md). "
        "Rows of \"Pulling\" and \"Sleep\" count from 1 at the bottom, all others from 0.", "",
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


DEEPEST_SHOWN_MM = 0.5
SPLIT = "8 steps x 4 substeps"  # of Box3D in falls: one of the least deep settings


def headline(at_rest, motion, stacks, chart, peers_rest, peers_stacks, peers_falls):
    """Ours beside Box3D and Jolt, for README: others at rest at their cheapest setting with less than DEEPEST_SHOWN_MM,
    and at their finest."""
    def engine(rows, name):
        return [row for row in rows if row["engine"] == name]

    def tower(name, finest):
        rows = [row for row in engine(peers_rest, name)
                if row["stands_60_s"].startswith("yes") and float(row["worst_penetration_mm"]) < DEEPEST_SHOWN_MM]
        cost = {float(row["ms_per_frame"]): row for row in rows}
        row = cost[max(cost) if finest else min(cost)]
        return f"{row['ms_per_frame']} ms, {row['worst_penetration_mm']} mm ({row['settings'].split(',')[0]})"

    def ours(tolerance, arguments):
        run = next(row for row in at_rest if row["arguments"] == arguments)
        again = next(row for row in motion if row["scene"] == "rest" and float(row["tolerance_m"]) == tolerance)
        return f"{_extent([run, again], 'cpu_ms_median', 2)} ms, {number(run['max_penetration_mm'])} mm"

    def wall(name):
        found = {}
        for row in engine(peers_stacks, name):
            if row["scene"] == "wall:40x25" and row["threads"] == "1" and float(row["penetration_end_mm"]) < DEEPEST_SHOWN_MM:
                found.setdefault(row["settings"], []).append(row)
        setting, rows = min(found.items(), key=lambda item: min(float(row["median_ms"]) for row in item[1]))
        moved = next((re.search(r"is ([\d.]+ mm) aside", row["verdict"]) for row in rows if row["verdict"] != "stands"), None)
        words = " ".join(reversed(setting.split()))
        return f"{_extent(rows, 'median_ms', 2)} ms, {_extent(rows, 'penetration_end_mm', 2)} mm ({words})" + (f"; a block moves by {moved[1]}" if moved else "")

    def fall(name, setting, words):
        rows = [row for row in engine(peers_falls, name)
                if (row["scene"], row["settings"], row["threads"], row["frames"]) == ("collapse:18", setting, "1", "120")]
        times = f"{_extent(rows, 'median_ms', 3)} ms" if name == "Jolt" else f"**{_extent(rows, 'median_ms', 3)} ms**"
        return f"{times}, slowest {_extent(rows, 'worst_ms', 2)}; {_extent(rows, 'penetration_max_mm', 2)} mm ({words})"

    ours_wall = next(row for row in stacks if (row["engine"], row["stack"], row["threads"]) == ("springtower", "wall:40x25", "1"))
    timed = next(row for row in motion if row["scene"] == "collapse" and float(row["tolerance_m"]) == 5e-5)
    charted = next(row for row in chart if (row["scene"], row["rows"], row["method"]) == ("collapse", "18", "implicit")
                   and float(row["value"]) == 5e-5)
    collapse = [{"median": timed["cpu_ms_median"], "worst": timed["cpu_ms_max"], "depth": timed["max_penetration_mm"]},
                {"median": charted["cpu_ms_per_frame"], "worst": charted["cpu_ms_worst_frame"], "depth": charted["penetration_mm"]}]
    return table(["scene", "Springtower", "Box3D", "Jolt"], [
        ("tower of 18 rows at rest", f"**{ours(5e-5, '')}**", tower("Box3D", False), tower("Jolt", False)),
        ("the same, finer", ours(1e-5, "--tolerance 1e-5"), tower("Box3D", True), tower("Jolt", True)),
        (f"wall of {ours_wall['blocks']} blocks at rest", f"**{number(ours_wall['cpu_ms_median'])} ms, {number(ours_wall['penetration_mm'])} mm**",
         wall("Box3D"), wall("Jolt")),
        ("tower of 18 rows toppling (`collapse`), its first 2 s",
         f"{_extent(collapse, 'median', 2)} ms, slowest {_extent(collapse, 'worst', 2)}; {_extent(collapse, 'depth', 2)} mm",
         fall("Box3D", SPLIT, "8 steps of 4 substeps"), fall("Jolt", "steps 16", "16 steps")),
    ])


def none(count):
    return str(count) if int(count) else "none"


def rows_of_default(recorded):
    return [row for row in recorded if row["scenes_of"] in ("implicit", "auto")]


def random_scenes(recorded):
    """Faults of random scenes by kind, method and masses, for docs/random-scenes.md: of faults that some scene has, and a line of the others."""
    total = next(row for row in recorded if row["scenes_of"] == "all")
    faults = [name for name in total if name not in ("scenes_of", "scenes", "cut", "step-limit", "commit", "cpu", "date")]
    played = (f" {total['cut']} of all, {sum(int(row['cut']) for row in rows_of_default(recorded))} of these, were cut off at their limit of a second of CPU time: their faults are those of the part "
              f"played. {none(total['step-limit']).capitalize()} ended as an explicit method would need too many steps (no fault).") if "cut" in total else ""
    shown = [name for name in faults if int(total[name]) > 0]
    ours = rows_of_default(recorded)
    def counts(names, rows):
        return ", ".join(f"`{name}` {sum(int(row[name]) for row in rows)}" for name in names)
    def name_of(text):
        return text if text in ("all", "stack", "plank", "air", "space", "shot", "hand") or "masses" in text else f"`{text}`"
    lines = [(name_of(row["scenes_of"]).replace("implicit, auto,", "`implicit`, `auto`,"), row["scenes"], *(row[name] for name in shown)) for row in recorded]
    return "\n\n".join([
        f"Of {total['scenes']} scenes: {counts(shown, [total])}; all other faults 0. Of the {sum(int(row['scenes']) for row in ours)} by `implicit` and `auto`: "
        f"{counts(shown, ours)}.{played}",
        table(["", "scenes", *(f"`{name}`" for name in shown)], lines),
        condition(recorded),
    ])


def random_line(recorded, short):
    """The same as an item of a list, for docs/limits.md, and without what is only slow or gains energy for README."""
    rows = {row["scenes_of"]: {name: int(row[name]) for name in ("scenes", "diverged", "hung", "slow", "deep", "energy")} for row in recorded}
    total, ours = rows["all"], {name: rows["implicit"][name] + rows["auto"][name] for name in rows["all"]}
    if short:
        return (f"- Of {total['scenes']} random scenes by all methods {none(total['diverged'])} diverge{'s' if total['diverged'] == 1 else ''}, {total['hung']} are stopped as "
                f"their frames take too long, {total['deep']} overlap by more than 5 % of the least side; of the {ours['scenes']} by `implicit` and `auto` "
                f"{none(ours['diverged'])} diverge, {none(ours['hung'])} are stopped and {none(ours['deep'])} overlap by so much.")
    return (f"- Of {total['scenes']} random scenes by all methods {none(total['diverged'])} diverge{'s' if total['diverged'] == 1 else ''}, {total['hung']} are stopped as their "
            f"frames take too long, {total['slow']} take more CPU time than they simulate, {total['deep']} are deeper than 5 % of the least side and {total['energy']} gain energy; of the "
            f"{ours['scenes']} by `implicit` and `auto` {none(ours['diverged'])} diverge, {none(ours['hung'])} are stopped, {none(ours['slow'])} are slower than they simulate, "
            f"{none(ours['deep'])} are deeper and {none(ours['energy'])} gain energy.")


def most_allowed(rate, scenes, false_alarm=1e-6):
    """As mostAllowed of tests/random/bounds.h: the least count that more have with a probability below false_alarm."""
    below = 0.0
    for count in range(scenes):
        ways = math.lgamma(scenes + 1) - math.lgamma(count + 1) - math.lgamma(scenes - count + 1)
        below += math.exp(ways + count * math.log(rate) + (scenes - count) * math.log1p(-rate))
        if 1 - below < false_alarm:
            return count
    return scenes


def random_bounds(source):
    """Bounds of the scenes of a commit, for docs/random-scenes.md. source: the text of tests/random/bounds.cpp."""
    found = re.findall(r'\{Fault::(\w+), ([\d.]+), "(\d+) of (\d+)(?:[:;] |([^":;]*)[:;] )?([^"]*)"\}', source)
    lines = [(f"`{fault}`", f"{count} of {scenes}{machine}", rate, str(most_allowed(float(rate), 300)), reason)
             for fault, rate, count, scenes, machine, reason in found]
    return table(["fault", "largest count", "rate that the bound rests on", "most of 300", "which scenes"], lines)


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
    "pull": ("a block pulled out at 4 cm/s, all awake", "0.5 (99th percentile 2)"),
    "pull-sleep": ("the same with sleep", "0.2"),
    "game": ("the recorded game", "0.5 (99th percentile 3)"),
    "collapse": ("the collapse: gravity leans by 14.5 degrees", "2 (slowest 6)"),
    "asleep": ("asleep", "0.002"),
}


def motion(recorded):
    """A tower of 18 rows in motion, and the recorded game, for docs/performance.md."""
    return table(["18 rows", "tolerance, mm", "median, ms", "99th percentile", "slowest", "required"],
                 [(MOTION[row["scene"]][0], number(1000 * float(row["tolerance_m"])), number(row["cpu_ms_median"]), number(row["cpu_ms_p99"]),
                   number(row["cpu_ms_max"]), MOTION[row["scene"]][1]) for row in recorded])


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
    def box3d(stack):
        found = [row for row in peers if (row["engine"], row["settings"], row["scene"], row["threads"]) == ("Box3D", "substeps 32", stack, "1")]
        verdicts = " / ".join(sorted({row["verdict"].split("@")[0] for row in found}))
        return f"{_extent(found, 'median_ms', 2)}, {_extent(found, 'penetration_end_mm', 2)}, {verdicts}" if found else ""
    lines = []
    for stack, row in ours.items():
        one, two, other = row["1"], row.get("2"), bullet.get(stack)
        lines.append((
            f"`{stack}`", one["blocks"], number(one["cpu_ms_median"]) + (f" ({one['required_ms']})" if one["required_ms"] else ""),
            number(two["wall_ms_median"]) if two else "", number(one["penetration_mm"], 1), number(one["equilibrium_s"]),
            f"{float(other['substeps']):g}, {number(other['cpu_ms_median'])}, {number(other['penetration_mm'])}" if other else "",
            box3d(stack)))
    return table(["`--stacks`", "blocks", "ms, one thread (required)", "two threads", "penetration, mm", "equilibrium, s",
                  "Bullet: substeps, ms, penetration", "Box3D, 32 substeps: ms, penetration, verdict"], lines)


def starts(recorded):
    """The search for the equilibrium, for docs/performance.md."""
    ours, _ = _ours(recorded, "stack")
    names = {"tower": "equal rows", "uneven": "uneven heights", "tilted": "equal rows, tilted", "uneven-tilted": "uneven and tilted",
             "tilted-towers": "towers of 18 rows, tilted"}
    lines = []
    for stack, row in ours.items():
        name, size = stack.split(":")
        what = f"{size} {names[name]}" if name == "tilted-towers" else f"{size} rows, {names[name].replace('equal rows, ', '').replace('equal rows', 'equal')}"
        lines.append((f"`{stack}`", what, number(1e3 * float(row["1"]["equilibrium_s"])), f"{1e3 * float(row['1']['first_frame_allowed_s']):g}"))
    return table(["`--stacks`", "", "took, ms", "required"], lines)


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
    return table(["engine", "settings", "ms a frame, median", "worst penetration, mm", "top lower by, mm", "creep, mm",
                  "stands for 60 s"],
                 [(f"{row['engine']} ({row['version'].split()[0]})", cell(row["settings"]), row["ms_per_frame"],
                   row["worst_penetration_mm"], row["top_height_error_mm"].lstrip("-"), row["creep_mm"],
                   cell(row["stands_60_s"])) for row in recorded])


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
    """Box3D and Jolt on what falls, one thread, for docs/accuracy.md: by how many frames were timed, as more of them have more of
    the time after the fall in them."""
    lines = []
    for (scene, blocks, engine, settings), rows in _by_setting(recorded):
        for frames in sorted({int(row["frames"]) for row in rows}):
            of = [row for row in rows if int(row["frames"]) == frames]
            lines.append((f"`{scene}`", str(blocks), engine, settings, str(frames), _extent(of, "median_ms", 3), _extent(of, "worst_ms", 3),
                          _extent(of, "penetration_max_mm", 2)))
    return table(["scene", "blocks", "engine", "settings", "frames", "ms a frame, median", "worst but the first, ms",
                  "largest penetration, mm"], lines)


def game_parts(recorded):
    """Parts of the recorded game, for docs/performance.md."""
    return table(["frames", "what happens in them", "median", "99th percentile", "slowest", "above 3 ms"],
                 [(f"{row['first']} to {row['last']}", row["what"], number(row["ms_median"]), number(row["ms_p99"]), number(row["ms_max"]),
                   row["over_3_ms"]) for row in recorded])


KERNELS = {"springs/1": "springs", "contacts/1": "contact points", "frames/1": "frames of blocks", "accelerations": "accelerations of blocks"}


def roofline(recorded):
    """Kernels beside what the machine can do, for docs/performance.md."""
    rows = {row["name"]: row for row in recorded}
    def giga(name, column):
        return float(rows[name][column]) / 1e9
    separate = giga("multiplyAdd/separate", "flops")
    triad = {int(name.split("/")[1]): giga(name, "bytes_per_second") for name in rows if name.startswith("triad/")}
    caches = [rate for size, rate in triad.items() if size < max(triad)]  # the largest streams from memory
    lines = []
    for name, words in KERNELS.items():
        flops, bytes_, items = (float(rows[name][column]) for column in ("flops", "bytes_per_second", "items_per_second"))
        lines.append((words, f"{flops / items:.0f}", f"{bytes_ / items:.0f}", f"{flops / bytes_:.1f}", number(flops / 1e9), number(bytes_ / 1e9),
                      f"{100 * giga(name, 'flops') / separate:.0f} % of arithmetic, "
                      f"{100 * bytes_ / 1e9 / max(caches):.0f} to {100 * bytes_ / 1e9 / min(caches):.0f} % of cache bandwidth"))
    triads = ", ".join(f"{number(rate)} GB/s ({_size(size)})" for size, rate in triad.items())
    fused = number(giga("multiplyAdd/fused", "flops"))
    return (table(["kernel", "flop an item", "bytes an item", "flop a byte", "Gflop/s", "GB/s", "of the machine's best"], lines)
            + f"\n\nThe machine's own best, AVX2: {number(separate)} Gflop/s without fused multiply-adds and {fused} with; {triads}.")


def _size(byte_count):
    return f"{byte_count >> 20} MB" if byte_count >= 1 << 20 else f"{byte_count >> 10} kB"


FACTORS = {"Ours": "ours, float, from the bottom up", "Eigen<LltFloat>": "Eigen `SimplicialLLT`, float, in our order",
           "Eigen<LltNatural>": "Eigen `SimplicialLLT`, double, in our order", "Eigen<LltOrdered>": "Eigen `SimplicialLLT`, double, in its own order",
           "Eigen<LdltOrdered>": "Eigen `SimplicialLDLT`, double, in its own order"}


def factors(recorded):
    """The factorisation of 18 rows beside Eigen's, for docs/performance.md."""
    times = {row["name"]: f"{number(row['cpu_time'])}" for row in recorded}
    return table(["factors", "factorisation, us", "solution, us"],
                 [(words, times.get(f"factorise{name}", ""), times.get(f"solve{name}", "")) for name, words in FACTORS.items()])


# Scenes of a chart that come to rest, as docs/accuracy.md calls them, and its falls.
REST = {"uniform": "18 equal rows", "heights": "heights varying by 0.2 mm", "drop": "three rows dropped from 2 cm (impact included)",
        "heavy-light": "every other row ten times as heavy", "wall": "wall of 40 columns and 25 courses", "pyramid": "pyramid of 40 rows of cubes"}
FALLS = {"collapse": "collapse:18", "shot": "shot:18", "heap-200": "heap:200", "rain-200": "rain:200", "pile-3": "pile:3"}
WITHIN_MM = (0.1, 0.01, 0.001)


def _value(row):
    """The setting of a case: a tolerance, or steps of a frame and iterations where it has some."""
    if row["knob"] == "tolerance_m":
        return f"{1000 * float(row['value']):g} mm"
    iterations = f" of {row['iterations']} iterations" if row["iterations"] not in ("", "0") else ""
    steps = f"{float(row['value']):g}"
    return steps + (" step" if steps == "1" else " steps") + iterations


ENGINES = {"bullet": "Bullet", "ode": "ODE"}


def _meets(row, within_mm, outcomes):
    """As the chart's index has it: one of these outcomes; no penetration, compression of a row or creep beyond it."""
    figures = (row[name] for name in ("penetration_mm", "compression_mm", "creep_mm"))
    return (row["outcome"] in outcomes and row["cpu_ms_per_frame"]
            and not any(figure and float(figure) > within_mm for figure in figures))


def _fastest(rows, within_mm, outcomes=("right",)):
    """The fastest of these cases within a tolerance; None where none is."""
    return min((row for row in rows if _meets(row, within_mm, outcomes)), key=lambda row: float(row["cpu_ms_per_frame"]), default=None)


def _named(row):
    return f"`{row['method']}`, {number(row['cpu_ms_per_frame'])} ms" if row else "none"


def _unnamed(row):
    if row is None:
        return "none"
    cut = f", {float(row['simulated_s']):.1f} s long" if row["outcome"] == "cut short" else ""
    return f"{number(row['cpu_ms_per_frame'])} ms ({_value(row)}{cut})"


def chart_fastest(recorded):
    """The fastest case within a tolerance, scene by scene, for docs/accuracy.md."""
    def of(scene):
        return [row for row in recorded if row["scene"] == scene]
    return table(["scene", *(f"fastest within {within:g} mm" for within in WITHIN_MM)],
                 [(name, *(_named(_fastest(of(scene), within)) for within in WITHIN_MM)) for scene, name in REST.items()])


def chart_methods(recorded):
    """18 equal rows at rest: each method's fastest case within a tolerance, for docs/accuracy.md."""
    rows = [row for row in recorded if row["scene"] == "uniform"]
    lines = []
    for method in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == method]
        finest = min(1000 * float(row["value"]) for row in mine) if mine[0]["knob"] == "tolerance_m" else 0.0
        cells = []
        for within in WITHIN_MM:
            best = _fastest(mine, within, ("right", "cut short"))
            cells.append(_unnamed(best) if best or finest <= within else f"not tried below {finest:g} mm")
        lines.append((ENGINES.get(method, f"`{method}`"), *cells))
    return table(["method", *(f"within {within:g} mm" for within in WITHIN_MM)], lines)


def chart_pull(recorded):
    """A block pulled out: ms a frame by tolerance, for docs/accuracy.md."""
    rows = [row for row in recorded if row["scene"] == "pull" and row["method"] in ("implicit", "implicit-euler")]
    values = sorted({float(row["value"]) for row in rows}, reverse=True)
    def cost(method, value):
        row = next((row for row in rows if row["method"] == method and float(row["value"]) == value), None)
        if row is None:
            return ""
        return number(row["cpu_ms_per_frame"]) if row["outcome"] == "right" else row["outcome"]
    return table(["tolerance", *(f"{1000 * value:g} mm" for value in values)],
                 [(f"`{method}`, ms", *(cost(method, value) for value in values)) for method in ("implicit", "implicit-euler")])


def _fall(rows):
    """Median, worst but the first and depth of these cases: their extent."""
    if not rows:
        return ""
    median, worst, depth = (_extent(rows, name, 2) for name in ("cpu_ms_per_frame", "cpu_ms_worst_frame", "penetration_mm"))
    return f"{median} ({worst}), {depth}" if worst else f"{median}, {depth}"


def chart_falls(recorded, peers):
    """What falls, ours and others, for docs/accuracy.md. peers: bench/data/peers/falls.csv."""
    lines = []
    for scene, name in FALLS.items():
        here = [row for row in recorded if row["scene"] == scene and row["iterations"] == "0" and row["cpu_ms_per_frame"]]
        def ours(method, value=None):
            return [row for row in here if row["method"] == method and (value is None or float(row["value"]) == value)]
        def theirs(engine, settings):
            found = [row for row in peers if row["threads"] == "1" and row["scene"] == name and row["engine"] == engine and row["settings"] in settings]
            return [{"cpu_ms_per_frame": row["median_ms"], "cpu_ms_worst_frame": row["worst_ms"], "penetration_mm": row["penetration_max_mm"]}
                    for row in found]
        jolt = [row["settings"] for row in peers if row["scene"] == name and row["engine"] == "Jolt"]
        most = max(jolt, key=lambda settings: int(settings.split()[1]), default="")
        lines.append((f"`{scene}`", _fall(ours("implicit")), _fall(ours("rigid-pgs", 16)), _fall(ours("bullet", 32)),
                      _fall(theirs("Box3D", ["8 steps x 4 substeps"])), f"{most.split()[1]}: {_fall(theirs('Jolt', [most]))}" if most else ""))
    return table(["fall", "`implicit`, tolerances from 0.2 to 0.001 mm", "`rigid-pgs`, 16 steps", "Bullet, 32 steps", "Box3D, 8 steps of 4",
                  "Jolt: steps"], lines)


def chart_engines(recorded):
    """Bullet and ODE on 18 equal rows at rest, for docs/accuracy.md."""
    rows = [row for row in recorded if row["scene"] == "uniform" and row["method"] in ENGINES]
    return table(["engine", "settings", "ms a frame", "penetration, mm", "creep, mm", "jitter, mm/s", "simulated for, s", "verdict"],
                 [(ENGINES[row["method"]], _value(row),
                   *(number(row[name]) if row[name] else "" for name in ("cpu_ms_per_frame", "penetration_mm", "creep_mm", "jitter_mm_s", "simulated_s")),
                   cell(row["note"] or "stands")) for row in rows])


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
    """The rows of the scatter, {constant: its rows a tenth from it}, and {constant: {"half": row, "twice": row}}."""
    scatter = [row for row in recorded if row["constant"] in ("none", "scatter")]
    moved, wide = {}, {}
    for row in recorded:
        if row["by"] == "tenth":
            moved.setdefault(row["constant"], []).append(row)
        elif row["by"]:
            wide.setdefault(row["constant"], {})[row["by"]] = row
    return scatter, moved, wide


STATICS_ROUNDING = 1e-3  # degrees, weights: what changes a margin or a load by less is none


def _statics_effects(row):
    """What a moved constant changes in statics, in words."""
    found = [f"{row['verdicts']} answers of statics"] if int(row["verdicts"]) > 0 else []
    for column, words in (("margin_deg", "a margin by {} degrees"), ("load_weights", "a load by {} weights of a block")):
        if float(row[column]) >= STATICS_ROUNDING:
            found.append(words.format(number(row[column], 2)))
    return ", ".join(found) or "no effect"


def _effects_or_none(row, scatter):
    """What a moved constant changes, in words, also where that is nothing."""
    if row["verdicts"]:
        return _statics_effects(row)
    if int(row["states"]) == 0 and not row["ends"]:
        return "no effect"
    return _effects(row, scatter) or "end states alone"


NOT_REACHED = "nothing: half or twice of it changes no bit of these scenes"


def what_rests_on_moves(recorded):
    """{constant: what half and twice of it change, in words}, of those for which nothing else is on record."""
    scatter, _, wide = _moved(recorded)
    found = {}
    for name, rows in wide.items():
        half, twice = (_effects_or_none(rows[by], scatter) for by in ("half", "twice"))
        words = f"half or twice of it: {half}" if half == twice else f"half of it: {half}; twice: {twice}"
        found[name] = NOT_REACHED if half == twice == "no effect" else f"measured: {words}"
    return found


def what_constants_change(recorded):
    """{constant: "nothing", "states" or "figures"}: what changes where it is moved by a tenth, figures beyond the scatter."""
    scatter, moved, _ = _moved(recorded)
    def most(rows):
        if all(int(row["states"]) == 0 and not row["ends"] for row in rows):
            return "nothing"
        return "figures" if any(_effects(row, scatter) for row in rows) else "states"
    return {name: most(rows) for name, rows in moved.items()}


def constants(recorded):
    """What changes when a constant is moved by a tenth, for docs/sensitivity.md: counts, lists and a table."""
    scatter, moved, _ = _moved(recorded)
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
