"""How the documentation site is built: `python -m docs.build`. Each module makes one part of it."""
