"""The help of the command line: commands and options under headings, no line cut off, examples at the end."""

from typing import Any

from typer.core import TyperCommand, TyperGroup

# heading -> its commands, in the order of --help
GROUPS: dict[str, tuple[str, ...]] = {
    "The paper": ("reproduce",),
    "One rod": ("solve", "fit", "explore"),
    "Equilibria": ("equilibria", "folds", "loops"),
    "Studies": ("list", "run", "check", "summary", "merge", "sensitivity"),
    "Pictures and files": ("plot", "scene", "export"),
    "Documentation": ("docs",),
    "Methods and machine": ("trade", "extremes", "gallery", "doctor"),
    "Kept for this release": ("animate",),
}

# command -> examples; each begins behind "workbench "
EXAMPLES: dict[str, tuple[str, ...]] = {
    "reproduce": ("reproduce --out results",),
    "list": ("list",),
    "run": ("run fig7_1_modulus", "run study.toml --out study.h5 --tol 1e-10"),
    "check": ("check fig7_1_modulus.h5",),
    "summary": ("summary fig7_1_modulus.h5",),
    "merge": ("merge first.h5 second.h5 --out both.h5",),
    "plot": ("plot regimes.h5 --show turns --shapes 6x4", "plot fig7_1_modulus.h5 --out figure.pdf"),
    "scene": ("scene fig6 --kind contact", "scene fig7_1_modulus --at E=5000 --out soft.png",
              "scene fig7_4_end_angle.h5 --out end.mp4"),
    "animate": ("animate fig7_4_end_angle.h5 --out end.gif",),
    "gallery": ("gallery --out pictures",),
    "export": ("export fig6.h5 --out rod.step", "export fig7_1_modulus.h5 --at E=5000 --out rod.glb"),
    "solve": (
        "solve",
        "solve --table1 --E 2e4 --beta 45deg",
        "solve --length-unit m --force-unit kN --E 2.06e8 --nu 0.3 --a 0.06 --L 20 --R 0.11 --side inside --beta0 0 "
        "--betaL 0 --FZ -200",
        "solve --length-unit mm --E 2e5 --nu 0.3 --a 1 --L 1500 --R 60 --tension 500 --lay 80deg",
    ),
    "equilibria": ("equilibria --plot all.png", "equilibria --axis betaL=-90deg:60deg:41"),
    "folds": ("folds --axis betaL=-60deg:90deg --axis FZ=4:12 --plot map.png",),
    "loops": (
        "loops --a 0.05 --R 0.95 --L 12 --folds 1,2,3 -o loops.png",
        "loops --length-unit nm --force-unit pN --EI 207 --GJ 310 --a 1 --L 40 --R 3 --out loops.h5",
    ),
    "sensitivity": (
        "sensitivity fig7_1_modulus --at E=5000 --show height,wraps --plot tornado.pdf",
        "sensitivity study.h5 --global --plot indices.png",
    ),
    "fit": (
        "fit fig7_1_modulus --at E=10905 --target height=9 --vary F1 --bounds F1=1:9",
        "fit my_rod.toml --points points.csv --vary E,M3 --plot fit.png",
    ),
    "explore": ("explore", "explore fig7_1_modulus"),
    "trade": ("trade",),
    "extremes": ("extremes",),
    "doctor": ("doctor",),
    "docs": ("docs", "docs --print"),
}  # fmt: skip


class Overview(TyperGroup):
    """The commands under headings, each with its whole first sentence."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands of each heading."""
        for heading, names in GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(name, _sentence(self.commands[name].help)) for name in names])


class CommandHelp(TyperCommand):
    """The arguments and options of a command under headings, then its examples."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the options under the headings that they name, in the order of their first option."""
        found: dict[str, list[tuple[str, str]]] = {}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                usual = "Arguments" if param.param_type_name == "argument" else "Options"
                found.setdefault(getattr(param, "rich_help_panel", None) or usual, []).append(record)
        for heading, records in found.items():
            with formatter.section(heading):
                formatter.write_dl(records)
        examples = EXAMPLES.get(str(self.name), ())
        if examples:
            with formatter.section("Examples"):
                for example in examples:
                    formatter.write_text(f"workbench {example}")


def _sentence(text: str | None) -> str:
    """The first sentence of a help text."""
    return " ".join((text or "").split("\n\n")[0].split())
