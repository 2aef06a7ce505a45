"""Messages that name options of the command line, in words of Python, for whoever calls from there."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from solver.problem.errors import InputError

WORDS = {"give --force": "give replace=True", "--tolerance": "tolerance"}  # options that are arguments in Python
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")


def in_python(text: str) -> str:
    """A message without options where arguments of Python stand for them; of the others it says whose they are.

    >>> in_python("y.obj exists; give --force to replace it")
    'y.obj exists; give replace=True to replace it'
    >>> in_python("choose --kind lines")
    'choose --kind lines (--kind: of the command workbench)'
    """
    for option, argument in WORDS.items():
        text = text.replace(option, argument)
    left = [option for option in dict.fromkeys(_OPTION.findall(text)) if f"workbench run takes {option}" not in text]
    return f"{text} ({', '.join(left)}: of the command workbench)" if left else text


@contextmanager
def python_words() -> Iterator[None]:
    """Raise each `InputError` of the block again, in words of Python."""
    try:
        yield
    except InputError as error:
        if (text := in_python(str(error))) == str(error):
            raise
        raise InputError(text) from None
