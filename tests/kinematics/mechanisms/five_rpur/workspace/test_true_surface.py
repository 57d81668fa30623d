"""The workspace on its true surfaces: exact vertices, and otherwise the solid that it was."""

from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from kinematics.designs.files import load_design, presets
from kinematics.errors import InputError
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.workspace.true_surface import true_surface
from kinematics.mechanisms.five_rpur.workspace.vertex_space import deviation
from kinematics.mechanisms.five_rpur.workspace.workspace import workspace
from kinematics.screws.spatial import rotation_y
from kinematics.solids.files import encode
from tests.kinematics.mechanisms.five_rpur.machines import of_volume_case
from tests.kinematics.references import read

CASES = read("volumes.json")["cases"]
PROMISED = {"normal": 1e-3, "fine": 1e-4}
DESIGNS = [p.name for p in presets() if p.mechanism == "five_rpur"]
ANGLES = [(0.0, 0.0), (0.3, -0.4)]
MISSED = 0.02  # of the vertices, at most, are where surfaces all but coincide


def modes_of(case) -> tuple[str, ...] | None:
    signs = case["modes"]
    return None if signs is None else ("".join("+" if s > 0 else "-" for s in signs),)


def random_design(seed: int) -> FiveRPURDesign:
    """Limbs anywhere; of every third design on a lattice, of every fourth three coincide."""
    rng = np.random.default_rng(seed)
    link, low = rng.uniform(120, 200, 5), rng.uniform(0, 250, 5)
    high = low + rng.uniform(100, 250, 5)
    base, platform = rng.uniform(-80, 80, (2, 5, 3))
    if seed % 3 == 0:
        link[:], low[:], high[:] = 150.0, 250.0, 400.0
        base, platform = np.round(base / 50) * 50, np.round(platform / 50) * 50
    if seed % 4 == 0:
        for values in (link, low, high, base, platform):
            values[1::2] = values[0]
    limbs = zip(base.tolist(), platform.tolist(), link, low, high, strict=True)
    return FiveRPURDesign(
        tuple(Limb(tuple(r), tuple(s), float(li), (float(a), float(b))) for r, s, li, a, b in limbs)
    )


def coarsest(design, resolution) -> float:
    return max(deviation(limb.link, limb.stroke[1], resolution) for limb in design.limbs)


@pytest.fixture
def placed(monkeypatch):
    """The meshes that were put on true surfaces, with what each of their faces stands for."""
    seen = []

    def spy(*arguments):
        seen.append(true_surface(*arguments))
        return seen[-1]

    monkeypatch.setattr("kinematics.mechanisms.five_rpur.workspace.workspace.true_surface", spy)
    return seen


def off(traced) -> np.ndarray:
    """(V,) how far each vertex is from the farthest surface of its faces, by the equations.

    A point of {ρ u(α) + l v(β)} is at ρ from the axis once σ h(y) is taken off its z, and at l
    from a point of the circle ρ u: the one is blunt where |y| = l, the other where |x| = ρ.
    """
    worst = np.zeros(len(traced.mesh.vertices))
    for n, patch in enumerate(traced.patches):
        tag = patch.tag
        corners = np.unique(traced.mesh.faces[traced.patch_of == n])
        x, y, z = (traced.mesh.vertices[corners] - patch.transform[:, 3]).T
        if tag.kind == "end":
            far = np.abs(np.abs(y) - tag.link)
        else:
            h = np.sqrt(np.maximum(tag.link**2 - y**2, 0.0))
            s = np.sqrt(np.maximum(tag.radius**2 - x**2, 0.0))
            far = np.abs(np.hypot(x, z - tag.sign * h) - tag.radius)
            for half in (s, -s):
                aside = np.where(tag.sign * (z - half) >= -1e-6 * tag.link, 0.0, np.inf)
                far = np.minimum(far, aside + np.abs(np.hypot(y, z - half) - tag.link))
            far += np.maximum(np.abs(y) - tag.link, 0.0)
        worst[corners] = np.maximum(worst[corners], far)
    return worst


