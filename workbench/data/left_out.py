"""What the model leaves out, in one sentence: a help to judge a pipe.

`docs/explanation/what-the-model-leaves-out.md` says how much each of these may change.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solver import Case

SENTENCE = "The model leaves out weight, friction, joints, and clearance at the ends."


def note(case: "Case") -> str:
    """The sentence that belongs to a rod inside a cylinder; "" for one outside."""
    if case.cylinder.side != "inside":
        return ""
    given = {"weight": case.rod.weight, "friction": case.cylinder.friction}
    missing = [f"{name}, " for name, value in given.items() if value is None or not value]
    return SENTENCE.replace("weight, friction, joints, and", f"{''.join(missing)}joints{',' * bool(missing)} and")
