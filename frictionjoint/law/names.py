"""Names of the friction laws, the integrated one first; their classes are in `laws`."""

LAWS = (
    "integrated",
    "static",
    "armstrong",
    "dahl",
    "dahl_stribeck",
    "lugre",
    "elastoplastic",
    "maxwell_slip",
)
