"""The workspace of a 5-RPUR by exact boundary representations in OpenCASCADE, to compare with.

A limb's half vertex space is a tube: a ring swept along a half circle without being turned. Its
walls are surfaces of translation, exact as rational B-splines. Needs cadquery (the extra `bench`).
"""

from __future__ import annotations

import math

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepGProp import BRepGProp
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS

from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.offsets import offset_points


def _arc(radius, start, quarters):
    """Poles and weights of a circular arc of so many quarter turns, about the origin."""
    poles, weights = [], []
    for n in range(2 * quarters + 1):
        angle = start + n * math.pi / 4
        reach = radius * (math.sqrt(2.0) if n % 2 else 1.0)
        poles.append((reach * math.cos(angle), reach * math.sin(angle)))
        weights.append(math.sqrt(0.5) if n % 2 else 1.0)
    return poles, weights


def _knots(quarters):
    knots = TColStd_Array1OfReal(1, quarters + 1)
    counts = TColStd_Array1OfInteger(1, quarters + 1)
    for n in range(quarters + 1):
        knots.SetValue(n + 1, float(n))
        counts.SetValue(n + 1, 3 if n in (0, quarters) else 2)
    return knots, counts


def _translation_surface(one, two, quarters):
    """The surface {a + b} of two rational curves given by poles (3D) and weights."""
    (poles, weights), (others, other_weights) = one, two
    net = TColgp_Array2OfPnt(1, len(poles), 1, len(others))
    table = TColStd_Array2OfReal(1, len(poles), 1, len(others))
    for i, (a, v) in enumerate(zip(poles, weights, strict=True), 1):
        for j, (b, w) in enumerate(zip(others, other_weights, strict=True), 1):
            net.SetValue(i, j, gp_Pnt(*(p + q for p, q in zip(a, b, strict=True))))
            table.SetValue(i, j, v * w)
    u, uc = _knots(quarters[0])
    v, vc = _knots(quarters[1])
    return Geom_BSplineSurface(net, table, u, v, uc, vc, 2, 2, False, False)


def half_vertex_space(link, rho_min, rho_max, sign):
    """B^σ about its base point, as a solid."""
    along, along_weights = _arc(link, -math.pi / 2 if sign > 0 else math.pi / 2, 2)
    path = [(0.0, b, a) for a, b in along], along_weights  # y = l sin, z = l cos
    sewing = BRepBuilderAPI_Sewing(1e-6)
    for radius in (rho_min, rho_max):
        ring, weights = _arc(radius, 0.0, 4)
        circle = [(a, 0.0, b) for a, b in ring], weights
        surface = _translation_surface(circle, path, (4, 2))
        sewing.Add(BRepBuilderAPI_MakeFace(surface, 1e-6).Face())
    for y in (-link, link):
        inner, weights = _arc(rho_min, 0.0, 4)
        outer, _ = _arc(rho_max, 0.0, 4)
        # The flat ring between both circles: a ruled surface.
        net = TColgp_Array2OfPnt(1, len(inner), 1, 2)
        table = TColStd_Array2OfReal(1, len(inner), 1, 2)
        for i, (a, b, w) in enumerate(zip(inner, outer, weights, strict=True), 1):
            net.SetValue(i, 1, gp_Pnt(a[0], y, a[1]))
            net.SetValue(i, 2, gp_Pnt(b[0], y, b[1]))
            table.SetValue(i, 1, w)
            table.SetValue(i, 2, w)
        u, uc = _knots(4)
        v, vc = TColStd_Array1OfReal(1, 2), TColStd_Array1OfInteger(1, 2)
        for n in (1, 2):
            v.SetValue(n, float(n - 1))
            vc.SetValue(n, 2)
        flat = Geom_BSplineSurface(net, table, u, v, uc, vc, 2, 1, False, False)
        sewing.Add(BRepBuilderAPI_MakeFace(flat, 1e-6).Face())
    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def volume_of(shape) -> float:
    """mm³."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-7)
    return properties.Mass()


def workspace_volume(design: FiveRPURDesign, phi: float, theta: float) -> float:
    """The volume of the constant-orientation workspace of all working modes, mm³."""
    result = None
    whole: dict[tuple[float, float, float], object] = {}
    for limb, offset in zip(design.limbs, offset_points(design, phi, theta), strict=True):
        key = (limb.link, *limb.stroke)
        if key not in whole:
            halves = [half_vertex_space(*key, sign) for sign in (1, -1)]
            whole[key] = BRepAlgoAPI_Fuse(*halves).Shape()
        move = gp_Trsf()
        move.SetTranslation(gp_Vec(*(float(v) for v in offset)))
        placed = BRepBuilderAPI_Transform(whole[key], move, True).Shape()
        result = placed if result is None else BRepAlgoAPI_Common(result, placed).Shape()
    return volume_of(result)
