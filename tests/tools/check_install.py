"""Law: apps/install.sh touches apt only when a package is missing, and then asks for the missing ones alone."""

import argparse
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARGUMENTS = argparse.ArgumentParser()
ARGUMENTS.add_argument("--source", type=Path, default=Path(__file__).resolve().parents[2])
ARGUMENTS.add_argument("--build", type=Path)
SOURCE = ARGUMENTS.parse_known_args()[0].source

# Stand-ins for the system's programs: they write down what they are asked for.
STAND_INS = {
    "dpkg-query": 'grep -qx "${@: -1}" "$STATE/absent" && exit 1; echo installed',
    "apt-get": 'echo "apt-get $*" >>"$STATE/calls"; [[ " $* " != *" $FAILING "* ]]',
    "sudo": 'echo "sudo" >>"$STATE/calls"; exec "$@"',
    "id": 'echo "$USER_ID"',
}
DEBIAN_12 = 'PRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\nID=debian\nVERSION_ID="12"\n'
UBUNTU = 'PRETTY_NAME="Ubuntu 24.04"\nID=ubuntu\nVERSION_ID="24.04"\n'


class Install(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "bin").mkdir()
        for name in ("bash", "sed", "grep", "env", "mktemp", "tail", "rm", "tr"):  # and no sudo unless a test wants it
            (self.folder / "bin" / name).symlink_to(Path("/usr/bin") / name)
        for name in ("dpkg-query", "apt-get", "id"):
            self.stand_in(name)

    def stand_in(self, name):
        file = self.folder / "bin" / name
        file.write_text(f"#!/bin/bash\n{STAND_INS[name]}\n", encoding="utf-8")
        file.chmod(0o755)

    def install(self, absent=(), user_id=0, release=DEBIAN_12, failing="nothing", skip="0"):
        """Runs the script in front of the stand-ins; returns status, standard error, calls to apt-get and sudo."""
        (self.folder / "absent").write_text("".join(f"{name}\n" for name in absent), encoding="utf-8")
        (self.folder / "release").write_text(release, encoding="utf-8")
        environment = {"PATH": str(self.folder / "bin"), "STATE": str(self.folder), "USER_ID": str(user_id),
                       "FAILING": failing, "SLOWSAND_OS_RELEASE": str(self.folder / "release"),
                       "SLOWSAND_SKIP_INSTALL": skip, "TMPDIR": os.environ.get("TMPDIR", "/tmp")}
        done = subprocess.run(["/bin/bash", str(SOURCE / "apps" / "install.sh")], env=environment, capture_output=True,
                              text=True)
        calls = self.folder / "calls"
        return done.returncode, done.stderr, calls.read_text(encoding="utf-8").splitlines() if calls.exists() else []

    def test_nothing_missing_means_no_call(self):
        self.assertEqual(self.install(), (0, "", []))
        self.assertEqual(self.install(release=UBUNTU)[0], 0)  # all there: the system does not matter

    def test_root_installs_only_what_is_missing(self):
        status, _, calls = self.install(absent=["ccache", "python3-h5py"])
        self.assertEqual((status, len(calls)), (0, 2))
        self.assertTrue(calls[0].endswith(" update"), calls[0])
        self.assertTrue(calls[1].endswith("install -y --no-install-recommends ccache python3-h5py"), calls[1])

    def test_others_need_sudo(self):
        status, message, calls = self.install(absent=["ccache"], user_id=1000)
        self.assertEqual((status, calls), (1, []))
        self.assertIn("root or sudo", message)
        self.stand_in("sudo")
        status, _, calls = self.install(absent=["ccache"], user_id=1000)
        self.assertEqual((status, calls.count("sudo"), len(calls)), (0, 2, 4))

    def test_another_system_is_named(self):
        status, message, calls = self.install(absent=["ccache"], release=UBUNTU)
        self.assertEqual((status, calls), (1, []))
        self.assertIn("Debian 12", message)
        self.assertIn("Ubuntu 24.04", message)
        self.assertEqual(self.install(absent=["ccache"], release=UBUNTU, skip="1")[0], 0)

    def test_failure_of_apt_stops_with_its_cause(self):
        for failing in ("update", "install"):
            status, message, _ = self.install(absent=["ccache"], failing=failing)
            self.assertEqual(status, 1)
            self.assertIn(f"'apt-get {failing}' failed", message)

    def test_without_apt(self):
        (self.folder / "bin" / "apt-get").unlink()
        status, message, _ = self.install(absent=["ccache"])
        self.assertEqual(status, 1)
        self.assertIn("apt-get is not there", message)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
