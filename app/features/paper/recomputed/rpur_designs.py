"""Tables, arrangements and simplified designs of the 5-RPUR."""

from __future__ import annotations

from functools import cache
from itertools import combinations_with_replacement

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    compared,
    counts,
    drawn,
    error,
)
from app.features.paper.recomputed.postures import machine, postures, with_limbs
from app.features.paper.recomputed.rpur_examples import (
    ORDER,
    examples,
    number_of,
    places_of_roots,
    solved,
)
from app.features.paper.recomputed.rpur_model import PAIRS, J, K
from app.features.paper.recomputed.rpur_space import arrangement
from app.features.paper.registry import computes
from kinematics.answers.solutions import ForwardSolutions

# --- tables --------------------------------------------------------------------------------


@computes(J, "Table 1")
@computes(K, "Table I")
def table_1(item: Item) -> Outcome:
    name = "rpur-table1" if item.paper == J else "rpur-table1-icee"
    alike = _same_numbers(item, name)
    found = machine(name).forward(item.data["joints"])
    other = _generic(item)
    titles = [f.title for f in machine(name).findings if f.title.startswith("Arrangement")]
    return claimed(
        alike == 30 and found.complex_count == other.complex_count,
        Quantity("numbers that the preset has as printed", float(alike), "30"),
        Quantity("arrangements found in it", ", ".join(titles) or "none", "none"),
        Quantity("complex solutions", float(found.complex_count)),
        Quantity(
            "of a general design (this one with every number changed)", float(other.complex_count)
        ),
        proof=f"its forward kinematics has {found.complex_count} complex solutions where a "
        f"general 5-RPUR has {other.complex_count}",
    )


def _same_numbers(item: Item, name: str) -> int:
    limbs = machine(name).table["limb"]
    own = np.array([[*limb["base"], *limb["platform"]] for limb in limbs])
    printed = np.concatenate([item.data["base"], item.data["platform"]], axis=1)
    return int((own == printed).sum())


def _generic(item: Item) -> ForwardSolutions:
    """The forward kinematics of a design near the printed one without its coincidences."""
    return _nearby(tuple(item.data["joints"]))


@cache
def _nearby(joints: tuple[float, ...]) -> ForwardSolutions:
    chance = np.random.default_rng(5)
    limbs = [
        {
            **limb,
            "base": (np.array(limb["base"]) + chance.normal(0, 20, 3)).round(1).tolist(),
            "platform": (np.array(limb["platform"]) + chance.normal(0, 20, 3)).round(1).tolist(),
            "link": 150.0 + 5.0 * n,
        }
        for n, limb in enumerate(machine("rpur-table1").table["limb"])
    ]
    return with_limbs(limbs).forward(joints)


@computes(J, "Table 2")
def table_2(item: Item) -> Outcome:
    alike = _same_numbers(item, "rpur-table2")
    base = np.array(item.data["base"])
    whole = np.isclose(base / item.data["inch"], (base / item.data["inch"]).round(), atol=1e-9)
    other = machine("rpur-table2").edited("limb.1.base.0", 254.0)
    level = other.workspace(phi=0, theta=0).volume(1e-6, pieces=False).value
    own = machine("rpur-table2").workspace(phi=0, theta=0).volume(1e-6, pieces=False).value
    return compared(
        Quantity("numbers that the preset has as printed", float(alike), "30"),
        Quantity("design", arrangement("rpur-table2"), item.data["arrangement"]),
        Quantity("numbers of the base that are whole inches", f"{whole.sum()} of {whole.size}"),
        Quantity("distance of A₃ and A₄", float(base[3, 0] - base[2, 0]), unit="mm"),
        Quantity("workspace at φ = θ = 0 with 245", round(own), unit="mm³"),
        Quantity("with 254", round(level), unit="mm³"),
    )


# --- designs and arrangements --------------------------------------------------------------


@computes(J, "Fig. 3")
@computes(K, "Fig. 3")
def fig_3(item: Item) -> Outcome:
    quantities, worst = [], 0.0
    for kind, (name, i, j) in PAIRS.items():
        at = postures(name)
        across = np.cross(at.b[:, j - 1] - at.b[:, i - 1], at.turn[:, :, 0])
        links = error(at.c[:, i - 1] - at.b[:, i - 1], at.c[:, j - 1] - at.b[:, j - 1])
        off = max(float(np.abs(across).max()) / 100.0, links)
        worst = max(worst, off)
        titles = [f.title for f in machine(name).findings if f.limbs == (i, j)]
        there = f"Arrangement {kind}" in titles
        worst = max(worst, 0.0 if there else 1.0)
        quantities.append(Quantity(f"{kind}: error of v_i ∥ v_j and of B_iB_j ∥ e₂", off))
    return drawn(
        worst < 1e-9,
        *quantities,
        proof="in each of the three the second links stay parallel and "
        "the line through the U joints is aligned with e₂",
    )


@computes(J, "Fig. 5")
def fig_5(item: Item) -> Outcome:
    at = postures("rpur-mpa2")
    v = at.c - at.b
    off = max(error(v[:, 0], v[:, 1]), error(v[:, 0], v[:, 2]))
    base = float(np.abs(at.a[0] - at.a[1]).max())
    return drawn(
        off < 1e-9 and base == 0.0 and arrangement("rpur-mpa2") == "{MpA2}",
        Quantity("error of v_i ∥ v_j ∥ v_p at 200 random postures", off),
        Quantity("distance of the base points A_i and A_j", base, unit="mm"),
        proof="three second links stay parallel",
    )


