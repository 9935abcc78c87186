"""One module a tool. A checker has `check(fmu)`, which raises or prints if it finds something; an importer has
`simulate(fmus)`, which returns the series of each FMU. Both have NAME, PROVES and `version()`, and may have

- is_available(): for tools that may be missing,
- KNOWN: complaints about what the tool cannot do, with the reason why they are none about the FMU.
"""
