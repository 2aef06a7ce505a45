"""The command check: judge the laws of a stored study."""

from .options import File
from .present import Result, presents
from .study_result import result_of


@presents()
def check(file: File) -> Result:
    """Judge the laws of a stored study.

    Exit status 1 if a case is unsolved, or if a law fails, is not decided or is true in part only.
    """
    from solver.problem import angles
    from studies.language.loader import notices

    from ..store import file_checks, reading
    from ..store.tally import statistics

    with reading.open_study(file, whole=True) as ds, file_checks.refusing(file):
        named = {"title": ds.attrs["title"], "study": ds.attrs["study_name"], "reading": ds.attrs["reading"]}
        found = {**named, "file": str(file), **statistics(ds)}
        text = str(ds.attrs.get("study", ""))
    for sentence in notices(text, f"{file.name}, its study"):
        angles.warn(sentence)
    return result_of(found)