@computes(J, "Fig. 6")
def fig_6(item: Item) -> Outcome:
    at = postures("rpur-a1a2")
    platform = float(np.abs(at.s[0] - at.s[1]).max())
    base = float(np.abs(at.a[2] - at.a[3]).max())
    along = float(np.abs(at.s[2, 1:] - at.s[3, 1:]).max())
    return drawn(
        platform == base == along == 0.0 and arrangement("rpur-a1a2") == "{A1A2}",
        Quantity("distance of the platform points of A1", platform, unit="mm"),
        Quantity("distance of the base points of A2", base, unit="mm"),
        Quantity("distance of the platform points of A2 across e₂", along, unit="mm"),
        proof="the sample meets the conditions exactly",
    )


@computes(K, "Fig. 2")
def fig_2_conference(item: Item) -> Outcome:
    at = postures("rpur-table1-icee")
    u, v = at.b - at.a, at.c - at.b
    e1 = np.abs(u[..., 1]).max() / 400.0
    e2 = np.abs((v * at.turn[:, None, :, 0]).sum(axis=-1)).max() / 150.0
    return drawn(
        bool(max(e1, e2) < 1e-9),
        Quantity("error of u ⟂ e₁ at 200 random postures", float(e1)),
        Quantity("error of v ⟂ e₂", float(e2)),
        proof="the limb that is drawn closes",
    )


@computes(J, "eq. 9")
@computes(K, "eq. 6")
def eq_9(item: Item) -> Outcome:
    pairs = ["{" + "".join(pair) + "}" for pair in combinations_with_replacement(ORDER, 2)]
    solved = [name for name in pairs if examples()[name].complex_count > 0]
    told = list(item.data["pairs"])
    return claimed(
        sorted(told) == sorted(solved),
        Quantity("pairs of three arrangements", float(len(solved)), str(len(set(told)))),
        *(
            Quantity(f"complex solutions of {name}", float(examples()[name].complex_count))
            for name in pairs
        ),
        Quantity("printed twice", ", ".join(sorted({p for p in told if told.count(p) > 1})) or "–"),
        Quantity("not printed", ", ".join(sorted({*solved} - {*told})) or "–"),
        proof=f"there are {len(solved)} pairs, of which {len({*told} & {*solved})} are printed",
    )


@computes(J, "eq. 10")
def eq_10(item: Item) -> Outcome:
    names = list(item.data["sets"])
    thetas = {name: number_of(places_of_roots(name)) for name in names}
    # Up to four values of θ are roots of quadratics (or of one quartic).
    return claimed(
        max(thetas.values()) <= 4,
        *(Quantity(f"values of θ of {name}", float(count)) for name, count in thetas.items()),
        *(
            Quantity(f"complex solutions of {name}", float(examples()[name].complex_count))
            for name in names
        ),
        proof=f"{{MpA3}} has {thetas['{MpA3}']} values of θ, complex ones counted",
    )


@computes(J, "C1")
@computes(K, "C3")
def c_1(item: Item) -> Outcome:
    name = "rpur-table1" if item.paper == J else "rpur-table1-icee"
    found = solved(name, (320.0, 360.0, 345.0, 305.0, 375.0))
    stewart = machine("gough-dietmaier")
    other = stewart.forward(stewart.home.joints)
    return counts(
        item.data["counts"],
        ("complex solutions of a general Gough–Stewart platform", other.complex_count),
        more=[
            Quantity("real ones of that example", float(len(other))),
            Quantity("complex solutions of the paper's 5-RPUR", float(found.complex_count)),
            Quantity("real ones at ρ = 320, 360, 345, 305, 375 mm", float(len(found))),
        ],
    )


@computes(J, "C2")
def c_2(item: Item) -> Outcome:
    pairs = [name for name in examples() if not name.startswith("{Mp")]
    return counts(
        item.data["counts"],
        ("simplified designs that the library knows", len(examples())),
        ("classes: two pairs, or three limbs", 2 if 0 < len(pairs) < len(examples()) else 1),
        more=[
            Quantity(f"{name}: complex, most real found", f"{one.complex_count}, {len(one.tied)}")
            for name, one in examples().items()
        ],
    )


@computes(J, "C3")
def c_3(item: Item) -> Outcome:
    pairs = [name for name in examples() if not name.startswith("{Mp")]
    kinds = {name[n : n + 2] for name in pairs for n in (1, 3)}
    return counts(item.data["counts"], ("situations", len(kinds)), ("subsets of two", len(pairs)))


@computes(K, "C4")
def c_4_conference(item: Item) -> Outcome:
    from app.features.paper.items import paper

    shown = {*paper(K).item("eq. 6").data["pairs"]}
    return claimed(
        len(shown) == len(examples()),
        Quantity("simplified designs", float(len(examples())), str(item.data["counts"][0])),
        Quantity("of them shown", float(len(shown))),
        proof=f"of {len(examples())} designs {len(shown)} are shown, all of one class",
    )
