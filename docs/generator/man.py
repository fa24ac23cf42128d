"""Manual pages in roff's man macros."""


def escape(text):
    """Text as roff reads it literally."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def _block(text):
    """Lines as they are, in a fixed font."""
    return [".nf", ".ft CR", *[escape(line) if line else "\\&" for line in text.split("\n")], ".ft R", ".fi"]


def _options(options):
    lines = []
    for option in options:
        head = ", ".join(f"\\fB{escape(name)}\\fR" for name in option.names)
        head += (" " if option.names else "") + (f"\\fI{escape(option.value)}\\fR" if option.value else "")
        text = option.text + ("; required" if option.required else "") + (f"; only with {option.needs}" if option.needs else "")
        lines += [".TP", head, escape(text)]
    return lines


def _own(command):
    """The options that are not the same everywhere."""
    return [option for option in command.options if "--help" not in option.names and "--help-all" not in option.names]


def _page(program, text, synopsis, body, examples, also):
    return "\n".join([
        '.\\" Made by docs/generate.py from the help of the program.',
        f'.TH {program.upper()} 1 "" "Springtower" "User Commands"',
        ".SH NAME", f"{escape(program)} \\- {escape(text)}",
        ".SH SYNOPSIS", *synopsis, *body, ".SH EXAMPLES AND NOTES", *_block(examples),
        ".SH FILES AND SIGNALS",
        "A file appears under its name when it is whole; until then it is \\fINAME.partial\\fR. SIGINT and SIGTERM end the work at the next "
        "frame, line or case, and what is done is kept.",
        ".SH SEE ALSO", f"\\fB{escape(also)}\\fR(1)", ""])


def pages(commands, viewer):
    """{path: text} of both pages. commands: the program and then its commands."""
    program, rest = commands[0], commands[1:]
    body = [".SH DESCRIPTION", escape(program.text), ".SH COMMANDS"]
    for command in rest:
        body += [".SS " + escape(command.usage), escape(command.text[0].upper() + command.text[1:] + "."),
                 *_options(command.positionals + _own(command))]
        if command.footer:
            body += [".PP", *_block(command.footer)]
    body += [".SH OPTIONS", *_options(program.options)]
    usage = [f"\\fB{escape(program.name)}\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]"]
    viewer_usage = [f"\\fB{escape(viewer.name)}\\fR [\\fIOPTIONS\\fR]"]
    viewer_body = [".SH DESCRIPTION", escape(viewer.text), ".SH OPTIONS", *_options(viewer.options)]
    return {
        f"docs/man/{program.name}.1": _page(program.name, "simulates stacks of wooden blocks", usage, body, program.footer, viewer.name),
        f"docs/man/{viewer.name}.1": _page(viewer.name, "shows stacks of wooden blocks, and the game", viewer_usage, viewer_body,
                                           viewer.footer, program.name),
    }
