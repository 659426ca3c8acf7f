# SPDX-License-Identifier: LGPL-2.1-or-later
"""Names of the fields of LS-DYNA's cards, from the descriptions of the keywords. A text behind "=" is what
programs write for a blank field."""

CARDS = {
    "PART": ("PID SECID MID EOSID HGID GRAV ADPOPT TMID",),
    "PART_CONTACT": ("PID SECID MID EOSID HGID GRAV ADPOPT TMID", "FS FD DC VC OPTT SFT SSF CPARM8"),
    "SECTION_SOLID": ("SECID ELFORM AET",),
    "SECTION_SOLID_SPG": ("SECID ELFORM AET", "DX DY DZ ISPLINE KERNEL - SMSTEP MSC",
                          "IDAM FS STRETCH=1e10 ITB MSFAC ISC BOXID PDAMP=-0.001"),
    "MAT_001": ("MID RO E PR DA DB K",),
    "MAT_003": ("MID RO E PR SIGY ETAN BETA", "SRC SRP FS VP"),
    "MAT_015": ("MID RO G E PR DTF VP RATEOP", "A B N C M TM TR EPSO", "CP PC SPALL=2 IT D1 D2 D3 D4",
                "D5 C2 EROD EFMIN NUMINT K EPS1"),
    "MAT_024": ("MID RO E PR SIGY ETAN FAIL TDEL", "C P LCSS LCSR VP LCF", "EPS1 EPS2 EPS3 EPS4 EPS5 EPS6 EPS7 EPS8",
                "ES1 ES2 ES3 ES4 ES5 ES6 ES7 ES8"),
    "EOS_GRUNEISEN": ("EOSID C S1 S2 S3 GAMAO A E0", "V0"),
    "DEFINE_CURVE": ("LCID SIDR SFA SFO OFFA OFFO DATTYP LCINT",),
    "BOUNDARY_SPC_SET": ("NSID CID DOFX DOFY DOFZ DOFRX DOFRY DOFRZ",),
    "BOUNDARY_PRESCRIBED_MOTION_SET": ("NSID DOF VAD LCID SF VID DEATH=1e28 BIRTH",),
    "INITIAL_VELOCITY": ("NSID NSIDEX BOXID IRIGID ICID", "VX VY VZ VXR VYR VZR", "VXE VYE VZE VXRE VYRE VZRE"),
    "INITIAL_VELOCITY_GENERATION": ("ID STYP OMEGA VX VY VZ IVATN ICID", "XC YC ZC NX NY NZ PHASE IRIGID"),
    "RIGIDWALL_PLANAR": ("NSID NSIDEX BOXID OFFSET BIRTH DEATH=1e20 RWKSF=1", "XT YT ZT XH YH ZH FRIC WVEL"),
    "CONTROL_TERMINATION": ("ENDTIM ENDCYC DTMIN ENDENG ENDMAS=1e8 NOSOL",),
    "SET": ("SID DA1 DA2 DA3 DA4 SOLVER=MECH ITS=1",),
}
OTHER_NAMES = {"PART_INERTIA": "PART", "MAT_ELASTIC": "MAT_001",
               "MAT_PLASTIC_KINEMATIC": "MAT_003", "MAT_JOHNSON_COOK": "MAT_015",
               "MAT_PIECEWISE_LINEAR_PLASTICITY": "MAT_024"}
PARTS = ("PART", "PART_CONTACT", "PART_INERTIA")
# One keyword may have the cards of several of these things, one after the other.
REPEATED = ("PART", "PART_CONTACT", "SECTION_SOLID", "BOUNDARY_SPC_SET", "BOUNDARY_PRESCRIBED_MOTION_SET",
            "INITIAL_VELOCITY_GENERATION", "RIGIDWALL_PLANAR")
# Sets that the reader of the mesh takes.
SETS_OF_THE_MESH = {f"SET_{kind}{form}{choice}" for kind in ("NODE", "SEGMENT", "SOLID", "PART")
                    for form in ("", "_LIST") for choice in ("", "_GENERATE")} | {"SET_NODE_ADD", "SET_NODE_COLUMN"}


def cards_of(name):
    return CARDS.get("SET" if name.startswith("SET_") else OTHER_NAMES.get(name, name), ())


def n_cards_of(name):
    return len(cards_of(name))


def name_of_field(keyword, card, field):
    """The name, and the text that stands for a blank field."""
    cards = cards_of(keyword)
    words = cards[card].split() if card < len(cards) else ()
    word, _, default = words[field].partition("=") if field < len(words) else ("-", "", "")
    return word if word != "-" else f"field {field + 1} of card {card + 1}", default
