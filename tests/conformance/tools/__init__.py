"""One module a tool. A checker has `check(fmu)`, which raises or prints if it finds something; an importer has
`simulate(fmus)`, which returns the series of each FMU. Both have NAME, PROVES and `version()`, and may have

- is_available(): for tools that may be missing,
- LOADS: a checker that calls the library of the FMU,
- FMUS: those that a checker is for,
- KNOWN: complaints about what the tool cannot do, with the reason why they are none about the FMU.
"""