def check_closed(built) -> None:
    f = built.mesh.faces.astype(np.int64)
    edges = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
    forth = np.sort(edges[:, 0] * len(built.mesh.vertices) + edges[:, 1])
    back = np.sort(edges[:, 1] * len(built.mesh.vertices) + edges[:, 0])
    assert (np.diff(forth) > 0).all()
    np.testing.assert_array_equal(forth, back)
    assert built.watertight
    again = trimesh.load(io.BytesIO(encode(built.mesh, "stl")), file_type="stl")
    assert again.is_watertight
    assert again.volume == pytest.approx(built.volume, rel=1e-5)
    np.testing.assert_array_equal(
        built.shaded.vertices[built.shaded.faces],
        built.mesh.vertices[built.mesh.faces].astype(np.float32),
    )


def check_exact(built, before, traced) -> None:
    """Every vertex is on all surfaces that meet there, but for those that are owned up to."""
    assert built.residual is not None
    assert built.residual <= 1e-9
    assert built.unplaced <= MISSED * len(before.mesh.vertices)
    np.testing.assert_array_equal(traced.mesh.vertices, built.mesh.vertices)
    assert int((off(traced) > 2e-9).sum()) <= built.unplaced


def diced(mesh, size) -> np.ndarray:
    """(N, 3, 3) the triangles of a mesh, cut until none is longer than ``size``."""
    triangles, done = mesh.vertices[mesh.faces], []
    while len(triangles):
        length = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
        small = length.max(axis=1) <= size
        done.append(triangles[small])
        first = length[~small].argmax(axis=1)[:, None]
        order = (first + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles[~small], order[:, :, None], 1).transpose(1, 0, 2)
        middle = (a + b) / 2
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
    return np.concatenate(done)


def distances(points, mesh, size) -> np.ndarray:
    """From points to a mesh, from above: to the nearest of some triangles that are near."""
    triangles = diced(mesh, size)
    _, near = cKDTree(triangles.mean(axis=1)).query(points, k=8)
    best = np.full(len(points), np.inf)
    for column in near.T:
        best = np.minimum(best, to_triangle(points, *triangles[column].transpose(1, 0, 2)))
    return best


