"""What `pip install .` calls (PEP 517): builds a wheel with CMake, and needs nothing from the network.

The wheel holds the package mvtp, and the programs with their data as `cmake --install` lays them out,
so that bin/mvtp of the environment is the one that the package runs. CMAKE_ARGS, as usual, is for
options of CMake's.
"""

import base64
import hashlib
import os
import re
import shlex
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "pip"
PACKAGES = Path("lib/python3/dist-packages")  # MVTP_PYTHON_DIR
DEBIANS = ("share/doc", "share/lintian")  # of no use but in Debian's packages


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with tempfile.TemporaryDirectory() as stage:
        _build(Path(stage))
        name = f"mvtp-{_version()}-{_tag()}.whl"
        with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
            _Writer(wheel).write_all(Path(stage))
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = Path(metadata_directory) / _info()
    info.mkdir()
    for name, text in _metadata().items():
        (info / name).write_text(text, encoding="utf-8")
    return info.name


def _build(stage):
    """Builds what is installed, into a tree of its own."""
    options = [
        "-DCMAKE_BUILD_TYPE=Release",
        "-DMVTP_BUILD_TESTS=OFF",
        f"-DMVTP_PYTHON_DIR={PACKAGES}",
        f"-DPython3_EXECUTABLE={sys.executable}",
        *shlex.split(os.environ.get("CMAKE_ARGS", "")),
    ]
    if shutil.which("ninja"):
        options = ["-G", "Ninja", *options]
    _run("cmake", "--fresh", "-S", ROOT, "-B", BUILD, *options)
    _run("cmake", "--build", BUILD, "--parallel", os.cpu_count() or 1)
    for component in ("mvtp", "python"):
        _run("cmake", "--install", BUILD, "--prefix", stage, "--component", component, "--strip")
    if not (stage / PACKAGES).exists():
        sys.exit("mvtp: pybind11-dev or python3-dev is missing; run tools/install_packages.sh")


def _run(*words):
    subprocess.run([str(word) for word in words], check=True)


def _version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(mvtp VERSION ([0-9.]+)", text)[1]


def _info():
    return f"mvtp-{_version()}.dist-info"


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _metadata():
    return {
        "METADATA": f"Metadata-Version: 2.1\nName: mvtp\nVersion: {_version()}\n"
        "Summary: Coordinates many car-like vehicles: in SUMO, on benchmark maps, on robots\n"
        "License: EPL-2.0\nRequires-Python: >=3.10\nRequires-Dist: numpy\n",
        "WHEEL": "Wheel-Version: 1.0\nGenerator: mvtp\nRoot-Is-Purelib: false\n"
        f"Tag: {_tag()}\n",
        "LICENSE": (ROOT / "LICENSE").read_text(encoding="utf-8"),
    }


class _Writer:
    """Puts files into a wheel, and their hashes into its RECORD."""

    def __init__(self, wheel):
        self.wheel = wheel
        self.record = []

    def write_all(self, stage):
        for path in sorted(stage.rglob("*")):
            place = path.relative_to(stage)
            if path.is_file() and not any(place.is_relative_to(d) for d in DEBIANS):
                mode = stat.S_IMODE(path.stat().st_mode)
                self._add(_place(place), path.read_bytes(), mode)
        for name, text in _metadata().items():
            self._add(f"{_info()}/{name}", text.encode())
        record = f"{_info()}/RECORD"
        self._add(record, "".join([*self.record, f"{record},,\n"]).encode())

    def _add(self, name, content, mode=0o644):
        entry = zipfile.ZipInfo(name)
        entry.external_attr = (stat.S_IFREG | mode) << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        self.wheel.writestr(entry, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(content)}\n")


def _place(path):
    """Where an installed file lies in the wheel."""
    if path.is_relative_to(PACKAGES):
        return path.relative_to(PACKAGES).as_posix()
    data = f"mvtp-{_version()}.data"
    if path.parts[0] == "bin":
        return f"{data}/scripts/{path.relative_to('bin').as_posix()}"
    return f"{data}/data/{path.as_posix()}"
