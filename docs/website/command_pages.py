"""The reference of the command line: a page for each command, from the parser itself."""

from pathlib import Path
from typing import Any

import typer.main

from workbench import cli


def write(folder: Path) -> None:
    """Write the page of each command and the page that lists them."""
    pages = folder / "reference" / "command-line"
    pages.mkdir(parents=True)
    commands = commands_by_name()
    lines = ["# Reference: command line", "", "Every option of every command, as the parser knows them."]
    lines += ["[Commands and exit statuses](commands.md) says what they do.", ""]
    for heading, names in cli.GROUPS.items():
        lines += [f"## {heading}", ""]
        for name in names:
            (pages / f"{name}.md").write_text(page(name, commands[name]), encoding="utf-8")
            lines.append(
                f"- [`workbench {name}`](command-line/{name}.md): {_plain(cli.first_sentence(commands[name]))}"
            )
        lines.append("")
    lines += ["```{toctree}", ":hidden:", ""]
    lines += [f"{name} <command-line/{name}>" for names in cli.GROUPS.values() for name in names]
    (folder / "reference" / "command-line.md").write_text("\n".join([*lines, "```", ""]), encoding="utf-8")


def commands_by_name() -> dict[str, Any]:
    """The commands by name, as the parser knows them."""
    group: Any = typer.main.get_command(cli.app)
    return dict(group.commands)


def page(name: str, command: Any) -> str:
    """The page of one command: its use, its help, its options under their headings, its examples."""
    context = command.make_context(f"workbench {name}", [], resilient_parsing=True)
    use = " ".join([f"workbench {name}", *command.collect_usage_pieces(context)])
    lines = [f"# workbench {name}", "", "```text", use, "```", ""]
    for paragraph in (command.help or "").split("\n\n"):
        lines += [_plain(" ".join(paragraph.split())), ""]
    for heading, rows in cli.option_records(command, context).items():
        lines += [f"## {heading}", "", "| option | meaning |", "|---|---|"]
        lines += [f"| {_code(names)} | {_plain(said)} |" for names, said in rows]
        lines.append("")
    examples = (f"workbench {example}" for example in cli.COMMANDS[name][1:])
    lines += ["## Examples", "", "```sh", *examples, "```", ""]
    return "\n".join(lines)


def _code(text: str) -> str:
    return f"`{text}`".replace("|", r"\|")


def _plain(text: str) -> str:
    """A text in which no character is markup."""
    for mark in ("\\", "|", "*", "_", "<", "[", "`"):
        text = text.replace(mark, f"\\{mark}")
    return text