def to_triangle(p, a, b, c) -> np.ndarray:
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    height = np.abs(((p - a) * normal).sum(1)) / np.maximum(size, 1e-300)
    inside = size > 0.0
    edge = np.full(len(p), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        inside &= (np.cross(along, p - start) * normal).sum(1) >= 0.0
        length = np.maximum((along**2).sum(1), 1e-300)
        t = np.clip(((p - start) * along).sum(1) / length, 0.0, 1.0)
        edge = np.minimum(edge, np.linalg.norm(p - start - t[:, None] * along, axis=1))
    return np.where(inside, height, edge)


def check_near(one, other, within) -> None:
    """The surfaces are near each other, at corners of the mesh and on its faces.

    Facets are within the mesh's deviation of the surfaces. Where two of these meet at a small
    angle their common edge is farther off, in few places.
    """
    rng = np.random.default_rng(0)
    for here, there in ((one, other), (other, one)):
        corners = here.mesh.vertices[here.mesh.faces]
        weights = rng.dirichlet(np.ones(3), len(corners))
        between = (corners * weights[:, :, None]).sum(axis=1)
        points = rng.permutation(np.concatenate([here.mesh.vertices, between]))[:4000]
        far = distances(points, there.mesh, 25.0)
        assert (far > within).mean() <= 5e-3
        assert far.max() <= 8.0 * within


def check(placed, design, phi, theta, modes, resolution):
    facets = workspace(design, phi, theta, modes, resolution)
    built = workspace(design, phi, theta, modes, resolution, "true")
    assert facets.residual is None
    if not facets.triangles:
        assert built.triangles == 0
        return facets, built
    check_closed(built)
    check_exact(built, facets, placed[-1].traced)
    assert len(built.pieces) == len(facets.pieces)
    assert abs(built.volume - facets.volume) <= built.volume_error + facets.volume_error
    check_near(facets, built, coarsest(design, resolution))
    return facets, built


@pytest.mark.parametrize(("number", "name"), list(enumerate(DESIGNS)))
def test_presets(number, name, placed):
    check(placed, load_design(name), *ANGLES[number % 2], None, "normal")


@pytest.mark.parametrize("seed", range(4))
def test_random_designs(seed, placed):
    design = random_design(seed)
    phi, theta = np.random.default_rng(seed).uniform(-0.8, 0.8, 2)
    modes = None if seed % 2 else ("+++++", "-+++-")
    check(placed, design, float(phi), float(theta), modes, "normal")


@pytest.mark.parametrize(
    "case", CASES[::2], ids=lambda c: f"{c['name']} {c['phi']:.1f} {(modes_of(c) or ('all',))[0]}"
)
def test_the_volume_is_as_good_as_the_resolution_promises(case):
    built = workspace(
        of_volume_case(case), case["phi"], case["theta"], modes_of(case), "normal", "true"
    )
    error = abs(built.volume - case["volume"])
    assert error <= PROMISED["normal"] * case["volume"]
    assert error <= built.volume_error <= 3 * PROMISED["normal"] * case["volume"]


@pytest.mark.parametrize("case", CASES[9:10], ids=lambda c: c["name"])
def test_a_fine_one(case, placed):
    design, modes = of_volume_case(case), modes_of(case)
    facets = workspace(design, case["phi"], case["theta"], modes, "fine")
    built = workspace(design, case["phi"], case["theta"], modes, "fine", "true")
    check_closed(built)
    check_exact(built, facets, placed[-1].traced)
    error = abs(built.volume - case["volume"])
    assert error <= min(PROMISED["fine"] * case["volume"], built.volume_error)


def test_limbs_that_coincide_and_limbs_that_only_touch(placed):
    one = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (250.0, 400.0))
    _, alone = check(placed, FiveRPURDesign((one,) * 5), 0.0, 0.0, None, "normal")
    assert alone.unplaced == 0
    # Outer cylinders that touch along a line: nothing but facets is in both.
    other = Limb((800.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (250.0, 400.0))
    design = FiveRPURDesign((one, one, one, one, other))
    facets = workspace(design, 0.0, 0.0, ("+++++",), "normal")
    built = workspace(design, 0.0, 0.0, ("+++++",), "normal", "true")
    assert built.watertight
    assert built.volume <= facets.volume
    assert built.volume <= built.volume_error


def test_faces_look_outwards():
    """One step in from the middle of a face is reached by inverse kinematics, one step out not."""
    design, (phi, theta) = load_design("rpur-table2"), ANGLES[1]
    built = workspace(design, phi, theta, None, "normal", "true")
    a, b, c = built.mesh.vertices[built.mesh.faces].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    twice = np.linalg.norm(normal, axis=1)
    # Farther than a chord sags; a face may be nearer than this to another one across an edge.
    step = 1.5 * normal / twice[:, None]
    large = twice > np.median(twice)
    right = []
    for points, wanted in (((a + b + c) / 3 - step, True), ((a + b + c) / 3 + step, False)):
        turned = points[large] @ rotation_y(theta).T
        poses = np.concatenate([turned, np.tile([phi, theta], (len(turned), 1))], axis=1)
        inside = inverse.inverse(design, poses).within_stroke.any(axis=1)
        right.append((inside == wanted).mean())
    assert min(right) > 0.97


def test_a_preview_is_of_facets():
    design = load_design("rpur-table1")
    plain = workspace(design, 0.1, 0.2, None, "preview")
    asked = workspace(design, 0.1, 0.2, None, "preview", "true")
    assert asked.residual is None
    np.testing.assert_array_equal(plain.mesh.vertices, asked.mesh.vertices)


def test_the_same_request_gives_the_same_solid():
    design = load_design("rpur-a1a2")
    pose = (0.0, 0.0, 0.0, 0.2, 0.1)
    request = machine_of(design).solids.request("workspace", pose, None, "normal", "true")
    first, second = build_solid(request), build_solid(request)
    np.testing.assert_array_equal(first.mesh.vertices, second.mesh.vertices)
    np.testing.assert_array_equal(first.mesh.faces, second.mesh.faces)
    assert first.residual == second.residual is not None
    assert request != machine_of(design).solids.request("workspace", pose, None, "normal")


def test_an_unknown_surface_is_refused():
    with pytest.raises(InputError, match="there is no surface 'smooth'"):
        workspace(load_design("rpur-table1"), 0.0, 0.0, surface="smooth")
