# SPDX-License-Identifier: LGPL-2.1-or-later
"""From a deck to a scene, or to a mesh alone."""

from pathlib import Path

from .abaqus import scene as abaqus_scene
from .abaqus.deck import Deck as AbaqusDeck, key
from .abaqus.element_types import ElementType
from .abaqus.mesh import AbaqusMesh
from .dyna.cards import PARTS
from .dyna.deck import Deck as DynaDeck
from .dyna import scene as dyna_scene
from .dyna.mesh import DynaMesh
from .msh import Writer
from .report import Report
from .text import DeckError

DYNA, ABAQUS = (".k", ".key", ".dyn"), (".inp",)


class MeshAlone:
    """The mesh of a deck without a scene."""

    def __init__(self, mesh, source, target, report):
        self.mesh, self.source, self.target, self.report = mesh, source, target, report

    def files(self):
        return {self.target.with_suffix(".msh"): Writer(self.mesh, self.source.name).text()}


def plane_or_space(deck):
    """The dimension that the element types of an Abaqus file tell."""
    types = [ElementType(key(section.options.get("TYPE", ""))) for section in deck.named("ELEMENT")]
    has_plane = any(kind.name.startswith(("CPS", "CPE", "DC2D")) for kind in types)
    return 2 if has_plane and all(kind.dimension < 3 for kind in types) else 3


def convert(source, target, dimension=None, is_mesh_alone=False):
    source, target, report = Path(source), Path(target), Report()
    suffix = source.suffix.lower()
    if suffix not in DYNA + ABAQUS:
        raise DeckError("the name does not end in .k, .key or .dyn (LS-DYNA), or .inp (Abaqus, CalculiX).")
    if suffix in DYNA:
        deck = DynaDeck(source)
        mesh = DynaMesh(deck, dimension or 3, report)
        scene_of = dyna_scene.scene_of
        has_scene = any(section.name.startswith(("MAT_", "SECTION_")) for section in deck.sections)
    else:
        deck = AbaqusDeck(source)
        mesh = AbaqusMesh(deck, dimension or plane_or_space(deck), report)
        scene_of = abaqus_scene.scene_of
        has_scene = deck.has("MATERIAL", "STEP")
    for remark in mesh.remarks:
        report.remark(remark)
    if is_mesh_alone or not has_scene:
        if suffix in ABAQUS:
            mesh.remark_links()
        if not is_mesh_alone:
            report.remark("The deck has no materials: its mesh is written alone, for section Mesh of a scene (`Type = file`).")
        for section in deck.sections:
            if not getattr(section, "is_read", False) and section.name not in (*dyna_scene.OF_THE_MESH, *PARTS) and \
                    not section.name.startswith("SET_"):
                report.leave_out(section, section.lines)
            elif suffix in ABAQUS:
                section.report_unused(report)
        report.is_written = False
        return MeshAlone(mesh, source, target, report)
    return scene_of(deck, mesh, target, report)
