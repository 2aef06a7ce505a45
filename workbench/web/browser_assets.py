"""Vue and vtk.js, which the extra `explore` installs, as files on this machine. No CDN is contacted."""

from importlib.util import find_spec
from pathlib import Path

FILES = {
    "vue.js": ("trame_client", "module/vue3-www/vue.global.js"),
    "vtk.js": ("trame_vtk", "modules/common/serve/trame-vtk.js"),
}
INSTALL = "pip install 'rod-workbench[explore]'"


def scripts() -> dict[str, Path]:
    """name -> file, in the order in which a page loads them. Raises `ImportError` where the extra is missing."""
    found = {}
    for name, (package, path) in FILES.items():
        spec = find_spec(package)
        file = Path(spec.origin).parent / path if spec and spec.origin else None
        if file is None or not file.is_file():
            raise ImportError(f"{name} is not installed: {INSTALL}", name=package)
        found[name] = file
    return found
