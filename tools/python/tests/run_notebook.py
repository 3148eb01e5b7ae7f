"""Executes a notebook where it lies, writes it with its results into a folder, and fails where a cell does.

usage: run_notebook.py NOTEBOOK.ipynb FOLDER
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

#: Seconds that a cell may take.
LIMIT_S = 900


def main(notebook: Path, folder: Path) -> None:
    content = nbformat.read(notebook, as_version=4)
    NotebookClient(content, timeout=LIMIT_S, resources={"metadata": {"path": str(notebook.parent)}}).execute()
    nbformat.write(content, folder / notebook.name)
    print(f"{notebook.name}: {sum(cell.cell_type == 'code' for cell in content.cells)} cells executed")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]))
