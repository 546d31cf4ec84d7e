"""Every unusable input is one line on stderr, status 2, and nothing written."""
import os
import resource
import signal
import subprocess
import sys
import time

import pytest
from conftest import wavy_face

import trimquad
from trimquad import cli


def run(capsys, *arguments):
    """Status and lines on stderr of the command line."""
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    try:
        status = cli.main([str(a) for a in arguments])
    finally:
        signal.signal(signal.SIGINT, before[0])
        signal.signal(signal.SIGTERM, before[1])
    return status, capsys.readouterr().err.strip().splitlines()


def assert_refused(capsys, tmp_path, *arguments, says=""):
    out = tmp_path / "out"
    status, lines = run(capsys, "convert", *arguments, "--out", out, "--quiet")
    assert status == 2, lines
    assert len(lines) == 1, lines
    assert says in lines[0]
    assert not out.exists()


BAD_FILES = {
    "empty.step": b"",
    "empty.obj": b"",
    "empty.FCStd": b"",
    "words.step": b"this is not a STEP file\n",
    "words.brep": b"this is not a BREP file\n",
    "words.iges": b"this is not an IGES file\n",
    "words.stl": b"this is not an STL file\n",
    "words.FCStd": b"PK\x03\x04 broken",
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "nan.obj": b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "nofaces.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "truncated.off": b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n",
    "binary.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nend_header\n",
    "unknown.xyz": b"1 2 3\n",
}


@pytest.mark.parametrize("name", sorted(BAD_FILES))
def test_a_malformed_file_is_refused(capsys, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(BAD_FILES[name])
    assert_refused(capsys, tmp_path, path)


def test_a_missing_file_is_refused(capsys, tmp_path):
    for name in ("none.step", "none.obj", "none.FCStd"):
        assert_refused(capsys, tmp_path, tmp_path / name)


def test_a_folder_is_refused(capsys, tmp_path):
    (tmp_path / "folder.step").mkdir()
    assert_refused(capsys, tmp_path, tmp_path / "folder.step")


@pytest.mark.parametrize("name", ["hood", "box_with_fillets"])
@pytest.mark.parametrize("part", [0.02, 0.3, 0.7, 0.98])
def test_a_truncated_step_file_is_refused(capsys, tmp_path, example_path, name, part):
    with open(example_path(name), "rb") as stream:
        data = stream.read()
    path = tmp_path / "cut.step"
    path.write_bytes(data[: int(part * len(data))])
    assert_refused(capsys, tmp_path, path)


def test_an_empty_document_is_refused(capsys, tmp_path, document):
    document.saveAs(str(tmp_path / "empty.FCStd"))
    assert_refused(capsys, tmp_path, tmp_path / "empty.FCStd", says="no object in it has a face")


@pytest.mark.parametrize(
    "arguments, says",
    [
        (["--edge-length", "0"], "--edge-length"),
        (["--edge-length", "nan"], "--edge-length"),
        (["--edge-length", "abc"], "--edge-length"),
        (["--edge-length", "1e9"], "larger than the part"),
        (["--edge-length", "1e-9"], "quads"),
        (["--edge-length", "5", "--quads", "9"], "two ways"),
        (["--degree", "9"], "--degree"),
        (["--write", "quads,jpg"], "jpg"),
        (["--field", "stress"], "not in this version"),
        (["--no-such-option"], "--no-such-option"),
    ],
)
def test_an_unusable_option_is_refused(capsys, tmp_path, example_path, arguments, says):
    assert_refused(capsys, tmp_path, example_path("tube"), *arguments, says=says)


def test_shapes_without_faces_are_refused():
    import FreeCAD
    import Part

    for shape in (Part.Shape(), Part.makeLine(FreeCAD.Vector(), FreeCAD.Vector(1, 0, 0))):
        with pytest.raises(trimquad.Error) as caught:
            trimquad.convert(shape)
        assert caught.value.kind == "input"


def test_a_face_that_there_is_not_is_refused(sheet):
    from trimquad.source import Source

    for face in ("Face7", "Edge1", 0):
        with pytest.raises(trimquad.Error) as caught:
            trimquad.convert(Source(sheet, [face]))
        assert caught.value.kind == "input"


def test_something_that_is_no_shape_is_refused():
    for thing in (7, None, [], "", ([[0, 0]], [[0, 1, 2]])):
        with pytest.raises(trimquad.Error) as caught:
            trimquad.convert(thing)
        assert caught.value.kind == "input"


def test_an_edge_with_three_faces_is_refused_with_its_place():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    with pytest.raises(trimquad.Error) as caught:
        trimquad.convert((points, [[0, 1, 2], [1, 0, 3], [0, 1, 4]]))
    assert caught.value.kind == "input"
    assert caught.value.where or caught.value.position


def test_a_file_in_the_place_of_the_output_folder_is_refused(capsys, tmp_path, example_path):
    (tmp_path / "out").write_text("mine")
    status, lines = run(capsys, "convert", example_path("tube"), "--out", tmp_path / "out" / "deep", "--quiet")
    assert (status, len(lines)) == (2, 1)
    assert (tmp_path / "out").read_text() == "mine"


def small_conversion(tmp_path, out, **keywords):
    path = tmp_path / "sheet.brep"
    wavy_face().exportBrep(str(path))
    command = [sys.executable, "-m", "trimquad.cli", "convert", str(path), "--out", str(out), "--quads", "200", "--quiet"]
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120, **keywords)


@pytest.mark.skipif(os.getuid() != 0, reason="changes its user")
def test_an_output_folder_without_permission_is_refused(tmp_path):
    out = tmp_path / "locked"
    out.mkdir(mode=0o755)
    os.chmod(tmp_path, 0o755)
    parent = tmp_path
    while parent != parent.parent:
        if not os.stat(parent).st_mode & 0o005:
            pytest.skip("the folder of the tests is closed to other users")
        parent = parent.parent
    done = small_conversion(tmp_path, out, user=65534)
    assert done.returncode == 2, done.stderr
    assert "Permission denied" in done.stderr and len(done.stderr.splitlines()) == 1
    assert list(out.iterdir()) == []


def test_a_full_disk_leaves_the_earlier_files_as_they_were(tmp_path):
    out = tmp_path / "out"
    assert small_conversion(tmp_path, out).returncode == 0
    before = {p.name: p.read_bytes() for p in out.iterdir()}
    limit = 20_000  # bytes a file, less than the maps have: writing fails as on a full disk

    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = small_conversion(tmp_path, out, preexec_fn=full)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert {p.name: p.read_bytes() for p in out.iterdir()} == before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("delay", [0.6, 1.5])
def test_an_interrupted_conversion_ends_with_130_and_writes_nothing(tmp_path, example_path, number, delay):
    out = tmp_path / "out"
    command = [sys.executable, "-m", "trimquad.cli", "convert", example_path("hood"), "--out", str(out), "--quads", "60000"]
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    time.sleep(delay)
    process.send_signal(number)
    started = time.monotonic()
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130, said
    assert time.monotonic() - started < 5
    assert said.splitlines()[-1] == "trimquad: cancelled"
    assert "Traceback" not in said
    assert not out.exists()


def test_version_and_help(capsys):
    assert cli.main(["--version"]) == 0
    assert cli.main(["--help"]) == 0
    assert cli.main(["convert", "--help"]) == 0
    assert "--edge-length" in capsys.readouterr().out
