"""What the checks of the source tree share: which files there are, and the proof that a check finds what is planted."""

import argparse
import subprocess
import tempfile
from pathlib import Path


def list_files(root):
    """Tracked files and those about to be, from the root; in a source archive without .git, all."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard"], capture_output=True,
                            text=True)
    names = listed.stdout.splitlines() if listed.returncode == 0 else [
        str(file.relative_to(root)) for file in root.rglob("*")
        if file.relative_to(root).parts[0] not in ("build", "runs")]
    return sorted(Path(name) for name in names if (root / name).is_file())


def check_self(check_tree, planted):
    """Every planted fault is found, and nothing else. planted: file -> (text, is it a fault?)."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, (text, _) in planted.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        found = {fault.split(":")[0] for fault in check_tree(root)[0]}
    expected = {name for name, (_, is_fault) in planted.items() if is_fault}
    return [f"self-test: {name} planted and not found" for name in sorted(expected - found)] + [
        f"self-test: {name} is right and was refused" for name in sorted(found - expected)]


def run_check(law, check_tree, planted, praise):
    """Checks the tree that --source names; returns the exit status. check_tree: root -> (faults, number of files)."""
    parser = argparse.ArgumentParser(description=law)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path)
    faults, n_files = check_tree(parser.parse_args().source)
    faults = check_self(check_tree, planted) + faults
    print("\n".join(faults) or f"{n_files} files {praise}")
    return 1 if faults or n_files == 0 else 0
