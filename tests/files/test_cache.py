"""The cache: every kind of damage is seen and mended, and nothing is removed that is not its own."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.files import archive, cache
from navfmu.files.digest import content_hash
from navfmu.fmi import fmu
from tests.components import systems

KEY = "0123456789abcdef" * 2


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def fill(folder: Path) -> None:
    (folder / "binaries").mkdir()
    (folder / "binaries" / "x.so").write_bytes(b"machine code" * 100)
    (folder / "a.txt").write_text("a")


def damage() -> dict:
    return {
        "cut short": lambda content: (content / "binaries" / "x.so").write_bytes(b"machine code"),
        "a flipped bit": lambda content: flip(content / "binaries" / "x.so"),
        "a missing file": lambda content: (content / "a.txt").unlink(),
        "an extra file": lambda content: (content / "binaries" / "y.so").write_bytes(b""),
        "an empty folder": lambda content: shutil.rmtree(content / "binaries"),
        "all gone": lambda content: shutil.rmtree(content),
        "a link": lambda content: relink(content / "a.txt"),
        "no sums": lambda content: resum(content, None),
        "no text": lambda content: resum(content, b"\xff\x00"),
        "other sums": lambda content: resum(content, b'{"a.txt": 3}'),
        "a list of sums": lambda content: resum(content, b"[1]"),
        "a file in its place": lambda content: instead(content.parent),
    }


def flip(file: Path) -> None:
    """One bit, and size and time as before: seen by another process."""
    before, data = file.stat(), bytearray(file.read_bytes())
    data[100] ^= 1
    file.write_bytes(data)
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    cache._checked.clear()


def resum(content: Path, data: bytes | None) -> None:
    (content.parent / "sums.json").unlink()
    if data is not None:
        (content.parent / "sums.json").write_bytes(data)
    cache._checked.clear()


def relink(file: Path) -> None:
    file.rename(file.parent.parent / "elsewhere")
    file.symlink_to(file.parent.parent / "elsewhere")


def instead(entry: Path) -> None:
    shutil.rmtree(entry)
    entry.write_text("")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", damage())
def test_a_damaged_entry_is_not_found_and_made_anew(home, name):
    content = cache.keep("unpacked", KEY, fill)
    good = contents(content)
    assert cache.find("unpacked", KEY) == content
    damage()[name](content)
    assert cache.find("unpacked", KEY) is None
    assert [held.damaged for held in cache.holdings() if held.damaged] == [(content.parent,)]
    assert cache.keep("unpacked", KEY, fill) == content
    assert contents(content) == good and cache.find("unpacked", KEY) == content
    assert [path.name for path in (home / "unpacked").iterdir()] == [KEY]


def test_what_is_intact_is_not_made_twice_and_read_once_in_a_process(monkeypatch):
    cache.keep("unpacked", KEY, fill)
    assert cache.keep("unpacked", KEY, pytest.fail) == cache.find("unpacked", KEY)
    monkeypatch.setattr(cache, "content_hash", lambda path: pytest.fail("read again"))
    assert cache.find("unpacked", KEY)


def test_an_entry_that_could_not_be_made_leaves_nothing(home):
    def broken(folder: Path) -> None:
        fill(folder)
        raise NavfmuError("no")

    with pytest.raises(NavfmuError, match="no"):
        cache.keep("unpacked", KEY, broken)
    assert list((home / "unpacked").iterdir()) == [] and cache.find("unpacked", KEY) is None


def test_many_threads_mend_one_entry(home):
    content = cache.keep("unpacked", KEY, fill)
    flip(content / "binaries" / "x.so")
    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(lambda _: cache.keep("unpacked", KEY, fill), range(16))) == {content}
    assert (content / "binaries" / "x.so").read_bytes() == b"machine code" * 100
    assert [path.name for path in (home / "unpacked").iterdir()] == [KEY]


@pytest.mark.parametrize("kind", ["library", "system"])
def test_a_system_flies_after_its_files_in_the_cache_were_cut_short(home, monkeypatch, kind):
    """A library cut short ended the process with a bus error."""
    first = System.load(systems.tracker()).run(stop=2.0, seed=1)
    files = list(home.glob("unpacked/*/content/binaries/*/*" if kind == "library" else "systems/*/content/resources/*"))
    assert files
    for file in files:
        data = file.read_bytes()
        file.unlink()  # this process has it loaded
        file.write_bytes(data[:3000])
    script = (
        "import sys; from navfmu import System;"
        "print(System.load(sys.argv[1]).run(stop=2.0, seed=1).to_csv(float_format=repr), end='')"
    )
    done = subprocess.run([sys.executable, "-c", script, str(systems.tracker())], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == first.to_csv(float_format=repr)
    assert not [held for held in cache.holdings() if held.damaged]


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("when", ["mkdir", "fill", "write_text"])
def test_a_full_disk_is_a_sentence_and_leaves_nothing(when, home, monkeypatch):
    """It lets one make the folder, and then not write into it."""
    own = getattr(Path, when, None)

    def full(path, *arguments, **options):
        if path.parent.name.startswith(".") and path.name in ("content", "sums.json"):
            raise FULL
        return own(path, *arguments, **options)

    def stuff(folder):
        raise FULL

    if own is not None:
        monkeypatch.setattr(Path, when, full)
    with pytest.raises(NavfmuError) as refused:
        cache.keep("unpacked", KEY, stuff if when == "fill" else fill)
    assert str(refused.value) == (
        f"{home}/unpacked: the cache folder cannot be written: No space left on device; "
        "set NAVFMU_CACHE to a folder that can"
    )
    assert list((home / "unpacked").iterdir()) == []


# ---- the command -----------------------------------------------------------------------------------------------------


def navfmu(*arguments: str):
    return CliRunner().invoke(main, ["cache", *arguments])


def test_the_command_shows_what_there_is_and_what_is_damaged(home):
    cache.keep("unpacked", KEY, fill)
    flip(cache.keep("built", KEY, fill) / "binaries" / "x.so")
    (home / "fmu").mkdir()
    (home / "fmu" / f"{KEY}.v2.json").write_text("{}")
    lines = navfmu().output.splitlines()
    assert lines[0] == str(home)
    rows = {line[:22].strip(): line[22:].split() for line in lines[2:]}
    assert rows["unpacked FMUs"] == ["1", "0.0", "0"] and rows["built FMUs"] == ["1", "0.0", "1"]
    assert rows["of earlier versions"] == ["1", "0.0", "0"] and rows["all"] == ["3", "0.0", "1"]
    assert lines[-1] == f"damaged: {home / 'built' / KEY}"


def test_it_is_emptied_and_nothing_else_is_removed(home):
    content = cache.keep("unpacked", KEY, fill)
    flip(cache.keep("built", KEY, fill) / "binaries" / "x.so")
    (home / "built" / ".unfinished").mkdir()
    (home / "fmus").mkdir()
    (home / "fmus" / f"{KEY}.fmu").write_text("of an earlier version")
    (home / "fmus" / "dme.py").write_text("my own")
    result = navfmu("--clear")
    assert result.exit_code == 0 and "4 entries removed" in result.output
    assert not content.exists()
    assert sorted(path.name for path in home.rglob("*")) == [".used", "dme.py", "fmus"]


def test_a_folder_that_is_no_cache_is_left_alone(home):
    content = cache.keep("unpacked", KEY, fill)
    (home / "thesis.tex").write_text("years of work")
    result = navfmu("--clear")
    assert (
        result.exit_code == 2 and "is no cache of navfmu: it holds 'thesis.tex'; nothing was removed" in result.stderr
    )
    assert content.is_dir()


def test_a_cache_that_is_not_there_is_empty(home):
    assert navfmu("--clear").output.endswith("0 entries removed\n") and navfmu().exit_code == 0
    assert not home.exists()


@pytest.mark.skipif(cache.fcntl is None, reason="on Windows what is open cannot be removed")
def test_what_another_process_uses_stays(home):
    script = "import sys; from navfmu import System; System.load(sys.argv[1]); print('ready', flush=True); input()"
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", script, str(systems.tracker())], **pipes) as other:
        assert other.stdout.readline() == "ready\n"
        result = navfmu("--clear")
        assert result.exit_code == 2 and "another process of navfmu uses this cache" in result.stderr
        assert list(home.glob("unpacked/*"))
        other.communicate("\n")
    assert navfmu("--clear").exit_code == 0 and not list(home.glob("unpacked/*"))


def test_a_process_that_ends_says_nothing_of_its_lock(home):
    """A file object that is open at the end is a ResourceWarning, which some runs printed behind their table."""
    home.mkdir()
    script = "from navfmu.files import cache; cache.find('unpacked', 'none')"
    warn = [sys.executable, "-W", "always::ResourceWarning", "-c", script]
    assert subprocess.run(warn, capture_output=True, text=True, check=True).stderr == ""
    assert (home / ".used").is_file()


def test_the_folder_is_where_the_system_keeps_caches(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    if sys.platform == "linux":
        assert cache.directory() == tmp_path / "navfmu"
        monkeypatch.delenv("XDG_CACHE_HOME")
        monkeypatch.setenv("HOME", str(tmp_path / "home"))
        assert cache.directory() == tmp_path / "home" / ".cache" / "navfmu"


def test_an_fmu_is_unpacked_again_when_its_entry_was_removed(home, monkeypatch):
    file = systems.fmus() / "lag.fmu"
    loaded = fmu.load(file)
    assert archive.unpack(file, "FMU", content_hash(file)) == loaded.folder
    assert navfmu("--clear").exit_code == 0
    assert fmu.load(file).library.is_file()


@pytest.mark.parametrize("option", [[], ["--clear"]])
def test_a_cache_that_is_a_file_is_told(tmp_path, monkeypatch, option):
    (tmp_path / "file").write_text("mine")
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "file"))
    result = CliRunner().invoke(main, ["cache", *option])
    assert result.exit_code == 2 and result.stdout == ""
    assert result.stderr.startswith(f"navfmu: {tmp_path / 'file'}: is a file, expected the folder of the cache")
    assert (tmp_path / "file").read_text() == "mine"
