"""The words around a scene: subtitle, legend and notes. The frames of a film share one legend. No OpenGL."""

from typing import TYPE_CHECKING

from ..data import labels
from . import captions, footer
from .page import Words

if TYPE_CHECKING:
    from .composition import Scene


def words(scene: "Scene") -> Words:
    """The words around the views of a scene."""
    ds = scene.ds
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (scene.case, labels.reading(ds), inside) if fact)
    return Words(str(ds.attrs["title"]), subtitle, str(ds.attrs["length_unit"]), _legend(scene), _notes(scene),
                 scene.bar, scene.columns, scene.heads)  # fmt: skip


def _legend(scene: "Scene") -> list[tuple[str, str]]:
    """Colours and their meaning; in a film those of all frames."""
    found = list(scene.kind.legend(scene.context))
    if scene.labels:
        found += [(body.paint.colour, text) for body, text in zip(scene.views[0].bodies, scene.labels, strict=True)]
    frames = scene.frames or [scene]
    crossings = [view.crossings(scene.camera) for frame in frames for view in frame.ringed_views]
    if any(seen for seen, _ in crossings):
        some = any(hidden for _, hidden in crossings) and not scene.frames  # a frame has no room for it
        found.append((footer.RING, captions.ITSELF + (captions.UNSEEN if some else "")))
    if any(view.hides(body, scene.camera) for frame in frames for view in frame.views for body in view.bodies):
        found.append((footer.OUTLINE, captions.BEHIND))
    return found


def _notes(scene: "Scene") -> list[str]:
    """The notes of this scene; that a rod passes through itself is said by the legend where a ring is seen."""
    found = list(scene.notes)
    if scene.kind.cells != "together":
        found += captions.impossible(scene.bodies)
    ringed = any(view.crossings(scene.camera)[0] for view in scene.ringed_views)
    return [note for note in found if not (ringed and note == captions.ITSELF)]
